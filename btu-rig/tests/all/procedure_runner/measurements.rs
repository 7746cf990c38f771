//! Measurements of a step and their limits.

use btu_rig::procedure::Verdict;
use protocol::message::SelfTest;
use protocol::signal::Signal;

use super::stand_in::{HEAD, options, run, run_with};

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
    assert_eq!(step.verdict, Verdict::Passed, "{}", step.findings);
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
fn a_condition_that_many_measurements_await_is_reported_once() {
    let script = format!(
        "{HEAD}step('a', measure = [at('v%d' % n, speed, when = is_(eb, 'applied')) for n in range(17)])"
    );
    let outcome = run(&script, |world| world.sample.set(Signal::Eb, 0.0));
    let message = "v0 and 16 more: no value, eb = applied did not come about in time";
    assert_eq!(outcome.summary(), [("a", Verdict::Error, message)]);
}

#[test]
fn limits_missing_data_and_nan_never_pass() {
    use Verdict::{Error, Failed, Passed};
    let most = "value('v', speed, high = kmh(20))";
    let both = "value('v', speed, low = kmh(5), high = kmh(20))";
    let greatest = "maximum('v', speed, high = kmh(20))";
    let (nan, no_data) = (f64::NAN, "v: no data for speed");
    for (measure, speed, verdict, message) in [
        (most, 20.0, Passed, ""),
        (most, 21.0, Failed, "v = 21, allowed at most 20 km/h"),
        (both, 4.0, Failed, "v = 4, allowed 5 to 20 km/h"),
        (most, nan, Error, no_data),
        ("value('v', speed)", nan, Error, no_data),
        (greatest, nan, Error, no_data),
        ("change('v', speed)", nan, Error, no_data),
        (most, f64::INFINITY, Error, no_data),
    ] {
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
    let options = options(|it| it.chosen = Some(vec![1]));
    let outcome = run_with(&script, options, |_| {});
    let message = "w: a limit refers to a measurement without a value";
    assert_eq!(outcome.summary(), [("b", Verdict::Error, message)]);
}

/// Goal: a counter that begins again at 0 has gone on. Method: a count of 8 bits that goes up by one, from its
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

/// A unit of an older version makes fewer items: those it does not make are left out, and say nothing.
#[test]
fn an_item_of_the_self_test_that_the_unit_does_not_make_is_left_out() {
    let script = format!("{HEAD}step('a', do = ptu.self_test())");
    let known = SelfTest::from_bits_retain(0xFF);
    let outcome = run(&script, |world| world.fake.self_test = known);
    let step = outcome.steps()[0];
    assert_eq!(step.verdict, Verdict::Passed, "{}", step.findings);
    for measurement in &step.measurements {
        let new = ["self_test.twc_cpu", "self_test.tcms_link"].contains(&measurement.name.as_str());
        let expected = if new {
            (Verdict::Skipped, None)
        } else {
            (Verdict::Passed, Some(0.0))
        };
        assert_eq!((measurement.verdict, measurement.value), expected);
    }
    // A unit that says nothing of any is another matter.
    let silent = run(&script, |_| {});
    assert_eq!(silent.steps()[0].verdict, Verdict::Error);
}
