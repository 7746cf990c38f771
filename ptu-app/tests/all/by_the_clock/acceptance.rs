//! The whole suite in real time, shared out among units on ports of their own.

use crate::common::served::{Running, Unit};
use crate::common::{Place, list, number, text};
use crate::lock_step::steps_of;
use serde_json::Value;

/// Units tested side by side.
const BENCHES: usize = 6;

/// The suite is shared out among units on ports of their own, each of which is tested in real time beside
/// the others.
#[test]
#[ignore = "long suite: takes four minutes of real time on a quiet machine"]
fn a_whole_acceptance_suite_over_pseudo_terminals_passes_in_real_time() {
    let place = Place::new();
    let planned = list(&place.json("run --list --json")).to_vec();
    let passed: usize = std::thread::scope(|scope| {
        let run = |share: Vec<String>| scope.spawn(move || steps_passed(&share));
        let running: Vec<_> = shared_out(&planned).into_iter().map(run).collect();
        let joined = running.into_iter().map(|thread| thread.join());
        joined.map(|steps| steps.expect("a bench")).sum()
    });
    assert_eq!(passed, steps_of(&planned));
}

/// Procedures for each of the benches, the longest dealt out first, each to the bench that has the
/// least to do.
fn shared_out(planned: &[Value]) -> Vec<Vec<String>> {
    let mut longest: Vec<_> = planned
        .iter()
        .map(|p| (number(&p["worst_case_s"]), text(&p["procedure"]).to_owned()))
        .collect();
    longest.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut shares: Vec<(f64, Vec<String>)> = vec![(0.0, Vec::new()); BENCHES];
    for (time_s, procedure) in longest {
        let least = shares.iter_mut().min_by(|a, b| a.0.total_cmp(&b.0));
        let share = least.expect("benches");
        share.0 += time_s;
        share.1.push(procedure);
    }
    shares
        .into_iter()
        .map(|(_, procedures)| procedures)
        .collect()
}

/// Runs the procedures on a unit of their own and counts the steps, all of which have passed.
fn steps_passed(procedures: &[String]) -> usize {
    let unit = Unit::on_pty(&[]);
    let place = Place::new();
    let procedures = procedures.iter().map(String::as_str);
    let arguments: Vec<_> = procedures.chain(["--report", "report.json"]).collect();
    let said = Running::start(&place, &unit, &arguments).finish().exits(0);
    let report = place.read_json("report.json");
    assert!(list(&report["faults"]).is_empty(), "{}", said.all());
    list(&report["steps"]).len()
}
