//! Scripts that ask for too much. `wrong_scripts`, `bad_steps` and `wrong_data` among the sessions have the rest.

use crate::common::Place;
use fuzzing::draw;

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
