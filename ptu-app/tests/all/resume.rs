//! A run that was interrupted, stopped or could not test is gone on with as a new run, linked to it.

use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::common::{Place, list, number, text};
use serde_json::Value;

/// A busy machine gets that far within this time.
const SOON: Duration = Duration::from_secs(120);

fn procedures(report: &Value) -> Vec<&str> {
    let mut ids: Vec<_> = (list(&report["steps"]).iter())
        .map(|step| text(&step["procedure"]))
        .collect();
    ids.dedup();
    ids
}

/// Starts a run in real time and kills it in its second procedure, without any chance to put things in order.
fn killed_run(place: &Place) -> Value {
    let arguments = "run ptu/identity tcms/link twc/exchange --realtime --seed 7";
    let mut run = (place.command(arguments))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("ptu starts");
    let begun = Instant::now();
    let seen = loop {
        assert!(
            begun.elapsed() < SOON,
            "no step of the second procedure was stored"
        );
        std::thread::sleep(Duration::from_millis(100));
        let steps = place.steps_so_far();
        if steps.iter().any(|step| step["procedure"] == "tcms/link") {
            break steps.len();
        }
    };
    run.kill().expect("killed");
    run.wait().expect("over");
    let left = place.json("runs show latest --json");
    assert_eq!(left["run"]["state"], "interrupted", "{left}");
    assert!(list(&left["steps"]).len() >= seen, "{left}");
    left
}

/// Goal: what a run has finished survives a kill, and only the rest is run again.
#[test]
fn a_killed_run_keeps_its_steps_and_is_gone_on_with() {
    let place = Place::new();
    let killed = killed_run(&place);
    let id = text(&killed["run"]["id"]);
    assert_eq!(procedures(&killed), ["ptu/identity", "tcms/link"]);

    let (said, report) = place.run(&["--resume", id]);
    assert!(
        said.out
            .contains(&format!("continues run {}", &id[id.len() - 8..])),
        "{}",
        said.all()
    );
    said.exits(0);
    // The one under way may not have been through: no row says so.
    assert_eq!(procedures(&report), ["tcms/link", "twc/exchange"]);
    assert_eq!(report["run"]["continues"], id);
    assert_eq!(number(&report["run"]["seed"]), 7.0);
    let shown = place.ptu("runs show latest --report sheet.html").exits(0);
    assert!(shown.out.contains("continues run"), "{}", shown.all());
    let sheet = place.read("sheet.html");
    assert!(
        sheet.contains("Continues run") && sheet.contains(id),
        "the report says it"
    );
    place.ptu("db check").exits(0);

    // All that was due has a verdict now.
    place
        .ptu("run --resume latest")
        .exits(2)
        .explains(&["each procedure of run", "--retry-errors"]);
}
