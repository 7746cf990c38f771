//! Questions about the history as a depot asks them, from the first fault to the closed one.

#![allow(clippy::print_stderr, reason = "says why a test proves nothing here")]

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use crate::common::{Place, has, list, relay_fault, text};
use chrono::{Local, Utc};

/// A unit of train 8203 with a slow relay, which is repaired, proven by a run and closed.
pub(crate) fn mended() -> Place {
    let place = Place::new();
    let unit = "run atp/overspeed --serial-no BAD-1 --train-no 8203";
    place
        .ptu(&format!("{unit} --inject eb_relay.slow"))
        .exits(1);
    let fault = relay_fault(&place);
    let id = text(&fault["id"]);
    let repair = format!(
        "faults repair {id} --part EB_relay --old R-17 --new R/99_b --who 김 --note '비상제동 릴레이 교체함'"
    );
    place.ptu(&repair).exits(0);
    place.ptu(unit).exits(0);
    place
}

/// Makes a test that speaks of today; again if it fails while another day, or month, began.
pub(crate) fn within_a_day(test: impl Fn()) {
    let today = || (Local::now().date_naive(), Utc::now().date_naive());
    loop {
        let day = today();
        match catch_unwind(AssertUnwindSafe(&test)) {
            Ok(()) => return,
            Err(panic) if day == today() => resume_unwind(panic),
            Err(_) => eprintln!("another day began"),
        }
    }
}

#[test]
fn faults_of_today_are_found() {
    within_a_day(|| {
        let place = mended();
        let today = place.json("faults list --when today --json");
        assert!(list(&today).iter().any(|one| one["part"] == "eb_relay"));
    });
}

/// Goal: no limit is told of a value that it does not hold for, and a step is asked for by its name. Method: a
/// measurement that several procedures and steps make.
#[test]
fn a_trend_is_of_one_step_where_one_is_asked_for() {
    let place = mended();
    let trend = |options: &[&str]| {
        let asked = [
            &[
                "faults",
                "trend",
                "eb_reaction",
                "--serial-no",
                "BAD-1",
                "--json",
            ],
            options,
        ];
        place.json(&asked.concat())
    };
    let all = trend(&[]);
    let steps = list(&all["steps"]);
    assert!(steps.len() > 1, "{all}");
    let limits: Vec<_> = steps.iter().map(|step| &step["high"]).collect();
    let differ = limits.iter().any(|high| *high != limits[0]);
    assert_eq!(all["high"].is_null(), differ, "{all}");
    let mut points = 0;
    for step in steps {
        let (procedure, name) = (text(&step["procedure"]), text(&step["step"]));
        let one = trend(&["--procedure", procedure, "--step", name]);
        assert_eq!(one["high"], step["high"], "{one}");
        assert!(
            list(&one["points"])
                .iter()
                .all(|point| point["high"] == step["high"])
        );
        points += list(&one["points"]).len();
    }
    assert_eq!(points, list(&all["points"]).len());
    let mistaken = "faults trend eb_reaction --step 'code 55 alarm, FSB, EB'";
    place.ptu(mistaken).exits(2).explains(&["did you mean"]);
}

#[test]
fn help_is_broken_where_the_terminal_ends() {
    const COLUMNS: usize = 60;
    let place = Place::new();
    let width = ("COLUMNS", &COLUMNS.to_string());
    let help = place.ptu_where(width, "faults stats --help").exits(0).out;
    let lines: Vec<_> = help
        .lines()
        .take_while(|line| *line != "Examples:")
        .collect();
    assert!(lines.len() > 8, "{help}");
    for two in lines.windows(2).filter(|two| !two.contains(&"")) {
        let word = two[1].split(' ').next().unwrap_or_default();
        assert!(two[0].len() + 1 + word.len() > COLUMNS, "{two:?} in {help}");
    }
    has(&help, &["\n  ptu faults stats --by part --when 2026\n"]);
}
