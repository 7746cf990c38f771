//! The verdict of a procedure whose repetitions end early.

use super::*;

/// Each repetition of a procedure begins with its set-up and ends with its clean-up.
const LEAVES_THE_KEY_ON: &str = "procedure(title = \"Key\", suspect = \"-\", setup = cab.key(False), cleanup = wait(ms(500)))\n\
     step(\"off\", do = wait(ms(200)), expect = becomes(maintenance_key, False))\n\
     step(\"on\", do = [cab.key(True), wait(ms(200))], expect = becomes(maintenance_key, True))\n";

#[test]
fn a_repetition_is_the_procedure_again_with_its_set_up_and_clean_up() {
    let mut plan = plan_of(&[LEAVES_THE_KEY_ON, PASSES]);
    plan.tasks[0].options.repeat = 3;
    let (outcome, detail) = recorded(&Arc::new(StopBeforeScan::default()), &plan, setup(&[]));
    assert_eq!(outcome.exit, Exit::Passed, "{:#?}", detail.steps);
    let steps = detail.steps.iter();
    let turns: Vec<_> = steps
        .map(|step| (step.name.as_str(), step.turn, step.turns))
        .collect();
    let rounds = (1..=3).flat_map(|turn| [("off", turn, 3), ("on", turn, 3)]);
    let rounds: Vec<_> = rounds.chain([("waits", 1, 1)]).collect();
    assert_eq!(turns, rounds);
}

/// Goal: a run that is stopped is aborted where repetitions are still due, even if the one under way has nothing left
/// to be stopped. Method: stopped in the last scan of the second of three.
#[test]
fn a_procedure_stopped_between_two_repetitions_is_aborted() {
    let once = plan_of(&[LEAVES_THE_KEY_ON]);
    let scans = ends(&once)[0];
    let mut plan = plan_of(&[LEAVES_THE_KEY_ON, PASSES]);
    plan.tasks[0].options.repeat = 3;
    let presser = Arc::new(StopBeforeScan {
        at: Some(2 * scans),
        ..StopBeforeScan::default()
    });
    let (outcome, detail) = recorded(&presser, &plan, setup(&[]));
    assert_eq!(outcome.exit, Exit::Aborted);
    let (steps, outside) = detail.steps.split_at(4);
    let passed = |step: &fault_db::StepRecord| step.verdict == fault_db::Verdict::Passed;
    assert!(steps.iter().all(passed), "{steps:?}");
    let outside: Vec<_> = (outside.iter())
        .map(|step| (step.procedure.as_str(), step.name.as_str()))
        .collect();
    assert_eq!(outside, [("0", "stop"), ("1", "not begun")]);
}

/// Goal: what fails in one repetition ends a run that is to end with its first failure; else the others have
/// their turn.
#[test]
fn a_failed_repetition_ends_a_run_that_stops_on_fail() {
    for (ends, turns) in [(false, 3), (true, 1)] {
        let mut plan = plan_of(&[FAILS]);
        plan.stop_on_fail = ends;
        plan.tasks[0].options.repeat = 3;
        plan.tasks[0].options.stop_on_fail = ends;
        let (outcome, detail) = recorded(&Arc::new(StopBeforeScan::default()), &plan, setup(&[]));
        assert_eq!(outcome.exit, Exit::Failed);
        assert_eq!(detail.steps.len(), turns);
    }
}
