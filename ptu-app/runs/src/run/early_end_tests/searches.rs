//! The verdict of a search for a part that ends early.

use super::*;
use crate::run::BenchChoice;

/// A search for a part among these procedures.
fn search(procedures: &[String], setup: &BenchSetup) -> RunPlan {
    let suite = Suite::load(&scripts(), procedures, setup).expect("the suite");
    let mut plan = RunPlan::of(suite.procedures.into_iter().filter(|p| !p.on_request));
    let choice = BenchChoice::default();
    let bench = run_diagnosis::Bench {
        unit_config_sha256: &setup.config.sha256,
        line: &choice.line,
        train: &choice.train,
        connection: choice.connection(),
        practice: true,
    };
    let serial = setup.expected_serial();
    let (_folder, store) = store();
    let adaptive = run_diagnosis::adaptive(&store, &scripts(), (&serial, None), &bench);
    plan.adaptive = Some(adaptive.expect("the shipped dictionary"));
    plan
}

/// Goal: a search for a part that was stopped is not taken for one that found nothing more. Method: an
/// adaptive run on a good unit, which it leaves after the last procedure only, stopped after the first.
#[test]
fn a_search_stopped_between_two_procedures_is_aborted() {
    let two = ["atp/limit_speed", "door/interlocks"].map(str::to_owned);
    let plan = search(&two, &setup(&[]));
    assert_eq!(plan.tasks.len(), 2);
    let (outcome, stored) = stopped_after(0, &plan);
    assert_eq!(stored, fault_db::Verdict::Aborted);
    assert_eq!(outcome.exit, Exit::Aborted);
}

/// Goal: a search judges each step before the next begins, whoever ordered it. Method: the part is found by a
/// step that others follow at once.
#[test]
fn a_search_ends_with_the_step_that_found_the_part() {
    let mut setup = setup(&[]);
    let faults = scripts().faults().expect("faults");
    setup.faults = vec![faults.fault("marker_antenna.dead").expect("mode").clone()];
    let plan = search(&[], &setup);
    let (_, detail) = recorded(&Arc::new(StopBeforeScan::default()), &plan, setup);
    let last = detail.steps.last().expect("a step");
    assert_eq!(
        last.verdict,
        fault_db::Verdict::Failed,
        "{:#?}",
        detail.steps
    );
}
