//! What is told of a recording beside its codes: how loud it is, what nobody understands, and the lines of speed sensors.

use btu_rig::waveform::{CodeWave, FskWave, Noise};

use fuzzing::draw;
use protocol::config::UnitConfig;

use super::tests::{unit, unit_of};
use super::*;

/// A recording of these samples, mV.
fn read_of(sample_hz: u32, samples: impl Iterator<Item = f64>) -> Reading {
    read_by(&unit(), sample_hz, samples)
}

fn read_by(unit: &UnitConfig, sample_hz: u32, samples: impl Iterator<Item = f64>) -> Reading {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("x.wav");
    wav::write(&path, (sample_hz, 1), FULL_SCALE_MV, samples).expect("written");
    read(&path, unit, FULL_SCALE_MV).expect("read")
}

/// Goal: a code too weak for the receiver shows on the meter; and a code is read at any rate of samples, at its level.
#[test]
fn a_weak_code_is_on_the_meter_and_a_fast_recording_is_read() {
    let weak = read_of(
        48_000,
        CodeWave::new(3_000.0, 15.0, 40.0, 48e3).take(96_000),
    );
    assert_eq!(weak.sources, []);
    let [level] = &weak.levels[..] else {
        panic!("{weak:?}");
    };
    // On for half of the time.
    assert!((level.level_mv - 28.0).abs() < 1.0, "{level:?}");
    assert!(
        (level.strongest_hz.expect("a line") - 3_000.0).abs() < 5.0,
        "{level:?}"
    );
    for sample_hz in [44_100, 96_000, 176_400, 384_000, 768_000] {
        let rate = f64::from(sample_hz);
        let wave = CodeWave::new(3_000.0, 15.0, 500.0, rate).take(sample_hz as usize);
        let reading = read_of(sample_hz, wave);
        let [code] = &reading.sources[..] else {
            panic!("{sample_hz}: {reading:?}");
        };
        assert_eq!(code.what, "55", "{sample_hz}");
        let level_mv = code.level_mv.expect("measured");
        assert!((level_mv - 500.0).abs() < 25.0, "{sample_hz}: {code:?}");
        assert!((reading.duration_s - 1.0).abs() < 0.01, "{reading:?}");
    }
}

/// Goal: the image of a low carrier is no part of the level. Method: the slowest and the fastest code on 100 Hz.
#[test]
fn the_level_of_a_code_on_a_low_carrier_is_found() {
    let unit = unit_of("us_cab");
    for code in [&unit.codes[0], &unit.codes[unit.codes.len() - 1]] {
        let wave = CodeWave::new(code.carrier_hz, code.rate_hz, 500.0, 48e3);
        let reading = read_by(&unit, 48_000, wave.take(480_000));
        let level_mv = reading.sources[0].level_mv.expect("measured");
        assert!(
            (level_mv / 500.0 - 1.0).abs() < 0.02,
            "{}: {level_mv} mV",
            code.name
        );
    }
}

/// Goal: of each code, from 10 to 30 dB, the rate is found to one and a half times what a sine of its fundamental allows at
/// best (Cramér and Rao), and its level to 2 %, over recordings of 0.55 s. Method: the root of the mean square error over
/// recordings with seeds of their own.
#[test]
fn rate_and_level_of_a_code_are_found_nearly_as_exactly_as_can_be() {
    let unit = unit();
    for code in draw::drawn(&unit.codes, 4) {
        for snr_db in [10.0, 20.0, 30.0] {
            let (mut rates, mut levels, recordings) = (0.0, 0.0, 25);
            let mut heard = 0u64;
            for seed in 0..recordings {
                let noise = Noise::new(500.0, snr_db, 320.0, 48e3, 760_000 + seed);
                let wave = CodeWave::new(code.carrier_hz, code.rate_hz, 500.0, 48e3);
                let wave = wave.skip(seed as usize * 977).zip(noise);
                let reading = read_of(48_000, wave.take(26_400).map(|(a, b)| a + b));
                let Some(source) = reading.sources.first() else {
                    continue;
                };
                heard += 1;
                rates += (source.rate_hz - code.rate_hz).powi(2);
                levels += source.level_mv.expect("measured") / 500.0;
            }
            assert!(heard + 2 >= recordings, "{}: {heard} heard", code.name);
            let (rates, levels) = (rates / heard as f64, levels / heard as f64);
            let what = format!("{}, {snr_db} dB: {} Hz, {levels}", code.name, rates.sqrt());
            let tone = 0.5 * (2.0 / std::f64::consts::PI).powi(2) * 2.0;
            let (eta, values) = (tone * 10f64.powf(snr_db / 10.0), 320.0 * 0.55);
            let bound = (12.0 / (eta * values)).sqrt() / (std::f64::consts::TAU * 0.55);
            assert!(rates.sqrt() < 1.5 * bound, "{what}, at best {bound}");
            assert!((levels - 1.0).abs() < 0.02 || snr_db < 15.0, "{what}");
        }
    }
}

/// Goal: TWC as it is shipped is heard from the weakest level on, and in noise nearly as well as two tones can be told apart
/// without their phase: at 8 and 10 dB few bytes more are missing than theory's bit errors make.
/// Method: bytes with noise of seeds of their own.
#[test]
fn bytes_are_heard_in_noise_and_at_the_weakest_level() {
    let unit = unit();
    let wave = |bytes: &[u8], level_mv| {
        let twc = &unit.twc;
        let tones = (twc.middle_hz, twc.apart_hz);
        FskWave::new(bytes, tones, twc.bits_per_s, level_mv, 48e3)
    };
    let weakest = read_of(
        48_000,
        wave(&[1, 0xfe, 0x3c], unit.receiver.level_min_mv + 2.0),
    );
    assert_eq!(weakest.sources[0].what, "01 fe 3c", "{weakest:?}");
    assert_eq!(read_of(48_000, wave(&[1, 0xfe], 50.0)).sources, []);
    let bytes: Vec<u8> = (0..4_000u32).map(|n| (n * 37 + n / 256) as u8).collect();
    for (snr_db, share) in [(8.0, 0.75), (10.0, 0.95)] {
        let noise = Noise::new(500.0, snr_db, unit.twc.bits_per_s, 48e3, 7_610);
        let noisy = wave(&bytes, 500.0).zip(noise).map(|(a, b)| a + b);
        let reading = read_of(48_000, noisy);
        let twc = reading.sources.iter().filter(|source| source.kind == "twc");
        let heard: usize = twc.map(|source| source.what.split(' ').count()).sum();
        let bit_error = 0.5 * (-10f64.powf(snr_db / 10.0) / 2.0).exp();
        let whole = (1.0 - bit_error).powi(11) * bytes.len() as f64;
        assert!(
            heard as f64 > share * whole,
            "{snr_db} dB: {heard} of {whole}"
        );
    }
}

/// Goal: noise for long is told in a few lines, and no code of it.
#[test]
fn noise_is_told_in_few_lines() {
    for (level_mv, most) in [(500.0, 2), (8.0, 32)] {
        let reading = read_of(
            48_000,
            Noise::new(level_mv, 0.0, 320.0, 48e3, 76).take(1_440_000),
        );
        assert_eq!(reading.sources, []);
        let lines = reading.not_understood.len();
        assert!((1..=most).contains(&lines), "{lines} lines");
        let told = &reading.not_understood;
        let whole = told.iter().map(|of| of.to_s - of.from_s).sum::<f64>();
        assert!(whole > 25.0 || level_mv < 10.0, "{whole} s of 30");
    }
}

/// Goal: each way in which a speed sensor is worn or mounted is read as it was made, in noise.
#[test]
fn the_lines_of_a_speed_sensor_are_read_as_they_were_made() {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("x.wav");
    let unit = unit();
    let even = Teeth {
        per_turn: unit.tacho.pulses_per_turn,
        lacks_one: false,
        phase: 0.25,
        duty: 0.5,
    };
    let strength = Strength {
        level_mv: 1_000.0,
        snr_db: Some(30.0),
        seed: 76,
    };
    let worn = Teeth {
        lacks_one: true,
        ..even
    };
    let turned = Teeth {
        phase: -0.25,
        ..even
    };
    let moved = Teeth {
        phase: 0.15,
        duty: 0.35,
        ..even
    };
    for (teeth, kmh) in [
        (even, 5.0),
        (even, 80.0),
        (worn, 40.0),
        (turned, 40.0),
        (moved, 20.0),
    ] {
        let to = (path.as_path(), FULL_SCALE_MV);
        make_tacho(teeth, (kmh, 3.0), &unit, strength, to).expect("made");
        let reading = read_tacho(&path, &unit, FULL_SCALE_MV).expect("read");
        let [source] = &reading.sources[..] else {
            panic!("{reading:?}");
        };
        let tacho = source.tacho.as_ref().expect("a sensor");
        let what = format!("{teeth:?}, {kmh} km/h: {tacho:?}");
        assert!((tacho.mean_kmh / kmh - 1.0).abs() < 0.002, "{what}");
        let phase = teeth.phase.rem_euclid(1.0) * 360.0;
        assert!((tacho.phase_deg - phase).abs() < 1.5, "{what}");
        let duty = tacho.duty_percent.map(|of| (of - 100.0 * teeth.duty).abs());
        assert!(duty.into_iter().all(|off| off < 3.0), "{what}");
        assert_eq!(tacho.missing_teeth, u64::from(teeth.lacks_one), "{what}");
        assert_eq!(reading.not_understood, [], "{what}");
        let [way, other] = match teeth.phase > 0.0 {
            true => [tacho.forward, tacho.backward],
            false => [tacho.backward, tacho.forward],
        };
        assert!(way > 0 && other == 0, "{what}");
    }
}

/// Goal: noise on the lines of a sensor, and a wave that is cut off by what recorded it, are told; neither of a sound one.
#[test]
fn noise_is_no_sensor_and_a_clipped_wave_is_told() {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("x.wav");
    let noise = Noise::new(1_000.0, 0.0, 24_000.0, 48_000.0, 5);
    wav::write(&path, (48_000, 2), FULL_SCALE_MV, noise.take(96_000)).expect("written");
    let reading = read_tacho(&path, &unit(), FULL_SCALE_MV).expect("read");
    let told: Vec<_> = reading
        .not_understood
        .into_iter()
        .map(|of| of.why)
        .collect();
    assert_eq!(told, [Why::NoSensor(1)]);
    for (level_mv, is_clipped) in [(2_700.0, false), (3_500.0, true)] {
        let code = CodeWave::new(3_000.0, 15.0, level_mv, 48_000.0);
        wav::write(&path, (48_000, 1), FULL_SCALE_MV, code.take(96_000)).expect("written");
        let reading = read(&path, &unit(), FULL_SCALE_MV).expect("read");
        let clipped = |of: &NotUnderstood| matches!(of.why, Why::Clipped { channel: 1, .. });
        let told = reading.not_understood.iter().any(clipped);
        assert_eq!(told, is_clipped, "{reading:?}");
    }
}
