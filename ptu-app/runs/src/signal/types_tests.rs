//! Types of signalling as data: the receiver hears the codes of each, and a table that it cannot hear is refused.

use ato_under_test::receivers::{CodeReceiver, Reception};
use btu_rig::waveform::{CodeWave, Noise};
use protocol::Random;

use super::coil_tests::{SCAN_SAMPLES, by_turns, decided, no_burst_is_heard};
use super::tests::{unit, unit_of};
use super::*;
use crate::test_support::scripts;
use crate::words::Unheard;

const RATE: f64 = 48_000.0;

/// Goal: a table whose codes the receiver cannot hear is refused with the code and the reason, and each shipped one is heard.
#[test]
fn a_table_that_the_receiver_cannot_hear_is_refused() {
    for name in scripts().unit_config_names() {
        let config = unit_of(&name);
        assert_eq!(unheard(&config).map(|of| of.0.name.clone()), None, "{name}");
    }
    let mut hasty = unit_of("us_cab");
    hasty.receiver.detect_ms = 400;
    let (code, carrier_hz, why) = unheard(&hasty).expect("too short");
    assert_eq!((code.name.as_str(), carrier_hz), ("75ppm", 100.0));
    assert_eq!(why, Unheard::Short(400, 1_800));
    let mut low = unit();
    low.codes
        .iter_mut()
        .for_each(|code| code.carrier_hz = 100.0);
    assert!(
        unheard(&low).is_some(),
        "the carrier is slower than the filter is wide"
    );
}

/// Goal: with each type of code a unit decides on no other code than the two that were sent, on any of its carriers, and on
/// each of them soon. Method: codes one after the other at any phase, in noise of 10 to 30 dB.
#[test]
fn codes_that_key_slowly_are_told_apart_on_each_carrier() {
    are_told_apart("us_cab", 16);
}

#[test]
fn codes_that_shift_are_told_apart_on_each_carrier() {
    are_told_apart("zpw2000", 40);
}

#[test]
fn bursts_of_slow_codes_and_of_those_that_shift_are_not_heard() {
    let mut random = Random::new(5);
    no_burst_is_heard("zpw2000", [65, 50], (18, 250), &mut random);
    no_burst_is_heard("us_cab", [60, 50], (8, 600), &mut random);
}

/// Goal: a code with pauses of 0.1 to 0.4 s is decoded when its time is over, though it fills no part of the window whole when
/// it is heard first; and it is over with its first pause that is too long.
#[test]
fn a_slow_code_is_there_from_its_beginning_to_its_end() {
    let config = unit_of("us_cab");
    let detect = config.receiver.detect_ms as usize / 10;
    for code in &config.codes {
        let half_period = (50.0 / code.rate_hz) as usize;
        let parts = [(None, 1_000), (Some(code.rate_hz), 4_000), (None, 2_000)];
        let samples = by_turns(&config, &parts, 500.0, 0);
        let decided = decided(&config, samples.into_iter(), 700);
        let from = decided.first().expect("decoded").0 - 100;
        let to = decided.last().expect("decoded").0;
        let name = &code.name;
        assert!(
            (detect..detect + 10).contains(&from),
            "{name}: {from} scans"
        );
        assert!(to < 500 + half_period + 8, "{name}: until scan {to}");
    }
}

/// Goal: a rate that is none of the table's is told: one that is too fast or too slow for the window.
#[test]
fn a_rate_of_no_code_is_heard_as_what_it_is() {
    for (name, rate_hz) in [
        ("us_cab", 24.5),
        ("us_cab", 6.25),
        ("zpw2000", 2.0),
        ("zpw2000", 32.0),
    ] {
        let config = unit_of(name);
        let carrier_hz = config.codes[0].carrier_hz;
        let wave = CodeWave::new(carrier_hz, rate_hz, 500.0, RATE);
        let wave = wave.shifted(config.receiver.shift_hz, RATE);
        let mut receiver = CodeReceiver::new(Reception::of(&config, carrier_hz), RATE as f32);
        wave.take(144_000).for_each(|mv| receiver.take(mv as f32));
        let rates: Vec<_> = config
            .codes
            .iter()
            .map(|code| code.rate_hz as f32)
            .collect();
        let heard = receiver.heard(&rates).map(|heard| f64::from(heard.rate_hz));
        assert!(
            heard.is_some_and(|hz| (hz - rate_hz).abs() < 0.1),
            "{name}, {rate_hz} Hz: {heard:?}"
        );
    }
}

fn are_told_apart(name: &str, pairs: usize) {
    let mut random = Random::new(7_603);
    let config = unit_of(name);
    let carriers = config.carriers_hz();
    let rates: Vec<f64> = config.codes.iter().map(|code| code.rate_hz).collect();
    let samples = (f64::from(config.receiver.detect_ms) / 1_000.0 * 1.9 * RATE) as usize;
    for pair in 0..pairs {
        let first = rates[pair % rates.len()];
        let second = match pair % 2 {
            // Next to each other in the table.
            0 => rates[(pair + 1) % rates.len()],
            _ => rates[random.below(rates.len())],
        };
        let carrier_hz = carriers[pair % carriers.len()];
        let snr_db = [30.0, 20.0, 15.0, 10.0][random.below(4)];
        let mut wave = |rate_hz: f64| {
            let wave = CodeWave::new(carrier_hz, rate_hz, 500.0, RATE);
            let wave = wave.shifted(config.receiver.shift_hz, RATE);
            wave.skip(random.below(96_000)).take(samples)
        };
        let spliced = wave(first).chain(wave(second));
        let noise = Noise::new(500.0, snr_db, 320.0, RATE, pair as u64 + 760);
        let noisy = spliced.zip(noise).map(|(signal, noise)| signal + noise);
        let decided = decided(&config, noisy, 2 * samples / SCAN_SAMPLES);
        let what = format!("{name}: {first}, then {second} Hz on {carrier_hz}, {snr_db} dB");
        for (scan, rate) in &decided {
            assert!(
                [first, second].contains(rate),
                "{what}: {rate} in scan {scan}"
            );
        }
        for rate in [first, second] {
            let is_heard = decided.iter().any(|(_, heard)| *heard == rate);
            assert!(is_heard || snr_db < 15.0, "{what}: {rate} is not heard");
        }
    }
    let noise = Noise::new(500.0, 0.0, 320.0, RATE, 1);
    assert_eq!(decided(&config, noise, 1_000), [], "{name}: noise");
}

/// Goal: a receiver that has lost its selection hears another than the stronger of two codes in most of their phases, and no
/// second one where there is none.
#[test]
fn a_receiver_without_selection_hears_the_weaker_code() {
    let config = unit();
    let rates: Vec<f32> = config
        .codes
        .iter()
        .map(|code| code.rate_hz as f32)
        .collect();
    let mut random = Random::new(762);
    let mut others = 0;
    for (own, other) in [(10.0, 29.0), (29.0, 10.0), (15.0, 36.0), (36.0, 12.0)] {
        for case in 0..12 {
            let mut wave = |rate_hz: f64, level_mv: f64| {
                let wave = CodeWave::new(3_000.0, rate_hz, level_mv, RATE);
                wave.skip(random.below(96_000))
            };
            let second = [250.0, 0.0][case % 2];
            let both = wave(own, 500.0).zip(wave(other, second));
            let reception = Reception::of(&config, 3_000.0);
            let mut receiver = CodeReceiver::new(reception, RATE as f32);
            both.take(24_000)
                .for_each(|(a, b)| receiver.take((a + b) as f32));
            let heard = receiver
                .weaker(&rates)
                .map(|heard| f64::from(heard.rate_hz));
            assert!(
                heard != Some(own) && (second > 0.0 || heard.is_none()),
                "{own}, {other}: {case}, {heard:?}"
            );
            others += u32::from(heard.is_some());
        }
    }
    assert!(others > 12, "{others} of 24");
}
