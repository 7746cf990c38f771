//! Expectations of a step, and events and emergency brakes that no step expects.

use btu_rig::procedure::{EventSource, RunEvent, Verdict};
use protocol::event::{Event, LOG_ENTRIES};
use protocol::lru::shown;
use protocol::signal::Signal;

use super::stand_in::{HEAD, OFF, World, run};

#[test]
fn each_expectation_passes_fails_and_errs() {
    use Verdict::{Error, Failed, Passed};
    let comes = "becomes(eb, 'applied')";
    let late = "eb = applied did not come within 2.000 s";
    let stays = "holds(eb, 'released', for_ = s(1))";
    let short = "eb = released held only for 0.500 s";
    let never = "[never(eb, 'applied'), holds(speed, kmh(0), for_ = s(1))]";
    let (applied, released) = (Some(1.0), Some(0.0));
    let logs_mode = "logs('mode_changed', within = s(1))";
    let logs_inverter = "logs('inverter_failed', within = s(1))";
    let of_unit = "the unit did not log mode_changed within 1.000 s";
    let of_tcms = "TCMS did not log inverter_failed within 1.000 s";
    let untold = "no data for eb, so never eb = applied cannot be told";
    let [late_unknown, short_unknown] = [late, short].map(|what| format!("{what}: no data for eb"));
    for (expect, eb, verdict, message) in [
        (comes, applied, Passed, ""),
        (comes, released, Failed, late),
        (comes, None, Error, &late_unknown[..]),
        (stays, released, Passed, ""),
        (stays, applied, Failed, short),
        (stays, None, Error, &short_unknown),
        (never, released, Passed, ""),
        (never, applied, Failed, "eb = applied came true"),
        (never, None, Error, untold),
        (logs_mode, released, Failed, of_unit),
        (logs_inverter, released, Failed, of_tcms),
        ("never_logs('mode_changed')", released, Passed, ""),
    ] {
        let outcome = run(&format!("{HEAD}step('a', expect = {expect})"), |world| {
            if world.ms() == 500 {
                world.sample.set(Signal::Eb, eb.unwrap_or(f64::NAN));
            }
        });
        assert_eq!(outcome.summary(), [("a", verdict, message)], "{expect}");
        assert_eq!(outcome.fake.applied.last(), Some(&OFF));
    }
}

#[test]
fn bits_that_do_not_match_are_named() {
    let script = format!(
        "{HEAD}step('a', do = until(lamps, lacks = lamp.failure + lamp.not_released, within = s(1)))"
    );
    let outcome = run(&script, |world| world.sample.set(Signal::Lamps, 64.0));
    let message =
        "lamps without not_released + failure did not come within 1.000 s (lamps = failure)";
    assert_eq!(outcome.summary(), [("a", Verdict::Failed, message)]);
}

#[test]
fn an_effect_is_looked_for_in_a_sample_newer_than_its_stimulus() {
    let script = format!(
        "{HEAD}step('a', do = door.open(), expect = becomes(eb, 'released', within = ms(0)))"
    );
    // The brake comes with the stimulus: the sample of that scan still shows it released.
    let outcome = run(&script, |world| {
        world.sample.set_bit(Signal::Eb, world.scan >= 1)
    });
    assert_eq!(outcome.steps()[0].verdict, Verdict::Failed);
}

/// The stand-in logs a parameter of 0.
#[test]
fn an_entry_counts_whose_parameter_is_within_its_limits() {
    let none =
        |what| format!("the unit did not log rollback (distance, cm: {what}) within 1.000 s");
    for (limits, missed) in [
        ("low = 0, high = 0", None),
        ("low = -1", None),
        ("low = 1", Some(none("at least 1"))),
        ("high = -1", Some(none("at most -1"))),
        ("low = 50, high = 60", Some(none("50 to 60"))),
    ] {
        let script = format!("{HEAD}step('a', expect = logs('rollback', within = s(1), {limits}))");
        let outcome = run(&script, |world| {
            if world.ms() == 500 {
                world.log(Event::Rollback);
            }
        });
        let verdict = match missed {
            None => Verdict::Passed,
            Some(_) => Verdict::Failed,
        };
        let message = missed.unwrap_or_default();
        assert_eq!(outcome.summary(), [("a", verdict, &*message)], "{limits}");
    }
}

#[test]
fn an_event_nobody_asked_for_fails_the_step() {
    let script = |more: &str| format!("{HEAD}look('a', do = wait(s(1)){more})");
    let log = |world: &mut World| {
        if world.ms() == 500 {
            world.log(Event::TwcLost);
            world.log(Event::ModeChanged);
        }
    };
    let outcome = run(&script(""), log);
    let message = "the unit logged twc_lost (400), which no step provoked";
    assert_eq!(outcome.summary(), [("a", Verdict::Failed, message)]);
    let reported = outcome
        .events
        .iter()
        .filter(|e| matches!(e, RunEvent::UnsolicitedEvent(e) if e.code == 400));
    assert_eq!(reported.count(), 1);
    let of_the_train = run(&script(""), |world| {
        if world.ms() == 500 {
            world.log_by(EventSource::Tcms, Event::RegenerationCutOut);
        }
    });
    let message = "TCMS logged regeneration_cut_out (803, all cars), which no step provoked";
    assert_eq!(of_the_train.summary(), [("a", Verdict::Failed, message)]);

    for asked in [", provokes = 'twc_lost'", ", expect = logs('twc_lost')"] {
        assert_eq!(
            run(&script(asked), log).finished().0,
            Verdict::Passed,
            "{asked}"
        );
    }
    // Provoked by an earlier step, it may still arrive in a later one.
    let two = format!("{HEAD}look('z', provokes = ['twc_lost'])\nlook('a', do = wait(s(1)))");
    assert_eq!(run(&two, log).finished().0, Verdict::Passed);
}

/// Whoever logs an event names its part for the step it comes in, and a part of the train for all that
/// follow, since an inverter does not repair itself. What a step provokes names nothing.
#[test]
fn an_event_nobody_asked_for_names_the_part() {
    use Event::{AtcSilent, AtoOrderContradicts, InverterFailed, OverspeedEb, TwcLost};
    let suspects = |source, event, provokes: &str| {
        let step = "do = wait(s(1)), expect = becomes(alarm, True, within = ms(10))";
        let script = format!(
            "procedure(title = 'x', suspect = 'ato_cpu')\n\
             step('a', {step})\nstep('b', {step}{provokes})\nstep('c', {step}, suspect = 'tra')"
        );
        let outcome = run(&script, |world| {
            world.sample.set_bit(Signal::Alarm, false);
            if world.ms() == 1500 {
                world.log_by(source, event);
            }
        });
        let suspects = outcome
            .steps()
            .into_iter()
            .map(|step| shown(step.suspect.as_ref()).to_owned());
        suspects.collect::<Vec<_>>()
    };
    let (unit, tcms) = (EventSource::Unit, EventSource::Tcms);
    let (ato, provoked) = ("ato_cpu", ", provokes = ['inverter_failed']");
    for (source, event, provokes, expected) in [
        (unit, TwcLost, "", [ato, "twc_cpu", "tra"]),
        (unit, OverspeedEb, "", [ato, ato, "tra"]),
        (tcms, InverterFailed, "", [ato, "inverter", "inverter"]),
        // The link and the unit are none of the train's parts.
        (tcms, AtcSilent, "", [ato, "rs485_link", "tra"]),
        (tcms, AtoOrderContradicts, "", [ato, ato, "tra"]),
        (tcms, InverterFailed, provoked, [ato, ato, "tra"]),
    ] {
        assert_eq!(
            suspects(source, event, provokes),
            expected,
            "{event:?}{provokes}"
        );
    }
}

#[test]
fn an_emergency_brake_nobody_asked_for_fails_the_step() {
    let brake = |world: &mut World| world.sample.set_bit(Signal::Eb, world.ms() >= 500);
    let outcome = run(
        &format!("{HEAD}look('a', do = wait(s(1)))\nlook('b')"),
        brake,
    );
    let message = "the emergency brake was applied, which this step does not ask for";
    let expected = [("a", Verdict::Failed, message), ("b", Verdict::Passed, "")];
    assert_eq!(outcome.summary(), expected);
    let reported = |e: &&RunEvent| matches!(e, RunEvent::UnsolicitedBrake { .. });
    assert_eq!(outcome.events.iter().filter(reported).count(), 1);

    for asked in ["expect = becomes(eb, 'applied')", "provokes = 'rollback'"] {
        let outcome = run(&format!("{HEAD}look('a', do = wait(s(1)), {asked})"), brake);
        assert_eq!(outcome.finished().0, Verdict::Passed, "{asked}");
    }
    let in_setup = "procedure(title = 'x', setup = wait(s(1)))\nlook('a', do = wait(s(1)))";
    assert_eq!(run(in_setup, brake).finished().0, Verdict::Passed);
}

#[test]
fn events_without_end_are_reported_up_to_what_a_log_holds_and_counted_beyond() {
    let outcome = run(&format!("{HEAD}look('a', do = wait(s(10)))"), |world| {
        world.log(Event::TwcLost);
        world.fake.evidence.not_kept = 1_000 + u64::from(world.scan);
    });
    let reported = outcome
        .events
        .iter()
        .filter(|e| matches!(e, RunEvent::UnsolicitedEvent(_)));
    assert_eq!(reported.count(), LOG_ENTRIES);
    let step = outcome.steps()[0];
    let told = step.findings.to_string();
    let said = told.strip_prefix("the unit logged twc_lost (400), which no step provoked (");
    assert!(
        said.is_some_and(|times| times.ends_with(" times)")),
        "{}",
        told
    );
    let (verdict, message) = outcome.finished();
    assert_eq!(verdict, Verdict::Failed);
    assert!(message.ends_with(" more entries, not stored"), "{message}");
}
