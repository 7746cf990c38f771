//! Inputs of others act on nothing. `bad_steps` and `wrong_commands` among the sessions have commands that are
//! wrong.

use crate::common::{Place, list, text};
use protocol::display_text::is_unseen;

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
