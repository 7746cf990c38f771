//! The order of steps: setup, conditions, repetitions, choice of steps, prompts.

use btu_rig::procedure::link_trouble::LinkTrouble;
use btu_rig::procedure::{PromptPolicy, RunEvent, Verdict};
use btu_rig::stimulus::Stimulus;
use protocol::Instant;
use protocol::signal::Signal;

use super::stand_in::{HEAD, OFF, ON, Outcome, options, run, run_round, run_with};

#[test]
fn setup_steps_and_clean_up_run_in_order_and_outputs_end_safe() {
    let outcome = run(
        &format!("{HEAD}look('a', do = door.open())\nlook('b')"),
        |_| {},
    );
    let applied = [ON, Stimulus::Doors { closed: false }, OFF];
    assert_eq!(outcome.fake.applied, applied);
    assert_eq!(outcome.fake.made_safe, 1);
    let passed = |name| (name, Verdict::Passed, "");
    assert_eq!(outcome.summary(), [passed("a"), passed("b")]);
    assert_eq!(outcome.finished(), (Verdict::Passed, ""));
    let begun = RunEvent::ProcedureStarted {
        steps: 2,
        at: Instant::ZERO,
    };
    assert_eq!(outcome.events[0], begun);
}

#[test]
fn when_skips_a_step_and_missing_data_do_not() {
    let script =
        format!("{HEAD}look('a', when = is_(eb, 'applied'))\nlook('b', when = is_(alarm, True))");
    let outcome = run(&script, |_| {});
    let expected = [
        ("a", Verdict::Skipped, "its condition does not hold"),
        ("b", Verdict::Error, "its condition: no data for alarm"),
    ];
    assert_eq!(outcome.summary(), expected);
    let only_skipped = run(
        &format!("{HEAD}look('a', when = is_(eb, 'applied'))"),
        |_| {},
    );
    assert_eq!(only_skipped.finished().0, Verdict::Skipped);
}

#[test]
fn every_repetition_must_pass() {
    let script = format!(
        "{HEAD}step('a', do = wait(ms(100)), expect = becomes(eb, 'released', within = ms(0)), repeat = 3)"
    );
    let outcome = run(&script, |world| {
        world
            .sample
            .set_bit(Signal::Eb, (150..250).contains(&world.ms()));
    });
    let turns = |outcome: &Outcome| -> Vec<_> {
        let steps = outcome.steps();
        let turns = steps.iter().map(|s| (s.turn, s.turns, s.verdict));
        turns.collect()
    };
    let [passed, failed] = [Verdict::Passed, Verdict::Failed];
    assert_eq!(
        turns(&outcome),
        [(1, 3, passed), (2, 3, failed), (3, 3, passed)]
    );
    assert_eq!(outcome.finished().0, Verdict::Failed);

    // The second of two repetitions of the procedure.
    let options = options(|it| it.repeat = 2);
    let outcome = run_round(&script, options, 1, |_| {});
    assert_eq!(
        turns(&outcome),
        [(4, 6, passed), (5, 6, passed), (6, 6, passed)]
    );
    assert_eq!(outcome.fake.applied, [ON, OFF], "set-up and clean-up");
}

/// Goal: a step that could not be judged for want of data did not pass either.
#[test]
fn a_step_whose_condition_has_no_data_can_stop_the_procedure() {
    let script = format!("{HEAD}look('a', when = is_(limit, above = kmh(3)))\nlook('b')");
    let options = options(|it| it.stop_on_fail = true);
    let outcome = run_with(&script, options, |_| {});
    let verdicts: Vec<_> = outcome.steps().iter().map(|s| s.verdict).collect();
    assert_eq!(verdicts, [Verdict::Error, Verdict::Skipped]);
}

#[test]
fn a_failed_step_can_stop_the_procedure() {
    let script = format!(
        "{HEAD}step('a', expect = becomes(eb, 'applied', within = ms(20)), on_fail = 'stop')\nlook('b')"
    );
    let outcome = run(&script, |_| {});
    let expected = [Verdict::Failed, Verdict::Skipped];
    let verdicts: Vec<_> = outcome.steps().iter().map(|s| s.verdict).collect();
    assert_eq!(verdicts, expected);
    assert_eq!(
        outcome.steps()[1].findings.to_string(),
        "not run, \"a\" did not pass"
    );
    let script = script.replace(", on_fail = 'stop'", "");
    let options = options(|it| it.stop_on_fail = true);
    let outcome = run_with(&script, options, |_| {});
    assert_eq!(outcome.steps()[1].verdict, Verdict::Skipped);
}

#[test]
fn nothing_chosen_is_an_error() {
    for chosen in [vec![], vec![7]] {
        let options = options(|it| it.chosen = Some(chosen));
        let outcome = run_with(&format!("{HEAD}look('a')"), options, |_| {});
        assert_eq!(outcome.finished(), (Verdict::Error, "no step to run"));
        assert_eq!(outcome.fake.made_safe, 1);
        assert!(outcome.fake.applied.is_empty());
    }
}

#[test]
fn prompts_need_an_operator() {
    let script = format!("{HEAD}step('a', do = prompt('Is the lamp lit?', within = s(5)))");
    let outcome = run(&script, |_| {});
    let message = "needs an operator: Is the lamp lit?";
    assert_eq!(outcome.summary(), [("a", Verdict::Skipped, message)]);
    let answers = [
        (Some(true), Verdict::Passed),
        (Some(false), Verdict::Failed),
        (None, Verdict::Error),
    ];
    for (answer, verdict) in answers {
        let options = options(|it| it.prompts = PromptPolicy::Ask);
        let outcome = run_with(&script, options, |world| {
            if let (1000, Some(yes)) = (world.ms(), answer) {
                world.runner.answer(yes);
            }
        });
        assert_eq!(outcome.finished().0, verdict);
        let asked = |e: &&RunEvent| matches!(e, RunEvent::Prompt { .. });
        assert_eq!(outcome.events.iter().filter(asked).count(), 1);
    }
}

#[test]
fn an_answer_is_for_one_question() {
    let script = format!(
        "{HEAD}step('a', do = [prompt('One?', within = s(5)), prompt('Two?', within = s(5))])\n\
         step('b', do = prompt('Three?', within = s(5)))"
    );
    let options = options(|it| it.prompts = PromptPolicy::Ask);
    let outcome = run_with(&script, options, |world| {
        if [1000, 2000].contains(&world.ms()) {
            world.runner.answer(true);
        }
    });
    let unanswered = "the operator did not answer: Three?";
    assert_eq!(
        outcome.summary(),
        [
            ("a", Verdict::Passed, ""),
            ("b", Verdict::Error, unanswered)
        ]
    );
}

#[test]
fn waits_are_reported_twice_a_second() {
    let script = format!("{HEAD}step('a', do = until(eb, 'applied', within = s(2)))");
    let outcome = run(&script, |_| {});
    let left: Vec<_> = outcome
        .events
        .iter()
        .filter_map(|event| match event {
            RunEvent::Waiting { action, left } => Some((action.to_string(), left.as_ms())),
            _ => None,
        })
        .collect();
    let what = "until eb = applied within 2.000 s".to_owned();
    assert_eq!(left, [1500, 1000, 500].map(|left| (what.clone(), left)));
    let message = "eb = applied did not come within 2.000 s";
    assert_eq!(outcome.summary(), [("a", Verdict::Failed, message)]);
}

#[test]
fn a_failed_check_outranks_one_that_could_not_be_made() {
    let two = format!(
        "{HEAD}step('a', expect = becomes(eb, 'applied', within = s(1)))\n\
         step('b', expect = becomes(alarm, True, within = s(1)))"
    );
    let outcome = run(&two, |_| {});
    assert_eq!(outcome.steps()[0].verdict, Verdict::Failed);
    assert_eq!(outcome.steps()[1].verdict, Verdict::Error);
    assert_eq!(outcome.finished().0, Verdict::Failed);
    let lost = run(&two, |world| {
        world.link_error = (world.ms() >= 1_500).then_some(LinkTrouble::MemoryExchanged);
    });
    assert_eq!(
        lost.finished().0,
        Verdict::Error,
        "then nothing is a verdict on the unit"
    );
}

#[test]
fn a_repeated_reason_is_reported_once_with_its_count() {
    let until = "until(eb, 'applied', within = s(1))";
    let script = format!("procedure(title = 'x', cleanup = [{until}, {until}])\nlook('a')");
    let message = "clean-up: eb = applied did not come within 1.000 s (2 times)";
    assert_eq!(run(&script, |_| {}).finished(), (Verdict::Error, message));
}
