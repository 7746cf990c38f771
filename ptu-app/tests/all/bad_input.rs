//! Wrong commands: what is wrong is named, the next move is said, nothing is driven, and what was recorded before
//! is still there.

use crate::bad_scripts::does_not_load;
use crate::common::{Place, list, scripts, text};
use protocol::display_text::is_unseen;

#[test]
fn a_text_longer_than_is_kept_is_refused_before_anything_is_driven() {
    let place = Place::new();
    let earlier = place.recorded_run();
    let (name, note) = (&*"가".repeat(256), &*"a".repeat(4_001));
    for (arguments, words) in [
        (
            ["run", "tcms/link", "--who", name],
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
    let run = ["run", "says.star", "--serial-no", serial, "--who", ACTS];
    let all = &[&run[..], &["--train-no", ACTS], &reports].concat();
    let said = place.ptu(all).exits(1);
    assert!(
        said.err.contains(SHOWN) && said.out.contains(SHOWN),
        "{}",
        said.all()
    );
    let mut told = vec![said.out, said.err];
    for file in ["r.html", "r.csv", "r.json", "r.junit.xml"] {
        let text = place.read(file);
        told.push(text.strip_prefix('\u{feff}').unwrap_or(&text).to_owned());
    }
    let fault = place.json("faults list --json");
    let fault = text(&list(&fault)[0]["id"]).to_owned();
    let two_lines = format!("first{ACTS}\nsecond");
    let sql = format!("SELECT serial AS \"head{ACTS}\", char(27, 155, 127, 8238) FROM unit");
    let questions: &[(&[&str], i32)] = &[
        (&["faults", "note", &fault, &two_lines, "--who", ACTS], 0),
        (&["runs", "note", "latest", &two_lines, "--who", ACTS], 0),
        (
            &[
                "faults",
                "repair",
                &fault,
                "--other-part",
                ACTS,
                "--old",
                ACTS,
                "--who",
                ACTS,
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
        (&["runs", "list", "--serial-no", ACTS], 2),
        (&["run", "--list", "says.star"], 0),
        (&["run", "--line", ACTS], 2),
        (&["trace", "diff", "latest", ACTS], 2),
        (&[ACTS], 2),
        (&["diagnose", "latest"], 0),
    ];
    for (arguments, exit) in questions {
        let said = place.ptu(*arguments).exits(*exit);
        told.extend([said.out, said.err]);
    }
    let acts = |letter: char| is_unseen(letter) && letter != '\n';
    for said in &told {
        assert!(!said.contains(acts), "{said:?}");
    }
    let json = place.json("runs show latest --json");
    assert_eq!(json["run"]["operator"], ACTS, "JSON has every letter");
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
        &["run", "--scattered=p.toml", "tcms/link"],
        &["drive", "--train", "p.toml"],
        &["matrix", "p.json"],
        &["matrix", "/dev/zero"],
    ] {
        place.ptu(arguments).exits(2).explains(&["no regular file"]);
    }
    pipe("p.db");
    let said = place.ptu("runs list --db p.db");
    said.exits(3).explains(&["p.db is not a database"]);
    let looped = std::os::unix::fs::symlink(".", place.path("scripts/again"));
    looped.expect("linked");
    std::fs::remove_file(place.path("scripts/p.star")).expect("there");
    let said = place.ptu("run --check --scripts scripts");
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
