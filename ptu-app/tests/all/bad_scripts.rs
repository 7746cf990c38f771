//! Wrong scripts and wrong files beside them: each error is named with its place and what is wanted, and nothing is
//! driven.

use crate::common::{Place, list, scripts, text};
use fuzzing::draw;
use quick_junit::{Report, TestCaseStatus};

const HEAD: &str = "procedure(title = \"Test\", title_ko = \"시험\", suspect = \"atp_cpu\")\n";

/// A script that must not load: exit 2 with these words, and nothing driven.
#[track_caller]
pub fn does_not_load(body: &str, words: &[&str]) {
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

/// Goal: what a few characters of the script language ask for is refused in bounded time, memory and stack, with
/// the script, by all that reads scripts. Method: built-ins that no count of steps sees into.
#[test]
fn a_script_that_asks_for_more_than_a_machine_has_is_refused() {
    let deep = "    x = []\n    for i in range(200000):\n        x = [x]\n    return str(x)\n";
    let double = "    x = \"x\"\n    for i in range(60):\n        x = x + x\n    return x\n";
    let conditions = "    c = is_(alarm, True)\n    for i in range(300):\n        c = any_of(c, c)\n    return c\n";
    let bodies = [
        (
            "x = [0] * 1000000000\n".to_owned(),
            "needs more than 512 MB of memory",
        ),
        (
            "x = list(range(2000000000))\n".to_owned(),
            "wrong.star:1:1: ",
        ),
        (
            format!("def f():\n{double}x = f()\n"),
            "needs more than 512 MB of memory",
        ),
        (
            format!("def f():\n{deep}x = f()\n"),
            "holds values within values too deeply",
        ),
        (
            format!("def f():\n{conditions}step(\"a\", expect = becomes(f()))\n"),
            "wrong.star:1:1: ",
        ),
    ];
    for (body, words) in draw::drawn(bodies, 2) {
        does_not_load(&body, &[words]);
        let place = Place::new();
        place.write("wrong.star", &format!("{HEAD}{body}"));
        let list = place.ptu("run --list wrong.star");
        list.exits(2).explains(&["wrong.star:1:1: ", words]);
    }
}

#[test]
#[ignore = "takes a processor for as long as a script may load"]
fn a_script_that_computes_too_long_is_refused() {
    let place = Place::new();
    let square = "def f():\n    x = 3\n    for i in range(40):\n        x = x * x\nf()\n";
    place.write("wrong.star", &format!("{HEAD}{square}"));
    let began = std::time::Instant::now();
    let said = place.ptu("run --check wrong.star");
    said.exits(2)
        .explains(&["wrong.star:1:1: takes longer than 9 s to load"]);
    // By the clock of a machine that has other work.
    assert!(began.elapsed() < std::time::Duration::from_secs(70));
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
         step(\"too long\", do = wait(s(60)), measure = value(\"v\", speed), limit = s(2))\n\
         step(\"short\", do = wait(s(1)), measure = value(\"v\", speed))\n",
    );
    let (said, report) = place.run("long.star");
    let said = said
        .exits(3)
        .explains(&["too long", "time limit of 2.000 s", "clean-up:", "yard"]);
    let steps = list(&report["steps"]);
    let verdicts: Vec<_> = steps.iter().map(|s| text(&s["verdict"])).collect();
    assert_eq!(verdicts, ["error", "passed", "error"], "{}", said.all());
    assert_eq!(steps[2]["kind"], "clean-up");
    assert!(text(&steps[0]["message"]).contains("time limit"));
    assert_eq!(report["run"]["verdict"], "error");
    assert!(place.run_ids().contains(&earlier));
}

/// Goal: a clean-up that does not succeed is in all that is kept of a run whose steps passed. Method: every format.
#[test]
fn a_clean_up_that_fails_is_in_every_report() {
    let place = Place::new();
    place.write(
        "unclean.star",
        "procedure(title = \"Test\", title_ko = \"시험\", cleanup = until(mode, \"yard\", within = s(1)))\n\
         step(\"short\", do = wait(s(1)), measure = value(\"v\", speed))\n",
    );
    let files = ["r.junit.xml", "r.csv", "r.html"];
    let reports = files.map(|file| ["--report", file]).concat();
    let (said, report) = place.run(&[&["unclean.star"], &reports[..]].concat());
    let said = said.exits(3);
    assert_eq!(report["run"]["verdict"], "error");
    assert_eq!(report["run"]["outside_steps"], 1);
    assert_eq!(report["run"]["steps_not_passed"], 0);
    let of_kind = |kind: &str| {
        let steps = list(&report["steps"]).iter();
        let found: Vec<_> = steps.filter(|step| step["kind"] == kind).collect();
        assert_eq!(found.len(), 1, "{kind}: {report}");
        found[0].clone()
    };
    assert_eq!(of_kind("step")["verdict"], "passed");
    assert_eq!(of_kind("clean-up")["verdict"], "error");
    let why = text(&of_kind("clean-up")["message"]).to_owned();
    assert!(why.contains("yard"), "{why}");

    let junit = Report::deserialize_from_str(&place.read("r.junit.xml")).expect("JUnit XML");
    assert_eq!((junit.tests, junit.errors, junit.failures), (2, 1, 0));
    let case = &junit.test_suites[0].test_cases[1];
    let TestCaseStatus::NonSuccess { message, ty, .. } = &case.status else {
        panic!("{case:?}");
    };
    assert_eq!(message.as_ref().expect("a message").as_str(), why);
    assert_eq!(ty.as_ref().expect("a type").as_str(), "clean-up error");
    assert!(case.timestamp.is_some() && !case.properties.is_empty());
    for shown in [
        place.read("r.csv"),
        place.read("r.html"),
        said.all(),
        place.ptu("runs show latest").exits(0).out,
    ] {
        assert!(shown.to_lowercase().contains("clean-up"), "{shown}");
        assert!(shown.contains("yard"), "{shown}");
    }
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
