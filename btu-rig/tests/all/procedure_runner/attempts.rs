//! Steps in which the tester's computer stood still: not tested, repeated from the set-up, and never more often than
//! that.

use btu_rig::procedure::{ResultKind, RunEvent, Verdict};
use protocol::event::Event;
use protocol::signal::Signal;
use protocol::{Duration, Instant};

use super::stand_in::{HEAD, OFF, ON, Outcome, World, run};

/// Name, verdict and whether another attempt follows, of each result.
fn attempts(outcome: &Outcome) -> Vec<(&str, Verdict, bool)> {
    let steps = outcome.steps().into_iter();
    steps
        .map(|step| {
            (
                step.name.as_str(),
                step.verdict,
                step.kind == ResultKind::Attempt,
            )
        })
        .collect()
}

/// The verdict over all attempts.
fn overall(outcome: &Outcome) -> Verdict {
    let ends = outcome.events.iter().filter_map(|event| match event {
        RunEvent::ProcedureFinished { verdict, .. } => Some(*verdict),
        _ => None,
    });
    ends.fold(Verdict::Skipped, Verdict::and)
}

/// Stands still at each of these times, ms, after which the unit brakes and says why.
fn standing_still(at_ms: &'static [u32]) -> impl FnMut(&mut World) {
    move |world| {
        let braked = at_ms.contains(&world.ms());
        world.sample.set(Signal::Eb, f64::from(braked));
        if braked {
            world.runner.stood_still(Duration::from_ms(300));
            world.log(Event::InputsLost);
        }
    }
}

const PASSED: Verdict = Verdict::Passed;
const AGAIN: Verdict = Verdict::Skipped;

/// Goal: a computer that stands still for a moment is no fault of the unit, and costs no verdict. Method: it does so in
/// the second step; brake and event come in with the scan after it.
#[test]
fn the_step_is_repeated_from_the_set_up_and_those_before_are_not() {
    let script = format!("{HEAD}look('a')\nlook('b', do = wait(s(2)))\nlook('c')");
    let outcome = run(&script, standing_still(&[1000]));
    let expected = [
        ("a", PASSED, false),
        ("b", AGAIN, true),
        ("b", PASSED, false),
        ("c", PASSED, false),
    ];
    assert_eq!(attempts(&outcome), expected);
    assert_eq!(outcome.finished(), (PASSED, ""));
    assert_eq!(
        outcome.steps()[1].findings.to_string(),
        "not tested in attempt 1 of 3: the tester's computer or the link stood still for 0.30 s, which says nothing about the \
         unit; the step is repeated (2 of 3)"
    );
    assert_eq!(outcome.fake.applied, [ON, OFF, ON, OFF]);
    assert!(outcome.fake.made_safe >= 2, "test signals are withdrawn");
    assert_eq!(outcome.unsolicited(), 0);
}

#[test]
fn a_step_that_continues_is_repeated_with_those_it_continues_from() {
    let script = format!(
        "{HEAD}look('a', do = wait(s(1)))\nlook('b', do = cab.key(False))\n\
         look('c', do = wait(s(2)), continues = True)"
    );
    let outcome = run(&script, standing_still(&[2000]));
    let expected = [
        ("a", PASSED, false),
        ("b", PASSED, false),
        ("c", AGAIN, true),
        ("c", PASSED, false),
    ];
    assert_eq!(attempts(&outcome), expected);
    assert_eq!(outcome.fake.applied, [ON, OFF, OFF, ON, OFF, OFF]);
}

/// A failure of a step that is run again is not hidden.
#[test]
fn a_step_that_fails_when_it_is_run_again_is_told() {
    let script = format!(
        "{HEAD}step('b', expect = becomes(speed, kmh(0)))\nlook('c', do = wait(s(2)), continues = True)"
    );
    let outcome = run(&script, |world| {
        if world.ms() == 1000 {
            world.runner.stood_still(Duration::from_ms(300));
            world.sample.set(Signal::Speed, 5.0);
        }
    });
    let expected = [
        ("b", PASSED, false),
        ("c", AGAIN, true),
        ("b", Verdict::Failed, false),
        ("c", PASSED, false),
    ];
    assert_eq!(attempts(&outcome), expected);
    assert_eq!(outcome.steps()[2].kind, ResultKind::Again);
    assert_eq!(overall(&outcome), Verdict::Failed);
}

#[test]
fn a_failed_step_is_not_repeated() {
    let script = format!(
        "{HEAD}step('a', expect = becomes(eb, 'applied', within = s(1)))\nlook('b', do = wait(s(1)))"
    );
    let outcome = run(&script, |world| {
        if world.ms() == 1500 {
            world.runner.stood_still(Duration::from_ms(300));
        }
    });
    let expected = [
        ("a", Verdict::Failed, false),
        ("b", AGAIN, true),
        ("b", PASSED, false),
    ];
    assert_eq!(attempts(&outcome), expected);
    assert_eq!(overall(&outcome), Verdict::Failed);
}

/// Goal: no end without a verdict. Method: the computer stands still in all attempts at one step.
#[test]
fn after_three_attempts_the_step_is_an_error_and_the_next_that_can_be_is_tested() {
    let script = format!(
        "{HEAD}look('a', do = wait(s(5)))\nlook('b', continues = True)\nlook('c', do = wait(s(1)))"
    );
    let outcome = run(&script, standing_still(&[1000, 2000, 3000]));
    let expected = [
        ("a", AGAIN, true),
        ("a", AGAIN, true),
        ("a", Verdict::Error, false),
        ("b", Verdict::Skipped, false),
        ("c", PASSED, false),
    ];
    assert_eq!(attempts(&outcome), expected);
    assert_eq!(overall(&outcome), Verdict::Error);
    assert_eq!(
        outcome.steps()[3].findings.to_string(),
        "not run, it continues from \"a\", which was not tested"
    );
}

#[test]
fn a_standstill_in_the_set_up_costs_the_first_step_an_attempt() {
    let script =
        "procedure(title = 'x', setup = [wait(s(2))], cleanup = [cab.key(False)])\nlook('a')";
    let outcome = run(script, standing_still(&[1000]));
    assert_eq!(
        attempts(&outcome),
        [("a", AGAIN, true), ("a", PASSED, false)]
    );
    assert_eq!(outcome.finished(), (PASSED, ""));
}

/// Goal: what clean-up waits for in vain because the unit braked is no finding. Method: the brake goes when clean-up
/// is begun again.
#[test]
fn clean_up_is_begun_again() {
    let script = "procedure(title = 'x', cleanup = [cab.key(False), wait(s(1)), until(eb, 'released', within = s(2))])\nlook('a', do = wait(s(1)))";
    let outcome = run(script, |world| {
        let braked = (1100..4500).contains(&world.ms());
        world.sample.set(Signal::Eb, f64::from(braked));
        if world.ms() == 2900 {
            world.runner.stood_still(Duration::from_ms(300));
        }
    });
    assert_eq!(attempts(&outcome), [("a", PASSED, false)]);
    assert_eq!(outcome.finished(), (PASSED, ""));
    assert_eq!(outcome.fake.applied, [OFF, OFF]);
}

/// Goal: a stop is obeyed at any time, and what is left is reported as not run.
#[test]
fn a_stop_ends_the_repetition() {
    let script = format!("{HEAD}look('a')\nlook('b', do = wait(s(2)))\nlook('c')");
    let outcome = run(&script, |world| match world.ms() {
        1000 => world.runner.stood_still(Duration::from_ms(300)),
        2500 => world.runner.stop(),
        _ => {}
    });
    let expected = [
        ("a", PASSED, false),
        ("b", AGAIN, true),
        ("b", Verdict::Aborted, false),
        ("c", Verdict::Skipped, false),
    ];
    assert_eq!(attempts(&outcome), expected);
    assert_eq!(overall(&outcome), Verdict::Aborted);
}

/// Goal: a pause of the computer in which the unit stood still as well may lose frames, and what comes of them is not held
/// against the unit; a step that passes all the same is tested. Method: such a pause in each step, after which the unit
/// brakes and says why, TCMS is late, or nothing happens.
#[test]
fn what_comes_of_a_pause_of_both_is_not_held_against_the_unit() {
    let script = format!(
        "{HEAD}look('a', do = wait(s(1)))\nlook('b', do = wait(s(2)))\n\
         step('c', expect = becomes(speed, kmh(9), within = s(2)))"
    );
    let mut done = false;
    let outcome = run(&script, |world| {
        let ms = world.ms();
        if [500, 1500, 5500].contains(&ms) {
            world
                .runner
                .paused_with_unit(Instant::from_ms(u64::from(ms)), Duration::from_ms(300));
        }
        if ms == 1800 && !done {
            done = true;
            world.log(Event::InputsLost);
        }
    });
    let expected = [
        ("a", PASSED, false),
        ("b", AGAIN, true),
        ("b", PASSED, false),
        ("c", AGAIN, true),
        ("c", Verdict::Failed, false),
    ];
    assert_eq!(attempts(&outcome), expected, "{:#?}", outcome.steps());
    assert_eq!(overall(&outcome), Verdict::Failed);
}

/// A failure of the unit before the computer stood still fails the procedure, and is reported, although the step is
/// repeated.
#[test]
fn what_came_before_the_pause_counts_and_is_told() {
    let script = format!("{HEAD}look('b', do = wait(s(2)))");
    let mut done = false;
    let outcome = run(&script, |world| {
        if world.ms() == 900 && !done {
            done = true;
            world.log(Event::InputsLost);
        }
        if world.ms() == 1000 && done {
            world.runner.stood_still(Duration::from_ms(300));
        }
    });
    assert_eq!(overall(&outcome), Verdict::Failed);
    let told = outcome.events.iter().any(|event| {
        matches!(event, RunEvent::ProcedureFinished { findings, .. }
            if findings.to_string().contains("before the tester's computer or the link stood still: the unit logged inputs_lost"))
    });
    assert!(told, "{:#?}", outcome.events);
}
