//! Wrong commands and wrong scripts: what is wrong is named, the next move is said, nothing is
//! driven, and what was recorded before is still there.

use crate::common::{Place, list, scripts, text};
use protocol::display_text::is_unseen;

const HEAD: &str = "procedure(title = \"Test\", title_ko = \"시험\", suspect = \"atp_cpu\")\n";

/// Each refused with exit 2 and these words, on a database that holds an earlier run.
#[track_caller]
fn refused(cases: &[(&[&str], &[&str])]) {
    let place = Place::new();
    let earlier = place.recorded_run();
    for (arguments, words) in cases {
        let said = place.ptu(arguments).exits(2).explains(words);
        assert_eq!(said.out, "", "{}", said.all());
    }
    assert_eq!(place.run_ids(), [earlier], "nothing lost, nothing added");
}

/// A script that must not load: exit 2 with these words, and nothing driven.
#[track_caller]
fn does_not_load(body: &str, words: &[&str]) {
    let place = Place::new();
    let earlier = place.recorded_run();
    place.write("wrong.star", &format!("{HEAD}{body}"));
    for check in [
        &["run", "wrong.star"][..],
        &["run", "--check", "wrong.star"],
    ] {
        place
            .ptu(check)
            .exits(2)
            .explains(words)
            .explains(&["wrong.star:", "1 error in the scripts; nothing was driven"]);
    }
    assert_eq!(place.run_ids(), [earlier], "nothing lost, nothing added");
}

#[test]
fn a_text_longer_than_is_kept_is_refused_before_anything_is_driven() {
    let place = Place::new();
    let earlier = place.recorded_run();
    let (name, note) = (&*"가".repeat(256), &*"a".repeat(4_001));
    for (arguments, words) in [
        (
            ["run", "tcms/link", "--operator", name],
            ["the operator's name has 256", "at most 255"],
        ),
        (
            ["run", "tcms/link", "--train-no", name],
            ["the train's name has 256", "shorten it"],
        ),
        (
            ["runs", "note", "latest", note],
            ["the note has 4001", "at most 4000"],
        ),
        (
            ["faults", "list", "--save", name],
            ["the question's name has 256", "at most 255"],
        ),
    ] {
        place.ptu(&arguments).exits(2).explains(&words);
    }
    assert_eq!(place.run_ids(), [earlier], "nothing lost, nothing added");
    let name = "n".repeat(201);
    let step = format!("step(\"{name}\", do = [wait(ms(100))])\n");
    does_not_load(&step, &["at most 200 characters", "found one of 201"]);
}

/// Goal: nothing that a person, a script or a file says acts on a terminal. Method: control characters
/// wherever a text comes in, and every way out.
#[test]
fn what_others_wrote_acts_on_no_terminal() {
    const ACTS: &str = "\u{1b}]0;x\u{7}\u{9b}31m\u{7f}\u{202e}";
    const SHOWN: &str = "\\x1b]0;x\\x07\\x9b31m\\x7f\\u{202e}";
    let place = Place::new();
    // A unit's has ASCII only.
    let serial = "SN\u{1b}[31m\u{7f}\u{7}";
    place.write(
        "says.star",
        &format!(
            "procedure(title = \"Says {ACTS}\", suspect = \"-\")\nprint(\"{ACTS}\")\n\
             step(\"alarm {ACTS}\", expect = [becomes(alarm, True, within = ms(100))], note = \"{ACTS}\")\n"
        ),
    );
    let reports = ["r.html", "r.csv", "r.json", "r.junit.xml"];
    let reports: Vec<_> = reports.iter().flat_map(|file| ["--report", file]).collect();
    let run = [
        "run",
        "says.star",
        "--serial-no",
        serial,
        "--operator",
        ACTS,
    ];
    let all = &[&run[..], &["--train-no", ACTS], &reports].concat();
    let said = place.ptu(all).exits(1);
    assert!(
        said.err.contains(SHOWN) && said.out.contains(SHOWN),
        "{}",
        said.all()
    );
    let mut told = vec![said.out, said.err];
    for file in ["r.html", "r.csv", "r.json", "r.junit.xml"] {
        told.push(place.read(file));
    }
    let fault = place.json(&["faults", "list", "--json"]);
    let fault = text(&list(&fault)[0]["id"]).to_owned();
    let two_lines = format!("first{ACTS}\nsecond");
    let sql = format!("SELECT serial AS \"head{ACTS}\", char(27, 155, 127, 8238) FROM unit");
    let questions: &[(&[&str], i32)] = &[
        (&["faults", "note", &fault, &two_lines, "--who", ACTS], 0),
        (&["runs", "note", "latest", &two_lines, "--who", ACTS], 0),
        (
            &[
                "faults", "repair", &fault, "--part", ACTS, "--old", ACTS, "--who", ACTS,
            ],
            0,
        ),
        (&["runs", "list"], 0),
        (&["runs", "list", "--json"], 0),
        (&["runs", "show", "latest"], 0),
        (&["runs", "show", "latest", "--json"], 0),
        (&["faults", "list"], 0),
        (&["faults", "list", "--csv"], 0),
        (&["faults", "show", &fault], 0),
        (&["faults", "show", &fault, "--json"], 0),
        (&["db", "query", &sql, "--save", ACTS], 0),
        (&["db", "query", &sql, "--csv"], 0),
        (&["db", "query", &sql, "--json"], 0),
        (&["saved"], 0),
        (&["saved", serial], 2),
        (&["runs", "list", "--unit", ACTS], 0),
        (&["run", "--list", "says.star"], 0),
        (&["run", "--line", ACTS], 2),
        (&["trace", "diff", "latest", ACTS], 2),
        (&[ACTS], 2),
        (&["diagnose", "latest"], 0),
    ];
    for (arguments, exit) in questions {
        let said = place.ptu(arguments).exits(*exit);
        told.extend([said.out, said.err]);
    }
    let acts = |letter: char| is_unseen(letter) && letter != '\n';
    for said in &told {
        assert!(!said.contains(acts), "{said:?}");
    }
    let json = place.json(&["runs", "show", "latest", "--json"]);
    assert_eq!(json["run"]["operator"], ACTS, "JSON has every letter");
}

#[test]
fn unknown_names_are_named_and_the_near_one_suggested() {
    refused(&[
        (
            &["run", "--inject", "eb_relay.slwo"],
            &[
                "no fault \"eb_relay.slwo\"",
                "\"eb_relay.slow\"",
                "`ptu catalog faults`",
            ],
        ),
        (
            &["run", "--inject", "tra.dead,nothing"],
            &["no fault \"nothing\"", "`ptu catalog faults`"],
        ),
        (
            &["run", "--line", "lin8"],
            &["no line \"lin8\"", "\"line8\""],
        ),
        (
            &["run", "--unit-config", "sg1000"],
            &["no unit configuration \"sg1000\"", "\"sg100\""],
        ),
        (
            &["catalog", "codes", "--unit-config", "sg1000"],
            &["no unit configuration \"sg1000\"", "\"sg100\""],
        ),
        (
            &["run", "atp/overspeeed"],
            &[
                "\"atp/overspeeed\"",
                "\"atp/overspeed\"",
                "`ptu run --list`",
            ],
        ),
        (&["run", "atp/[over"], &["\"atp/[over\" is not a glob"]),
        (
            &["run", "atp/overspeed", "--step", "code 99*"],
            &["no step matches \"code 99*\"", "`ptu run --list`"],
        ),
        (&["run", "--step", "code [9"], &["--step is not a glob"]),
        (
            &["run", "--scripts", "nowhere"],
            &["nowhere is not a directory"],
        ),
    ]);
}

#[test]
fn a_wrong_unit_is_refused_before_anything_is_opened() {
    refused(&[
        (&["run", "--unit", "usb:3"], &["usb:3", "tcp:HOST:PORT"]),
        (
            &["run", "--unit", "tcp:nowhere"],
            &["\"nowhere\" is not HOST:PORT"],
        ),
        (
            &["run", "--unit", "tcp:host:port"],
            &["\"host:port\" is not HOST:PORT"],
        ),
        (
            &["run", "--unit", "serial:/dev/ttyS0@fast"],
            &["\"fast\" is not a baud rate"],
        ),
        (&["run", "--unit", "serial:"], &["`ptu ports`"]),
        (
            &["run", "--unit", "serial:/dev/null", "--inject", "tra.dead"],
            &["--inject", "ato-under-test --inject"],
        ),
        (
            &[
                "run",
                "--unit",
                "serial:/dev/null",
                "--inject",
                "inverter.dead,tra.dead",
            ],
            &["--inject", "ato-under-test --inject"],
        ),
        (
            &["run", "--train", "ideal", "--inject", "inverter.dead"],
            &["inverter.dead is on a car", "point mass", "--train"],
        ),
        (
            &["run", "--unit", "serial:/dev/null", "--jobs", "2"],
            &["--jobs", "one port is one unit"],
        ),
        (
            &[
                "run",
                "--serial-no",
                "a serial number that is too long for the wire",
            ],
            &["--serial-no must be 1 to"],
        ),
    ]);
}

#[test]
fn a_report_that_cannot_be_written_is_refused_before_the_run() {
    refused(&[
        (
            &["run", "tcms/link", "--report", "out.txt"],
            &["out.txt", ".json", ".junit.xml"],
        ),
        (
            &["run", "tcms/link", "--report", "nofolder/out.json"],
            &["nofolder/out.json", "folder"],
        ),
    ]);
}

#[test]
fn unknown_records_and_wrong_times_are_refused() {
    refused(&[
        (&["runs", "show", "abcd1234"], &["no run \"abcd1234\""]),
        (
            &["runs", "list", "--verdict", "good"],
            &["\"good\"", "passed"],
        ),
        (
            &["runs", "list", "--since", "last week"],
            &["last week", "30d", "2026-03-21"],
        ),
        (&["faults", "show", "abcd1234"], &["no fault \"abcd1234\""]),
        (&["faults", "show", "latest"], &["no fault"]),
        (
            &["faults", "state", "latest", "broken"],
            &["broken", "acknowledged"],
        ),
        (
            &["faults", "trend", "los_time"],
            &[
                "no measurement \"los_time\"",
                "\"loss_time\"",
                "`ptu run --list`",
            ],
        ),
        (
            &["faults", "trend", "loss_time", "--unit", "X-1"],
            &["\"loss_time\"", "X-1", "`ptu runs list`"],
        ),
        (&["trace", "show", "latest"], &["no trace"]),
        (&["trace", "export", "latest", "--to", "x.txt"], &[".csv"]),
        (
            &["db", "query", "DELETE FROM run"],
            &["only one reading statement", "SELECT"],
        ),
        (&["db", "query", "SELEC 1"], &["the query failed", "SELEC"]),
        (
            &["db", "backup", "history.db"],
            &["history.db", "name a file that does not"],
        ),
        (
            &["db", "import", "history.db"],
            &["history.db", "name another file"],
        ),
    ]);
}

#[test]
fn a_syntax_error_is_shown_with_its_place() {
    does_not_load(
        "step(\"a\", do = wait(s(1))\n",
        &["wrong.star:3:1:", "Parse error"],
    );
}

#[test]
fn a_misspelt_name_is_found_in_a_branch_never_taken() {
    does_not_load(
        "step(\"a\", do = wait(s(1)), expect = becomes(eb, \"applied\"))\n\
         if False:\n    step(\"b\", expect = becomes(ebb, \"applied\"))\n",
        &["wrong.star:4:", "`ebb`", "`eb`"],
    );
}

#[test]
fn a_runtime_error_is_shown_with_its_place() {
    does_not_load("x = [1][3]\n", &["wrong.star:2:5:", "Index `3`"]);
}

#[test]
fn wrong_types_units_and_verbs_are_shown_with_what_is_wanted() {
    does_not_load(
        "step(\"a\", do = wait(kmh(3)))\n",
        &["wrong.star:2:", "wants a time such as s(2)", "3 km/h"],
    );
    does_not_load(
        "step(\"a\", do = tacho.speed(to = \"fast\"))\n",
        &["wrong.star:2:", "wants a speed such as kmh(55)", "\"fast\""],
    );
    does_not_load(
        "step(\"a\", do = tacho.sped(kmh(3)))\n",
        &["wrong.star:2:", "sped", "speed"],
    );
    does_not_load(
        "step(\"a\", expect = becomes(eb, \"aplied\"))\n",
        &["wrong.star:2:", "aplied", "applied"],
    );
}

#[test]
fn a_script_that_never_ends_is_stopped() {
    does_not_load(
        "def long():\n    for a in range(1000000):\n        for b in range(1000000):\n            pass\nlong()\n",
        &["wrong.star:"],
    );
}

/// Goal: what a few characters of the script language ask for is refused in bounded time, memory and stack, with
/// the script, by all that reads scripts. Method: built-ins that no count of steps sees into.
#[test]
fn a_script_that_asks_for_more_than_a_machine_has_is_refused() {
    let deep = "    x = []\n    for i in range(200000):\n        x = [x]\n    return str(x)\n";
    let double = "    x = \"x\"\n    for i in range(60):\n        x = x + x\n    return x\n";
    let conditions = "    c = is_(alarm, True)\n    for i in range(300):\n        c = any_of(c, c)\n    return c\n";
    for (body, words) in [
        ("x = [0] * 1000000000\n", "needs more than 512 MB of memory"),
        ("x = list(range(2000000000))\n", "wrong.star:1:1: "),
        (
            &format!("def f():\n{double}x = f()\n"),
            "needs more than 512 MB of memory",
        ),
        (
            &format!("def f():\n{deep}x = f()\n"),
            "holds values within values too deeply",
        ),
        (
            &format!("def f():\n{conditions}step(\"a\", expect = becomes(f()))\n"),
            "wrong.star:1:1: ",
        ),
    ] {
        does_not_load(body, &[words]);
        let place = Place::new();
        place.write("wrong.star", &format!("{HEAD}{body}"));
        let list = place.ptu(&["run", "--list", "wrong.star"]);
        list.exits(2).explains(&["wrong.star:1:1: ", words]);
    }
    let place = Place::new();
    let square = "def f():\n    x = 3\n    for i in range(40):\n        x = x * x\nf()\n";
    place.write("wrong.star", &format!("{HEAD}{square}"));
    let began = std::time::Instant::now();
    let said = place.ptu(&["run", "--check", "wrong.star"]);
    said.exits(2)
        .explains(&["wrong.star:1:1: takes longer than 9 s to load"]);
    // By the clock of a machine that has other work.
    assert!(began.elapsed() < std::time::Duration::from_secs(70));
}

/// Nothing is opened that is no file: nobody writes to these pipes, and who opens one waits for that.
#[test]
fn pipes_and_devices_are_refused_wherever_a_file_is_named() {
    let place = Place::new();
    place.recorded_run();
    let pipe = |name: &str| {
        let made = std::process::Command::new("mkfifo")
            .arg(place.path(name))
            .status();
        assert!(made.expect("mkfifo starts").success());
    };
    for name in ["p.star", "p.toml", "p.json", "p.csv", "p.mcap"] {
        pipe(name);
    }
    std::fs::create_dir(place.path("scripts")).expect("a folder");
    for name in ["units", "lines", "trains"] {
        let to = place.path("scripts").join(name);
        std::os::unix::fs::symlink(scripts().join(name), to).expect("linked");
    }
    pipe("scripts/p.star");
    for arguments in [
        &["run", "p.star"][..],
        &["run", "--check", "--scripts", "scripts"],
        &["run", "--train", "p.toml"],
        &["run", "--scatter=p.toml", "tcms/link"],
        &["drive", "--manual", "p.toml"],
        &["drive", "--train", "p.toml"],
        &["diagnose", "--matrix", "p.json"],
        &["diagnose", "--matrix", "/dev/zero"],
    ] {
        place.ptu(arguments).exits(2).explains(&["no regular file"]);
    }
    pipe("p.db");
    let said = place.ptu(&["runs", "list", "--db", "p.db"]);
    said.exits(3).explains(&["p.db is not a database"]);
    let looped = std::os::unix::fs::symlink(".", place.path("scripts/again"));
    looped.expect("linked");
    std::fs::remove_file(place.path("scripts/p.star")).expect("there");
    let said = place.ptu(&["run", "--check", "--scripts", "scripts"]);
    said.exits(2).explains(&["again", "does a link lead back?"]);
}

/// Goal: a question to the database ends within its bounds, whichever it exceeds, and says how to allow more.
#[test]
fn a_question_that_takes_too_much_is_given_up() {
    let place = Place::new();
    place.recorded_run();
    let endless =
        "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT count(*) FROM n";
    let many = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n LIMIT 400000) \
        SELECT count(*) FROM (SELECT DISTINCT hex(x) FROM n)";
    // One step of SQLite's from begin to end.
    let one_function = "SELECT instr(hex(zeroblob(10000000)), hex(zeroblob(5000000)) || '1')";
    for (options, sql, way_out) in [
        (
            ["--max-time", "1"],
            endless,
            "longer than 1 s; ask for less, or allow more with --max-time",
        ),
        (
            ["--max-time", "1"],
            one_function,
            "or allow more with --max-time",
        ),
        (
            ["--max-memory", "64"],
            "SELECT length(hex(zeroblob(100000000)))",
            "allow more with --max-memory",
        ),
        (
            ["--max-disk", "1"],
            many,
            "more than 1 MB of temporary disk; ask for less, or allow more with --max-disk",
        ),
    ] {
        let said = place.ptu(&["db", "query", options[0], options[1], sql]);
        said.exits(2)
            .explains(&["the question was given up", way_out]);
    }
    let long = "SELECT hex(zeroblob(20000000))";
    place
        .ptu(&["db", "query", long])
        .exits(2)
        .explains(&["a row is longer than", "substr()"]);
    let answer = place.json(&["db", "query", "--json", many]);
    assert_eq!(answer["rows"][0][0], 400_000);
}

#[test]
fn a_part_that_is_none_cannot_be_suspected() {
    let place = Place::new();
    let script = HEAD.replace("atp_cpu", "atp_cqu") + "step(\"a\", do = wait(s(1)))\n";
    place.write("wrong.star", &script);
    place.ptu(&["run", "wrong.star"]).exits(2).explains(&[
        "wrong.star:1:",
        "no part \"atp_cqu\"",
        "\"atp_cpu\"",
        "`ptu catalog lrus`",
    ]);
}

#[test]
fn check_reports_the_errors_of_all_scripts() {
    let place = Place::new();
    place.write("one.star", &format!("{HEAD}step(\"a\", do = wait(s(1))\n"));
    place.write(
        "two.star",
        &format!("{HEAD}step(\"a\", do = wait(kmh(1)))\n"),
    );
    place.write(
        "good.star",
        &format!("{HEAD}step(\"a\", do = wait(s(1)))\n"),
    );
    place
        .ptu(&["run", "--check", "one.star", "two.star", "good.star"])
        .exits(2)
        .explains(&["one.star:3:1:", "two.star:2:", "2 errors in the scripts"]);
    let said = place.ptu(&["run", "--check"]).exits(0);
    assert!(said.out.contains("no errors"), "{}", said.all());
}

/// Goal: a step that outlasts its limit is an error, not a pass and not a hang, the other steps
/// still run, and so does clean-up. Method: a clean-up that cannot succeed is reported when it ran.
#[test]
fn a_step_that_runs_too_long_is_an_error_and_clean_up_runs() {
    let place = Place::new();
    let earlier = place.recorded_run();
    place.write(
        "long.star",
        "procedure(title = \"Test\", title_ko = \"시험\", cleanup = until(mode, \"yard\", within = s(1)))\n\
         step(\"too long\", do = wait(s(60)), limit = s(2))\n\
         step(\"short\", do = wait(s(1)))\n",
    );
    let (said, report) = place.run(&["long.star"]);
    let said = said
        .exits(3)
        .explains(&["too long", "time limit of 2.000 s", "clean-up:", "yard"]);
    let steps = list(&report["steps"]);
    let verdicts: Vec<_> = steps.iter().map(|s| text(&s["verdict"])).collect();
    assert_eq!(verdicts, ["error", "passed"], "{}", said.all());
    assert!(text(&steps[0]["message"]).contains("time limit"));
    assert_eq!(report["run"]["verdict"], "error");
    assert!(place.run_ids().contains(&earlier));
}

#[test]
fn a_prompt_that_nobody_can_answer_is_an_error() {
    let place = Place::new();
    place.write(
        "prompt.star",
        &format!("{HEAD}step(\"ask\", do = prompt(\"Is the lamp lit?\"))\n"),
    );
    let (said, report) = place.run(&["prompt.star"]);
    said.exits(3).explains(&["Is the lamp lit?"]);
    assert_eq!(report["steps"][0]["verdict"], "error");
}

/// A scripts directory with one line file, `lines/slip.toml`, and a sound unit configuration.
fn scripts_with_line(place: &Place, line: &str) -> String {
    for folder in ["units", "lines"] {
        std::fs::create_dir_all(place.path("mine").join(folder)).expect("a folder");
    }
    place.write("mine/units/sg100.toml", &delivered("units/sg100.toml"));
    place.write("mine/lines/slip.toml", line);
    place.text_path("mine")
}

/// A file of the scripts directory.
fn delivered(name: &str) -> String {
    std::fs::read_to_string(scripts().join(name)).expect("a data file")
}

/// Goal: a slip of the finger in a track database is named with file, line and reason.
#[test]
fn a_wrong_track_database_is_refused_with_line_and_reason() {
    let place = Place::new();
    let good = delivered("lines/line8.toml");
    for (entry, instead, words) in [
        (
            "741.53, 829.03",
            "829.03, 741.53",
            "section 61: PSM3 at 741.53 m must lie after PSM2 at 829.03 m",
        ),
        (
            "length_m = 850.03",
            "length_m = -850.03",
            "section 61: length_m = -850.03",
        ),
        ("stop_m = 850.03\n", "\n", "missing field `stop_m`"),
    ] {
        let damaged = good.replacen(entry, instead, 1);
        assert_ne!(damaged, good, "{entry}");
        let mine = scripts_with_line(&place, &damaged);
        let said = place.ptu(&["catalog", "lines", "--scripts", &mine]);
        let said = said.exits(2).explains(&["slip.toml: ", "line ", words]);
        assert!(
            place
                .ptu(&["run", "--line", "slip", "--scripts", &mine])
                .exits(2)
                .err
                .contains(words),
            "{}",
            said.all()
        );
    }
}

/// Goal: a file changed without its checksum is refused, and the one it has now is told.
#[test]
fn a_wrong_checksum_of_a_track_database_is_refused() {
    let place = Place::new();
    let track = |checksum: &str| {
        let track = delivered("lines/test_track.toml");
        let others = track.lines().filter(|line| !line.starts_with("checksum"));
        let guarded = format!(
            "checksum = \"{checksum}\"\n{}",
            others.collect::<Vec<_>>().join("\n")
        );
        scripts_with_line(&place, &guarded)
    };
    let arguments =
        |mine: &str| ["catalog", "lines", "--json", "--scripts", mine].map(str::to_owned);
    let refused = place.ptu(&arguments(&track("00000000")).each_ref().map(String::as_str));
    let refused = refused
        .exits(2)
        .explains(&["slip.toml: line 1: checksum \"00000000\" is wrong"]);
    let told = refused
        .err
        .split("is \"")
        .nth(1)
        .and_then(|rest| rest.get(..8));
    let told = told.expect("the file's own checksum").to_owned();
    let taken = place.json(&arguments(&track(&told)).each_ref().map(String::as_str));
    assert_eq!(taken[0]["checksum"], told.as_str());
}

/// A fault of the catalogue that nobody could carry out is named, with what there is instead.
#[test]
fn a_wrong_fault_catalogue_is_refused_with_the_fault_and_the_reason() {
    let place = Place::new();
    let mine = scripts_with_line(&place, &delivered("lines/line8.toml"));
    let good = delivered("units/faults.toml");
    for (entry, instead, words) in [
        (
            "place = \"inverter\"\neffect = { kind = \"dead\" }",
            "place = \"inverter\"\neffect = { kind = \"stuck_on\" }",
            "fault inverter.dead: stuck_on does nothing at inverter; there: dead",
        ),
        (
            "factor = 0.5 }\ncar = 5",
            "factor = 0.5 }",
            "fault brake_cylinder.weak: brake_cylinder is on a car, name it with `car`",
        ),
        (
            "place = \"brake_cylinder\"\neffect = { kind = \"gain\", factor = 0.5 }",
            "place = \"brake_cylinder\"\neffect = { kind = \"gain\", factor = -1 }",
            "fault brake_cylinder.weak: effect.factor = -1 is outside 0 .. 1",
        ),
        (
            "place = \"tcms\"",
            "place = \"tcm\"",
            "unknown variant `tcm`",
        ),
    ] {
        let damaged = good.replacen(entry, instead, 1);
        assert_ne!(damaged, good, "{entry}");
        place.write("mine/units/faults.toml", &damaged);
        place
            .ptu(&["catalog", "faults", "--scripts", &mine])
            .exits(2)
            .explains(&["faults.toml: ", words]);
    }
}
