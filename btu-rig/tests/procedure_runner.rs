//! Running procedures against a stand-in for bench and unit whose signals the test sets by hand.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use btu_rig::procedure::loader::load;
use btu_rig::procedure::{
    Driver, EventSource, Evidence, LogState, Poll, Procedure, PromptPolicy, Refusal, RunEvent,
    RunOptions, Runner, StepResult, UnitEvent, Verdict,
};
use btu_rig::stimulus::Stimulus;
use btu_rig::train::TrainData;
use protocol::config::UnitConfig;
use protocol::event::{Event, LOG_ENTRIES};
use protocol::line::Line;
use protocol::message::{EbCause, Mode, SelfTest};
use protocol::signal::{Sample, Signal};
use protocol::{Duration, Instant, SCAN, Speed};

/// Scans after which a run that does not end is a bug.
const MOST_SCANS: u32 = 60_000;

fn procedure(script: &str) -> Arc<Procedure> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scripts");
    let read = |path: &str| std::fs::read_to_string(root.join(path)).unwrap();
    let unit = UnitConfig::from_toml(&read("units/sg100.toml")).unwrap();
    let line = Line::from_toml(&read("lines/line8.toml")).unwrap();
    let scripts = BTreeMap::from([("test.star".to_owned(), script.to_owned())]);
    let loaded = load(&scripts, &unit, &line, &TrainData::line6());
    assert!(loaded.errors.is_empty(), "{:?}", loaded.errors);
    Arc::clone(&loaded.procedures[0])
}

/// Records what is applied; says what it is told to.
#[derive(Debug, Default)]
struct Fake {
    applied: Vec<Stimulus>,
    refuse: bool,
    unsettled: bool,
    made_safe: u32,
    never_safe: bool,
    evidence: Evidence,
}

impl Driver for Fake {
    fn apply(&mut self, _: Instant, stimulus: &Stimulus) -> Result<(), Refusal> {
        self.applied.push(*stimulus);
        if self.refuse {
            return Err(Refusal("unit refused arming: key_off".into()));
        }
        Ok(())
    }

    fn settled(&mut self) -> Result<bool, Refusal> {
        Ok(!self.unsettled)
    }

    fn make_safe(&mut self, _: Instant) {
        self.made_safe += 1;
    }

    fn safe(&self) -> bool {
        !self.never_safe
    }

    fn evidence(&self) -> Evidence {
        self.evidence
    }
}

/// What a test may change before each scan.
struct World<'a> {
    scan: u32,
    sample: Sample,
    events: Vec<UnitEvent>,
    link_error: Option<&'static str>,
    fake: Fake,
    runner: &'a mut Runner,
}

impl World<'_> {
    fn ms(&self) -> u32 {
        self.scan * 10
    }

    fn log(&mut self, event: Event) {
        self.log_by(EventSource::Unit, event);
    }

    fn log_by(&mut self, source: EventSource, event: Event) {
        self.events.push(UnitEvent {
            source,
            index: 0,
            code: event.definition().code,
            at_ms: 0,
            parameter: 0,
            speed: Speed::ZERO,
            limit: Speed::ZERO,
            position_m: 0.0,
            mode: Mode::Manual,
            eb_cause: EbCause::None,
        });
    }
}

struct Outcome {
    events: Vec<RunEvent>,
    fake: Fake,
    scans: u32,
}

impl Outcome {
    fn steps(&self) -> Vec<&StepResult> {
        let steps = self.events.iter().filter_map(|event| match event {
            RunEvent::StepFinished(result) => Some(result),
            _ => None,
        });
        steps.collect()
    }

    /// Name, verdict and message of each step.
    fn summary(&self) -> Vec<(&str, Verdict, &str)> {
        self.steps()
            .into_iter()
            .map(|r| (r.name.as_str(), r.verdict, r.message.as_str()))
            .collect()
    }

    fn finished(&self) -> (Verdict, &str) {
        match self.events.last() {
            Some(RunEvent::ProcedureFinished {
                verdict, message, ..
            }) => (*verdict, message),
            other => panic!("{other:?}"),
        }
    }
}

fn run_with(script: &str, options: RunOptions, each_scan: impl FnMut(&mut World<'_>)) -> Outcome {
    run_round(script, options, 0, each_scan)
}

fn run_round(
    script: &str,
    options: RunOptions,
    round: u32,
    mut each_scan: impl FnMut(&mut World<'_>),
) -> Outcome {
    let mut runner = Runner::new(procedure(script), options, round);
    let mut sample = Sample::default();
    sample.set(Signal::Eb, 0.0);
    sample.set(Signal::Speed, 0.0);
    let (mut fake, mut events) = (Fake::default(), Vec::new());
    for scan in 0..MOST_SCANS {
        let mut world = World {
            scan,
            sample: std::mem::take(&mut sample),
            events: Vec::new(),
            link_error: None,
            fake: std::mem::take(&mut fake),
            runner: &mut runner,
        };
        each_scan(&mut world);
        let (logged, link_error) = (world.events, world.link_error);
        (sample, fake) = (world.sample, world.fake);
        let now = Instant::from_us(u64::from(scan) * SCAN.as_us());
        let poll = runner.advance(now, &sample, &logged, link_error, &mut fake);
        events.extend(runner.take_events());
        if poll == Poll::Done {
            return Outcome {
                events,
                fake,
                scans: scan,
            };
        }
    }
    panic!("the run does not end: {:?}", events.last());
}

fn run(script: &str, each_scan: impl FnMut(&mut World<'_>)) -> Outcome {
    run_with(script, RunOptions::default(), each_scan)
}

const HEAD: &str = "procedure(title = 'x', setup = [cab.key(True)], cleanup = [cab.key(False)])\n";
const ON: Stimulus = Stimulus::MaintenanceKey { on: true };
const OFF: Stimulus = Stimulus::MaintenanceKey { on: false };

#[test]
fn setup_steps_and_clean_up_run_in_order_and_outputs_end_safe() {
    let outcome = run(
        &format!("{HEAD}step('a', do = door.open())\nstep('b')"),
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
fn each_expectation_passes_fails_and_errs() {
    let cases: [(&str, Option<f64>, Verdict, &str); 12] = [
        ("becomes(eb, 'applied')", Some(1.0), Verdict::Passed, ""),
        (
            "becomes(eb, 'applied')",
            Some(0.0),
            Verdict::Failed,
            "eb = applied did not come within 2.000 s",
        ),
        (
            "becomes(eb, 'applied')",
            None,
            Verdict::Error,
            "eb = applied did not come within 2.000 s: no data for eb",
        ),
        (
            "holds(eb, 'released', for_ = s(1))",
            Some(0.0),
            Verdict::Passed,
            "",
        ),
        (
            "holds(eb, 'released', for_ = s(1))",
            Some(1.0),
            Verdict::Failed,
            "eb = released held only for 0.500 s",
        ),
        (
            "holds(eb, 'released', for_ = s(1))",
            None,
            Verdict::Error,
            "eb = released held only for 0.500 s: no data for eb",
        ),
        (
            "[never(eb, 'applied'), holds(speed, kmh(0), for_ = s(1))]",
            Some(0.0),
            Verdict::Passed,
            "",
        ),
        (
            "[never(eb, 'applied'), holds(speed, kmh(0), for_ = s(1))]",
            Some(1.0),
            Verdict::Failed,
            "eb = applied came true",
        ),
        (
            "[never(eb, 'applied'), holds(speed, kmh(0), for_ = s(1))]",
            None,
            Verdict::Error,
            "no data for eb, so never eb = applied cannot be told",
        ),
        (
            "logs('mode_changed', within = s(1))",
            Some(0.0),
            Verdict::Failed,
            "the unit did not log mode_changed within 1.000 s",
        ),
        (
            "logs('inverter_failed', within = s(1))",
            Some(0.0),
            Verdict::Failed,
            "TCMS did not log inverter_failed within 1.000 s",
        ),
        ("never_logs('mode_changed')", Some(0.0), Verdict::Passed, ""),
    ];
    for (expect, eb, verdict, message) in cases {
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
fn a_time_is_measured_from_change_to_change() {
    let script = format!(
        "{HEAD}step('a', expect = becomes(eb, 'applied', within = s(9)), measure = [
            time('reaction', from_ = is_(speed, above = kmh(30)), to = is_(eb, 'applied'), high = ms(300)),
            at('speed at EB', speed, when = is_(eb, 'applied'), low = kmh(30), high = kmh(36)),
            maximum('top', speed), minimum('least', speed), change('gain', speed), value('end', speed)])"
    );
    let outcome = run(&script, |world| {
        let speed = f64::from(world.scan) * 0.36;
        world.sample.set(Signal::Speed, speed);
        world.sample.set_bit(Signal::Eb, world.ms() >= 1000);
    });
    let step = outcome.steps()[0];
    assert_eq!(step.verdict, Verdict::Passed, "{}", step.message);
    let values: Vec<_> = (step.measurements.iter())
        .map(|m| format!("{} {:.2} {}", m.name, m.value.unwrap_or(f64::NAN), m.unit))
        .collect();
    let expected = [
        "reaction 160.00 ms",
        "speed at EB 36.00 km/h",
        "top 36.00 km/h",
        "least 0.00 km/h",
        "gain 36.00 km/h",
        "end 36.00 km/h",
    ];
    assert_eq!(values, expected);
}

#[test]
fn a_brake_that_is_already_applied_has_no_reaction_time() {
    let script = format!(
        "{HEAD}step('a', do = door.open(), measure = time('t', to = is_(eb, 'applied'), high = ms(300)))"
    );
    let outcome = run(&script, |world| world.sample.set(Signal::Eb, 1.0));
    let message = "t: no value, eb = applied did not come about in time";
    assert_eq!(outcome.summary(), [("a", Verdict::Error, message)]);
}

#[test]
fn what_many_measurements_waited_for_is_said_once() {
    let script = format!(
        "{HEAD}step('a', measure = [at('v%d' % n, speed, when = is_(eb, 'applied')) for n in range(17)])"
    );
    let outcome = run(&script, |world| world.sample.set(Signal::Eb, 0.0));
    let message = "v0 and 16 more: no value, eb = applied did not come about in time";
    assert_eq!(outcome.summary(), [("a", Verdict::Error, message)]);
}

#[test]
fn bits_that_are_not_as_wanted_are_named() {
    let script = format!(
        "{HEAD}step('a', do = until(lamps, lacks = lamp.failure + lamp.not_released, within = s(1)))"
    );
    let outcome = run(&script, |world| world.sample.set(Signal::Lamps, 64.0));
    let message =
        "lamps without not_released + failure did not come within 1.000 s (lamps = failure)";
    assert_eq!(outcome.summary(), [("a", Verdict::Failed, message)]);
}

#[test]
fn limits_missing_data_and_nan_never_pass() {
    let cases = [
        (
            "value('v', speed, high = kmh(20))",
            20.0,
            Verdict::Passed,
            "",
        ),
        (
            "value('v', speed, high = kmh(20))",
            21.0,
            Verdict::Failed,
            "v = 21, allowed at most 20 km/h",
        ),
        (
            "value('v', speed, low = kmh(5), high = kmh(20))",
            4.0,
            Verdict::Failed,
            "v = 4, allowed 5 to 20 km/h",
        ),
        (
            "value('v', speed, high = kmh(20))",
            f64::NAN,
            Verdict::Error,
            "v: no data for speed",
        ),
        (
            "value('v', speed)",
            f64::NAN,
            Verdict::Error,
            "v: no data for speed",
        ),
        (
            "maximum('v', speed, high = kmh(20))",
            f64::NAN,
            Verdict::Error,
            "v: no data for speed",
        ),
        (
            "change('v', speed)",
            f64::NAN,
            Verdict::Error,
            "v: no data for speed",
        ),
        (
            "value('v', speed, high = kmh(20))",
            f64::INFINITY,
            Verdict::Error,
            "v: no data for speed",
        ),
    ];
    for (measure, speed, verdict, message) in cases {
        let outcome = run(&format!("{HEAD}step('a', measure = {measure})"), |world| {
            world.sample.set(Signal::Speed, speed);
        });
        assert_eq!(outcome.summary(), [("a", verdict, message)], "{measure}");
    }
}

#[test]
fn a_measured_value_serves_as_a_later_limit() {
    let script = format!(
        "{HEAD}step('a', measure = value('v', speed))
step('b', measure = value('w', speed, low = measured('v') + kmh(1)))
step('c', expect = becomes(speed, above = measured('a/v')))"
    );
    let outcome = run(&script, |world| {
        world
            .sample
            .set(Signal::Speed, if world.scan < 50 { 10.0 } else { 12.0 });
    });
    let verdicts: Vec<_> = outcome.steps().iter().map(|s| s.verdict).collect();
    assert_eq!(
        verdicts,
        [Verdict::Passed, Verdict::Failed, Verdict::Passed]
    );
    assert_eq!(outcome.steps()[1].measurements[0].low, Some(11.0));

    // Without the step that measures it, the limit is missing: an error, not a pass.
    let options = RunOptions {
        chosen: Some(vec![1]),
        ..RunOptions::default()
    };
    let outcome = run_with(&script, options, |_| {});
    let message = "w: a limit refers to a measurement without a value";
    assert_eq!(outcome.summary(), [("b", Verdict::Error, message)]);
}

#[test]
fn a_step_that_runs_too_long_ends_as_an_error_before_clean_up() {
    let script = format!(
        "{HEAD}step('a', do = until(eb, 'applied', within = s(60)), limit = s(1))\nstep('b')"
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
        cleanup = [wait(s(1)), cab.key(False)])\nstep('a', do = wait(s(1)))\nstep('b')";
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
    let script = "procedure(title = 'x', cleanup = [wait(s(50)), cab.key(False)])\nstep('a', do = wait(s(9)))";
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
    let outcome = run(&format!("{HEAD}step('a')"), |world| {
        world.fake.never_safe = true
    });
    assert!(outcome.fake.made_safe > 100);
    let message = "outputs are not confirmed safe after 25.000 s";
    assert_eq!(outcome.finished(), (Verdict::Error, message));
}

#[test]
fn a_refused_setup_skips_the_steps_and_still_cleans_up() {
    let outcome = run(&format!("{HEAD}step('a')"), |world| {
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
    let script = "procedure(title = 'x', cleanup = [until(eb, 'applied', within = s(1)), cab.key(False)])\nstep('a')";
    let outcome = run(script, |_| {});
    assert_eq!(outcome.fake.applied, [OFF]);
    let message = "clean-up: eb = applied did not come within 1.000 s";
    assert_eq!(outcome.finished(), (Verdict::Error, message));
}

#[test]
fn a_lost_link_ends_the_step_as_an_error_and_skips_the_rest() {
    let script = format!("{HEAD}step('a', do = wait(s(5)))\nstep('b')");
    let outcome = run(&script, |world| {
        if world.ms() >= 1000 {
            world.link_error = Some("unit silent for 1.0 s");
        }
    });
    let text = "link to the unit: unit silent for 1.0 s";
    let reason = format!("not run, {text}");
    let expected = [
        ("a", Verdict::Error, text),
        ("b", Verdict::Skipped, &reason),
    ];
    assert_eq!(outcome.summary(), expected);
    assert_eq!(outcome.finished(), (Verdict::Error, text));
    assert_eq!(outcome.fake.applied, [ON, OFF]);
    assert!(outcome.scans < 110);
}

/// Goal: a computer that stands still for a moment is no fault of the unit. Method: brake and event that
/// come in with the scan after it, as the unit's inputs were gone meanwhile.
#[test]
fn what_a_held_up_tester_sees_is_an_error_and_no_fault() {
    let script = format!(
        "{HEAD}step('a')\nstep('b', do = wait(s(5)), measure = value('v', speed, low = kmh(5)))\nstep('c')"
    );
    let outcome = run(&script, |world| {
        if world.ms() == 1000 {
            world.runner.held_up("held up for 0.50 s".into());
            world.sample.set(Signal::Eb, 1.0);
            world.log(Event::InputsLost);
        }
    });
    let text = "held up for 0.50 s";
    let expected = [
        ("a", Verdict::Passed, ""),
        ("b", Verdict::Error, text),
        ("c", Verdict::Skipped, "not run, held up for 0.50 s"),
    ];
    assert_eq!(outcome.summary(), expected);
    assert_eq!(outcome.finished(), (Verdict::Error, text));
    assert_eq!(outcome.steps()[1].measurements[0].value, None);
    let blamed = |event: &RunEvent| {
        matches!(
            event,
            RunEvent::UnsolicitedBrake { .. } | RunEvent::UnsolicitedEvent(_)
        )
    };
    assert!(!outcome.events.iter().any(blamed));
    assert_eq!(outcome.fake.applied, [ON, OFF], "clean-up is run");
}

/// Goal: no verdict on time from a bench that was late. Method: the same failures, in time and behind.
#[test]
fn what_fails_while_the_bench_is_behind_is_an_error_unless_the_unit_said_so() {
    let script =
        format!("{HEAD}step('a', do = wait(s(1)), expect = becomes(eb, 'applied', within = s(1)))");
    let verdict_of = |behind_ms: u64, says: bool| {
        let outcome = run(&script, |world| {
            if world.ms() == 500 {
                world.runner.behind(Duration::from_ms(behind_ms));
                if says {
                    world.log(Event::TwcLost);
                }
            }
        });
        outcome.steps()[0].verdict
    };
    assert_eq!(verdict_of(40, false), Verdict::Failed);
    assert_eq!(verdict_of(60, false), Verdict::Error);
    assert_eq!(
        verdict_of(60, true),
        Verdict::Failed,
        "an event is an event"
    );
}

#[test]
fn held_up_in_its_setup_a_procedure_runs_no_step_and_cleans_up() {
    let script =
        "procedure(title = 'x', setup = [wait(s(5))], cleanup = [cab.key(False)])\nstep('a')";
    let outcome = run(script, |world| {
        if world.ms() == 1000 {
            world.runner.held_up("held up".into());
        }
    });
    assert_eq!(
        outcome.summary(),
        [("a", Verdict::Skipped, "not run, held up")]
    );
    assert_eq!(outcome.finished(), (Verdict::Error, "held up"));
    assert_eq!(outcome.fake.applied, [OFF]);
}

#[test]
fn motion_that_does_not_end_is_an_error() {
    let script = format!("{HEAD}step('a', do = tacho.speed(kmh(10), accel = mps2(30)))");
    let outcome = run(&script, |world| world.fake.unsettled = true);
    let step = outcome.steps()[0];
    assert_eq!(step.verdict, Verdict::Error);
    assert_eq!(
        step.message,
        "motion or tester request not finished within 3.111 s"
    );
}

#[test]
fn an_event_nobody_asked_for_fails_the_step() {
    let script = |more: &str| format!("{HEAD}step('a', do = wait(s(1)){more})");
    let log = |world: &mut World<'_>| {
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
    let two = format!("{HEAD}step('z', provokes = ['twc_lost'])\nstep('a', do = wait(s(1)))");
    assert_eq!(run(&two, log).finished().0, Verdict::Passed);
}

/// Whoever logs an event names its part for the step it comes in, and a part of the train for all that
/// follow, since an inverter does not mend itself. What a step provokes names nothing.
#[test]
fn an_event_nobody_asked_for_names_the_part() {
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
        let suspects = outcome.steps().into_iter().map(|step| step.suspect.clone());
        suspects.collect::<Vec<_>>()
    };
    let (unit, tcms) = (EventSource::Unit, EventSource::Tcms);
    for (source, event, provokes, expected) in [
        (unit, Event::TwcLost, "", ["ato_cpu", "twc_cpu", "tra"]),
        (unit, Event::OverspeedEb, "", ["ato_cpu", "ato_cpu", "tra"]),
        (
            tcms,
            Event::InverterFailed,
            "",
            ["ato_cpu", "inverter", "inverter"],
        ),
        // The link and the unit are none of the train's parts.
        (tcms, Event::AtcSilent, "", ["ato_cpu", "rs485_link", "tra"]),
        (
            tcms,
            Event::AtoOrderContradicts,
            "",
            ["ato_cpu", "ato_cpu", "tra"],
        ),
        (
            tcms,
            Event::InverterFailed,
            ", provokes = ['inverter_failed']",
            ["ato_cpu", "ato_cpu", "tra"],
        ),
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
    let brake = |world: &mut World<'_>| world.sample.set_bit(Signal::Eb, world.ms() >= 500);
    let outcome = run(
        &format!("{HEAD}step('a', do = wait(s(1)))\nstep('b')"),
        brake,
    );
    let message = "the emergency brake was applied, which this step does not ask for";
    let expected = [("a", Verdict::Failed, message), ("b", Verdict::Passed, "")];
    assert_eq!(outcome.summary(), expected);
    let reported = |e: &&RunEvent| matches!(e, RunEvent::UnsolicitedBrake { .. });
    assert_eq!(outcome.events.iter().filter(reported).count(), 1);

    for asked in ["expect = becomes(eb, 'applied')", "provokes = 'rollback'"] {
        let outcome = run(&format!("{HEAD}step('a', do = wait(s(1)), {asked})"), brake);
        assert_eq!(outcome.finished().0, Verdict::Passed, "{asked}");
    }
    let in_setup = "procedure(title = 'x', setup = wait(s(1)))\nstep('a', do = wait(s(1)))";
    assert_eq!(run(in_setup, brake).finished().0, Verdict::Passed);
}

#[test]
fn when_skips_a_step_and_missing_data_do_not() {
    let script =
        format!("{HEAD}step('a', when = is_(eb, 'applied'))\nstep('b', when = is_(alarm, True))");
    let outcome = run(&script, |_| {});
    let expected = [
        ("a", Verdict::Skipped, "its condition does not hold"),
        ("b", Verdict::Error, "its condition: no data for alarm"),
    ];
    assert_eq!(outcome.summary(), expected);
    let only_skipped = run(
        &format!("{HEAD}step('a', when = is_(eb, 'applied'))"),
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
    let verdicts: Vec<_> = outcome
        .summary()
        .iter()
        .map(|s| (s.0.to_owned(), s.1))
        .collect();
    let expected = [
        ("a (1/3)".to_owned(), Verdict::Passed),
        ("a (2/3)".to_owned(), Verdict::Failed),
        ("a (3/3)".to_owned(), Verdict::Passed),
    ];
    assert_eq!(verdicts, expected);
    assert_eq!(outcome.finished().0, Verdict::Failed);

    // The second of two repetitions of the procedure.
    let options = RunOptions {
        repeat: 2,
        ..RunOptions::default()
    };
    let outcome = run_round(&script, options, 1, |_| {});
    let names: Vec<_> = outcome.steps().iter().map(|s| s.name.clone()).collect();
    assert_eq!(names, ["a (4/6)", "a (5/6)", "a (6/6)"]);
    assert_eq!(outcome.fake.applied, [ON, OFF], "set-up and clean-up");
}

/// Goal: a step that could not be judged for want of data did not pass either.
#[test]
fn a_step_whose_condition_has_no_data_can_stop_the_procedure() {
    let script = format!("{HEAD}step('a', when = is_(limit, above = kmh(3)))\nstep('b')");
    let options = RunOptions {
        stop_on_fail: true,
        ..RunOptions::default()
    };
    let outcome = run_with(&script, options, |_| {});
    let verdicts: Vec<_> = outcome.steps().iter().map(|s| s.verdict).collect();
    assert_eq!(verdicts, [Verdict::Error, Verdict::Skipped]);
}

/// Goal: a counter that begins anew at 0 has gone on. Method: a count of 8 bits that goes up by one, from its
/// greatest to 0 and once around, and a quantity that falls, which is no counter.
#[test]
fn the_change_of_a_counter_counts_on_where_it_begins_anew() {
    let script = format!(
        "{HEAD}step('one', do = wait(ms(100)), measure = change('pulses', marker_count, low = 1, high = 1))
step('many', do = wait(s(4)), measure = change('pulses', marker_count, low = 300, high = 300))
step('none', do = wait(ms(100)), measure = [change('pulses', marker_count, high = 0), change('v', speed)])"
    );
    let outcome = run(&script, |world| {
        let count = match world.ms() {
            0..50 => 255,
            50..150 => 256,
            ms => (256 + (ms - 140) / 10).min(556),
        };
        let (count, speed) = (f64::from(count % 256), 9000.0 - f64::from(world.ms()));
        world.sample.set(Signal::MarkerCount, count);
        world.sample.set(Signal::Speed, speed);
    });
    assert_eq!(outcome.finished(), (Verdict::Passed, ""));
    let speed = outcome.steps()[2].measurements[1].value;
    assert_eq!(speed, Some(-100.0));
}

#[test]
fn a_failed_step_can_stop_the_procedure() {
    let script = format!(
        "{HEAD}step('a', expect = becomes(eb, 'applied', within = ms(20)), on_fail = 'stop')\nstep('b')"
    );
    let outcome = run(&script, |_| {});
    let expected = [Verdict::Failed, Verdict::Skipped];
    let verdicts: Vec<_> = outcome.steps().iter().map(|s| s.verdict).collect();
    assert_eq!(verdicts, expected);
    assert_eq!(outcome.steps()[1].message, "not run, \"a\" did not pass");
    let script = script.replace(", on_fail = 'stop'", "");
    let options = RunOptions {
        stop_on_fail: true,
        ..RunOptions::default()
    };
    let outcome = run_with(&script, options, |_| {});
    assert_eq!(outcome.steps()[1].verdict, Verdict::Skipped);
}

/// What is left is neither run nor reported, clean-up is, and the verdict is that of what was run.
#[test]
fn a_procedure_can_be_left_between_two_steps() {
    let script = format!(
        "{HEAD}step('a', expect = holds(eb, 'released', for_ = ms(50)))\nstep('b')\nstep('c')"
    );
    let options = RunOptions {
        one_by_one: true,
        ..RunOptions::default()
    };
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
    let script = format!("{HEAD}step('a')\nstep('b')\nstep('c')\nstep('d')");
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
fn a_pause_holds_up_no_stop() {
    let script = format!("{HEAD}step('a')\nstep('b')");
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
        world.link_error = (world.ms() >= 1_000).then_some("silent");
    });
    assert_eq!(lost.finished().0, Verdict::Error);
    assert!(lost.fake.made_safe > 0);
}

#[test]
fn nothing_chosen_is_an_error() {
    for chosen in [vec![], vec![7]] {
        let options = RunOptions {
            chosen: Some(chosen),
            ..RunOptions::default()
        };
        let outcome = run_with(&format!("{HEAD}step('a')"), options, |_| {});
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
    assert_eq!(outcome.summary(), [("a", Verdict::Error, message)]);
    let answers = [
        (Some(true), Verdict::Passed),
        (Some(false), Verdict::Failed),
        (None, Verdict::Error),
    ];
    for (answer, verdict) in answers {
        let options = RunOptions {
            prompts: PromptPolicy::Ask,
            ..RunOptions::default()
        };
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
fn waits_are_reported_twice_a_second() {
    let script = format!("{HEAD}step('a', do = until(eb, 'applied', within = s(2)))");
    let outcome = run(&script, |_| {});
    let left: Vec<_> = outcome
        .events
        .iter()
        .filter_map(|event| match event {
            RunEvent::Waiting { what, left } => Some((what.as_str(), left.as_ms())),
            _ => None,
        })
        .collect();
    let what = "until eb = applied within 2.000 s";
    assert_eq!(left, [(what, 1500), (what, 1000), (what, 500)]);
    let message = "eb = applied did not come within 2.000 s";
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

/// Goal: no step passes whose log is not known. Method: the log falls silent in the last step, for a while
/// and for good.
#[test]
fn a_step_ends_when_the_log_of_its_time_is_read_and_is_an_error_if_it_cannot_be() {
    let script = format!("{HEAD}step('a', do = wait(s(1)), expect = never_logs('twc_lost'))");
    let silent = |world: &mut World<'_>, until_ms: u32| {
        world.fake.evidence.log = match world.ms() {
            ms if ms >= 500 && ms < until_ms => LogState::Unanswered,
            _ => LogState::Read,
        };
    };
    let outcome = run(&script, |world| {
        silent(world, 4_000);
        if world.ms() == 4_000 {
            world.log(Event::TwcLost);
        }
    });
    assert_eq!(
        outcome.steps()[0].verdict,
        Verdict::Failed,
        "what came late counts"
    );
    let lost = "the unit's log could not be read: asked 69 times, no answer";
    let outcome = run(&script, |world| {
        silent(world, u32::MAX);
        world.link_error = (world.ms() >= 6_000).then_some(lost);
    });
    let text = format!("link to the unit: {lost}");
    assert_eq!(outcome.summary(), [("a", Verdict::Error, text.as_str())]);
    assert_eq!(outcome.finished(), (Verdict::Error, text.as_str()));
    let forever = run(&script, |world| silent(world, u32::MAX));
    assert_eq!(forever.steps()[0].verdict, Verdict::Error, "nobody gave up");
    assert_eq!(forever.finished().0, Verdict::Error);
}

#[test]
fn an_awaited_event_is_not_missing_while_the_log_is_not_read() {
    let script =
        format!("{HEAD}step('a', do = wait(s(1)), expect = logs('twc_lost', within = s(1)))");
    let outcome = run(&script, |world| {
        world.fake.evidence.log = match world.ms() {
            500..3_000 => LogState::Behind,
            _ => LogState::Read,
        };
        if world.ms() == 2_900 {
            world.log(Event::TwcLost);
        }
    });
    assert_eq!(outcome.summary(), [("a", Verdict::Passed, "")]);
    let in_vain = run(&script, |world| {
        world.fake.evidence.log = LogState::Unanswered;
        world.link_error = (world.ms() >= 6_000).then_some("no answer");
    });
    let reason = "link to the unit: no answer";
    assert_eq!(in_vain.summary(), [("a", Verdict::Error, reason)]);
}

#[test]
fn a_procedure_ends_with_its_log_read() {
    let script = format!("{HEAD}step('a', do = wait(s(1)))");
    let behind_until = |until_ms: u32| {
        run(&script, |world| {
            world.fake.evidence.log = match world.ms() {
                ms if ms >= 900 && ms < until_ms => LogState::Behind,
                _ => LogState::Read,
            };
        })
    };
    let outcome = behind_until(3_000);
    assert_eq!(
        (outcome.finished().0, outcome.scans),
        (Verdict::Passed, 300)
    );
    let message = "the unit's log was not read to its end within 25.000 s";
    assert_eq!(behind_until(u32::MAX).finished(), (Verdict::Error, message));
    let lost = run(&script, |world| {
        if world.ms() >= 900 {
            world.fake.evidence.log = LogState::Behind;
        }
        world.link_error = (world.ms() >= 2_000).then_some("no answer");
    });
    assert_eq!(
        lost.finished(),
        (Verdict::Error, "link to the unit: no answer")
    );
}

/// Goal: what a bad line does is no fault of a part, and what a part does on a good line is one. Method: the
/// same events, brake and missing reaction, with and without frames that did not come through.
#[test]
fn what_lost_frames_explain_is_an_error_and_no_fault() {
    let script = format!("{HEAD}step('a', do = wait(s(2)))");
    let expects =
        format!("{HEAD}step('a', do = wait(s(2)), expect = becomes(alarm, True, within = s(1)))");
    let came_to = |script: &str, harmed: u64, event: Option<Event>, brake: bool| {
        let outcome = run(script, |world| {
            world.sample.set(Signal::Alarm, 0.0);
            if world.ms() == 500 {
                world.fake.evidence.line.harmed = harmed;
                world.fake.evidence.line.harmed_lately = harmed;
                event.into_iter().for_each(|event| world.log(event));
                if brake {
                    world.sample.set(Signal::Eb, 1.0);
                }
            }
        });
        let faults = outcome.events.iter().filter(|event| {
            matches!(
                event,
                RunEvent::UnsolicitedBrake { .. } | RunEvent::UnsolicitedEvent(_)
            )
        });
        assert_eq!(outcome.finished().0, outcome.steps()[0].verdict);
        (outcome.steps()[0].verdict, faults.count())
    };
    let (failed, error) = (Verdict::Failed, Verdict::Error);
    for event in [
        Event::TwcLost,
        Event::TcmsLost,
        Event::InputsLost,
        Event::FramesRejected,
    ] {
        assert_eq!(
            came_to(&script, 0, Some(event), false),
            (failed, 1),
            "{event:?}"
        );
        assert_eq!(
            came_to(&script, 3, Some(event), false),
            (error, 0),
            "{event:?}"
        );
    }
    assert_eq!(
        came_to(&script, 3, Some(Event::EbRelayWelded), false),
        (failed, 1)
    );
    assert_eq!(came_to(&script, 0, None, true), (failed, 1));
    assert_eq!(came_to(&script, 3, None, true), (error, 0));
    assert_eq!(came_to(&expects, 0, None, false).0, failed);
    assert_eq!(came_to(&expects, 3, None, false).0, error);
}

#[test]
fn a_failed_self_test_is_said_item_by_item_and_is_no_pass() {
    let outcome = run(&format!("{HEAD}step('a', do = wait(s(1)))"), |world| {
        world.fake.evidence.self_test = SelfTest::MEMORY | SelfTest::from_bits_retain(1 << 9);
    });
    let message = "the unit says its self-test failed: Memory pattern test; bit 9";
    assert_eq!(outcome.summary(), [("a", Verdict::Passed, "")]);
    assert_eq!(outcome.finished(), (Verdict::Failed, message));
}

#[test]
fn events_without_end_are_reported_up_to_what_a_log_holds_and_counted_beyond() {
    let outcome = run(&format!("{HEAD}step('a', do = wait(s(10)))"), |world| {
        world.log(Event::TwcLost);
        world.fake.evidence.not_kept = 1_000 + u64::from(world.scan);
    });
    let reported = outcome
        .events
        .iter()
        .filter(|e| matches!(e, RunEvent::UnsolicitedEvent(_)));
    assert_eq!(reported.count(), LOG_ENTRIES);
    let step = outcome.steps()[0];
    let said = step
        .message
        .strip_prefix("the unit logged twc_lost (400), which no step provoked (");
    assert!(
        said.is_some_and(|times| times.ends_with(" times)")),
        "{}",
        step.message
    );
    let (verdict, message) = outcome.finished();
    assert_eq!(verdict, Verdict::Failed);
    assert!(message.ends_with(" more entries, not stored"), "{message}");
}

#[test]
fn a_check_that_failed_is_said_before_one_that_could_not_be_made() {
    let two = format!(
        "{HEAD}step('a', expect = becomes(eb, 'applied', within = s(1)))\n\
         step('b', expect = becomes(alarm, True, within = s(1)))"
    );
    let outcome = run(&two, |_| {});
    assert_eq!(outcome.steps()[0].verdict, Verdict::Failed);
    assert_eq!(outcome.steps()[1].verdict, Verdict::Error);
    assert_eq!(outcome.finished().0, Verdict::Failed);
    let lost = run(&two, |world| {
        world.link_error = (world.ms() >= 1_500).then_some("closed");
    });
    assert_eq!(
        lost.finished().0,
        Verdict::Error,
        "then nothing is a verdict on the unit"
    );
}

#[test]
fn a_reason_stands_once_with_its_count() {
    let until = "until(eb, 'applied', within = s(1))";
    let script = format!("procedure(title = 'x', cleanup = [{until}, {until}])\nstep('a')");
    let message = "clean-up: eb = applied did not come within 1.000 s (2 times)";
    assert_eq!(run(&script, |_| {}).finished(), (Verdict::Error, message));
}
