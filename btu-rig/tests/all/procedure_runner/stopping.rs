//! Stop, pause, time limits and problems: clean-up always runs and outputs always end safe.

use btu_rig::procedure::link_trouble::LinkTrouble;
use btu_rig::procedure::{RunEvent, Verdict};

use super::stand_in::{HEAD, OFF, ON, options, run, run_with};

#[test]
fn a_step_that_runs_too_long_ends_as_an_error_before_clean_up() {
    let script = format!(
        "{HEAD}step('a', do = until(eb, 'applied', within = s(60)), limit = s(1))\nlook('b')"
    );
    let outcome = run(&script, |world| {
        if world.ms() <= 1000 {
            assert_eq!(world.fake.applied.len(), usize::from(world.scan > 0));
        }
    });
    let message = "took longer than its time limit of 1.000 s in its actions";
    let expected = [("a", Verdict::Error, message), ("b", Verdict::Passed, "")];
    assert_eq!(outcome.summary(), expected);
    assert_eq!(outcome.finished().0, Verdict::Error);
    assert_eq!(outcome.fake.applied, [ON, OFF]);
}

#[test]
fn stop_in_each_phase_still_cleans_up_and_makes_safe() {
    let script = "procedure(title = 'x', setup = [wait(s(1)), cab.key(True)],
        cleanup = [wait(s(1)), cab.key(False)])\nlook('a', do = wait(s(1)))\nlook('b')";
    let aborted = (Verdict::Aborted, "stopped by the operator");
    let skipped = ("b", Verdict::Skipped, "not run, stopped by the operator");
    for at_ms in [0, 500, 1500, 2500] {
        let outcome = run(script, |world| {
            if world.ms() == at_ms {
                world.runner.stop();
            }
        });
        assert_eq!(outcome.fake.applied.last(), Some(&OFF), "{at_ms}");
        assert_eq!(outcome.fake.made_safe, 1);
        match at_ms {
            0 | 500 => {
                let a = ("a", Verdict::Skipped, "not run, stopped by the operator");
                assert_eq!(outcome.summary(), [a, skipped]);
                assert_eq!(outcome.finished(), aborted);
            }
            1500 => {
                let a = ("a", Verdict::Aborted, "stopped by the operator");
                assert_eq!(outcome.summary(), [a, skipped]);
                assert_eq!(outcome.finished(), aborted);
            }
            // During clean-up the first stop changes nothing: it is what a stop would start.
            _ => assert_eq!(outcome.finished(), (Verdict::Passed, "")),
        }
    }
}

#[test]
fn a_second_stop_shortens_clean_up_but_not_making_safe() {
    let script = "procedure(title = 'x', cleanup = [wait(s(50)), cab.key(False)])\nlook('a', do = wait(s(9)))";
    let outcome = run(script, |world| {
        if [100, 300].contains(&world.ms()) {
            world.runner.stop();
        }
    });
    assert_eq!(outcome.scans, 30);
    assert!(outcome.fake.applied.is_empty());
    assert_eq!(outcome.fake.made_safe, 1);
    let message = "stopped by the operator; clean-up cut short by the operator";
    assert_eq!(outcome.finished(), (Verdict::Aborted, message));
}

#[test]
fn outputs_that_do_not_become_safe_are_an_error() {
    let outcome = run(&format!("{HEAD}look('a')"), |world| {
        world.fake.never_safe = true
    });
    assert!(outcome.fake.made_safe > 100);
    let message = "outputs are not confirmed safe after 25.000 s";
    assert_eq!(outcome.finished(), (Verdict::Error, message));
}

#[test]
fn a_refused_setup_skips_the_steps_and_still_cleans_up() {
    let outcome = run(&format!("{HEAD}look('a')"), |world| {
        world.fake.refuse = world.scan == 0;
    });
    let reason = "not run, setup: unit refused arming: key_off";
    assert_eq!(outcome.summary(), [("a", Verdict::Skipped, reason)]);
    let message = "setup: unit refused arming: key_off";
    assert_eq!(outcome.finished().0, Verdict::Error);
    assert!(outcome.finished().1.starts_with(message));
    assert_eq!(outcome.fake.applied, [ON, OFF]);
}

#[test]
fn a_problem_in_clean_up_does_not_keep_the_rest_from_running() {
    let script = "procedure(title = 'x', cleanup = [until(eb, 'applied', within = s(1)), cab.key(False)])\nlook('a')";
    let outcome = run(script, |_| {});
    assert_eq!(outcome.fake.applied, [OFF]);
    let message = "clean-up: eb = applied did not come within 1.000 s";
    assert_eq!(outcome.finished(), (Verdict::Error, message));
}

#[test]
fn motion_that_does_not_end_is_an_error() {
    let script = format!("{HEAD}look('a', do = tacho.speed(kmh(10), accel = mps2(30)))");
    let outcome = run(&script, |world| world.fake.unsettled = true);
    let step = outcome.steps()[0];
    assert_eq!(step.verdict, Verdict::Error);
    assert_eq!(
        step.findings.to_string(),
        "motion or tester request not finished within 3.111 s"
    );
}

/// The rest is neither run nor reported; clean-up is run, and the verdict covers the steps that
/// were run.
#[test]
fn a_procedure_can_be_left_between_two_steps() {
    let script = format!(
        "{HEAD}step('a', expect = holds(eb, 'released', for_ = ms(50)))\nlook('b')\nlook('c')"
    );
    let options = options(|it| it.one_by_one = true);
    let outcome = run_with(&script, options.clone(), |world| {
        if world.ms() == 20 {
            world.runner.leave();
        }
    });
    let names: Vec<_> = outcome.steps().iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["a"], "the step under way is finished");
    assert_eq!(outcome.finished().0, Verdict::Passed);
    assert_eq!(outcome.fake.applied, [ON, OFF]);
    assert_eq!(outcome.fake.made_safe, 1);
    let whole = run_with(&script, options, |_| {});
    assert_eq!(whole.steps().len(), 3);
}

/// The step under way is finished, the next waits, one at a time may go, and going on needs no more.
#[test]
fn a_paused_procedure_goes_step_by_step_and_on() {
    let script = format!("{HEAD}look('a')\nlook('b')\nlook('c')\nlook('d')");
    let mut waits = Vec::new();
    let outcome = run(&script, |world| {
        match world.ms() {
            0 => world.runner.pause(),
            1_000 | 2_000 => world.runner.single_step(),
            3_000 => world.runner.resume(),
            _ => {}
        }
        if world.ms().is_multiple_of(500) {
            waits.push(world.runner.awaits_operator());
        }
    });
    assert_eq!(waits, [false, true, true, true, true, true, false]);
    let began = outcome.events.iter().filter_map(|event| match event {
        RunEvent::StepStarted { name, at, .. } => Some((name.as_str(), at.as_us() / 1000)),
        _ => None,
    });
    let began: Vec<_> = began.collect();
    assert_eq!(
        began,
        [("a", 1_000), ("b", 2_000), ("c", 3_000), ("d", 3_000)]
    );
    let said = outcome.events.iter().filter_map(|event| match event {
        RunEvent::Paused { next, .. } => Some(next.as_str()),
        _ => None,
    });
    assert_eq!(
        said.collect::<Vec<_>>(),
        ["a", "b", "c"],
        "each wait is said once"
    );
    assert_eq!(outcome.finished().0, Verdict::Passed);
}

/// A pause keeps neither stop nor a lost link from clean-up and safe outputs.
#[test]
fn a_pause_does_not_delay_a_stop() {
    let script = format!("{HEAD}look('a')\nlook('b')");
    let outcome = run(&script, |world| match world.ms() {
        0 => world.runner.pause(),
        1_000 => world.runner.stop(),
        _ => {}
    });
    assert_eq!(outcome.finished().0, Verdict::Aborted);
    assert_eq!(outcome.fake.applied, [ON, OFF]);
    assert_eq!(outcome.fake.made_safe, 1);
    let lost = run(&script, |world| {
        if world.ms() == 0 {
            world.runner.pause();
        }
        world.link_error = (world.ms() >= 1_000).then_some(LinkTrouble::MemoryExchanged);
    });
    assert_eq!(lost.finished().0, Verdict::Error);
    assert!(lost.fake.made_safe > 0);
}
