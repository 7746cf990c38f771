//! What is told of a recording beside its codes: how loud it is, what nobody understands, and the lines of speed sensors.

use btu_rig::waveform::{CodeWave, Noise};

use super::tests::unit;
use super::*;

/// A recording of these samples, mV.
fn read_of(sample_hz: u32, samples: impl Iterator<Item = f64>) -> Reading {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("x.wav");
    wav::write(&path, (sample_hz, 1), FULL_SCALE_MV, samples).expect("written");
    read(&path, &unit(), FULL_SCALE_MV).expect("read")
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
        assert!((tacho.phase_deg - phase).abs() < 12.0, "{what}");
        let duty = tacho.duty_percent.map(|of| (of - 100.0 * teeth.duty).abs());
        assert!(duty.into_iter().all(|off| off < 3.0), "{what}");
        let pulses = 3.0 * kmh / 3.6 / unit.metres_per_pulse();
        let turns = (pulses / f64::from(teeth.per_turn)) as u64;
        let missing = if teeth.lacks_one { turns } else { 0 };
        assert!(tacho.missing_teeth.abs_diff(missing) <= 1, "{what}");
        assert_eq!(tacho.missing_teeth == 0, !teeth.lacks_one, "{what}");
        let [way, other] = match teeth.phase > 0.0 {
            true => [tacho.forward, tacho.backward],
            false => [tacho.backward, tacho.forward],
        };
        assert!(way > 0 && other == 0, "{what}");
    }
}
