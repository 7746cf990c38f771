//! What the bench makes is what the unit reads.

use std::path::Path;

use ato_under_test::receivers::{Demodulator, FskReceiver, Received, Tones};
use btu_rig::waveform::{CodeWave, FskWave, Noise};
use protocol::config::UnitConfig;

use super::coil_tests::{SCAN_SAMPLES, decided};
use super::*;
use crate::test_support::scripts;

const RATE: f64 = 48_000.0;
/// 9 650 ± 150 Hz, as a public data sheet of a TWC has it (Alstom); at 300 bit/s they are orthogonal.
const TONES: Tones = Tones {
    middle_hz: 9_650.0,
    apart_hz: 150.0,
    bit_rate: 300.0,
};

/// The unit configuration of the defaults.
pub(super) fn unit() -> UnitConfig {
    unit_of("sg100")
}

/// The unit configuration of this name.
pub(super) fn unit_of(name: &str) -> UnitConfig {
    scripts().unit_config(name).expect("read").content
}

fn made(wave: &Wave, path: &Path) -> Reading {
    let unit = unit();
    let strength = Strength {
        level_mv: 500.0,
        snr_db: Some(20.0),
        seed: 7,
    };
    make(wave, &unit, strength, (path, FULL_SCALE_MV)).expect("made");
    read(path, &unit, FULL_SCALE_MV).expect("read")
}

/// Goal: each code is read by its name, at its level and from when to when it lasts, with noise 20 dB below it.
#[test]
fn each_code_is_read_as_it_was_made() {
    let dir = tempfile::tempdir().expect("a directory");
    for code in unit().codes {
        let path = dir.path().join("code.wav");
        let wave = Wave::Code {
            name: code.name.clone(),
            seconds: 3.0,
        };
        let reading = made(&wave, &path);
        let [source] = &reading.sources[..] else {
            panic!("{}: {reading:?}", code.name);
        };
        assert_eq!((source.kind, &source.what), ("code", &code.name));
        let level = source.level_mv.expect("measured");
        assert!((level - 500.0).abs() < 35.0, "{source:?}");
        assert!((source.rate_hz - code.rate_hz).abs() < 0.1, "{source:?}");
        assert!(
            (source.carrier_hz - code.carrier_hz).abs() < 2.0,
            "{source:?}"
        );
        assert!(source.from_s < 0.1 && source.to_s > 2.9, "{source:?}");
        let snr = source.snr_db.expect("known");
        assert!((snr - 20.0).abs() < 4.0, "{source:?}");
        assert_eq!(reading.not_understood, []);
    }
}

/// Goal: a code whose phase jumps stays that code in a recording: none of the table's others is listed meanwhile. Method: each
/// code, with jumps of the phase in steps of a tenth.
#[test]
fn a_jump_of_the_phase_is_no_other_code() {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("jumps.wav");
    let unit = unit();
    for code in &unit.codes {
        let wave = |skipped: usize| {
            CodeWave::new(code.carrier_hz, code.rate_hz, 500.0, RATE).skip(skipped)
        };
        let tenth = (RATE / code.rate_hz / 10.0) as usize;
        let mut samples = (0..10).flat_map(|jump| wave(jump * jump * tenth).take(48_000));
        wav::write(&path, (48_000, 1), FULL_SCALE_MV, &mut samples).expect("written");
        let reading = read(&path, &unit, FULL_SCALE_MV).expect("read");
        for source in &reading.sources {
            let is_known = unit.codes.iter().any(|code| code.name == source.what);
            assert!(
                !is_known || source.what == code.name,
                "{}: {source:?}",
                code.name
            );
        }
    }
}

#[test]
fn bytes_are_read_as_they_were_made() {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("twc.wav");
    let bytes: Vec<u8> = (0..=255).collect();
    let reading = made(&Wave::Twc(bytes.clone()), &path);
    let [source] = &reading.sources[..] else {
        panic!("{reading:?}");
    };
    let hex: Vec<_> = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!((source.kind, &source.what), ("twc", &hex.join(" ")));
    assert_eq!(source.bad_bytes, Some(0));
}

/// Goal: at no moment around a change of the code does a unit decide on another one than the two that were sent, and noise
/// alone is no code. Method: all pairs of codes, spliced at any phase, with noise of 0 to 30 dB.
#[test]
fn a_change_of_code_is_never_a_third_code() {
    let unit = unit();
    let rates: Vec<f64> = unit.codes.iter().map(|code| code.rate_hz).collect();
    let (mut asked, mut heard) = (0, 0);
    for (place, first) in rates.iter().enumerate() {
        for (other, second) in rates.iter().enumerate() {
            let snr_db = f64::from((place * 7 + other) as u32 % 7) * 5.0;
            let length = 40_000 + 331 * (7 * place + other);
            let wave = |rate: f64| CodeWave::new(3_000.0, rate, 500.0, RATE);
            let spliced = wave(*first).take(length).chain(wave(*second).take(40_000));
            let noise = Noise::new(500.0, snr_db, 320.0, RATE, (place * 8 + other) as u64);
            let noisy = spliced.zip(noise).map(|(signal, noise)| signal + noise);
            let scans = (length + 40_000) / SCAN_SAMPLES;
            let decided = decided(&unit, noisy, scans);
            asked += scans;
            heard += decided.len();
            for (scan, rate) in decided {
                assert!(
                    [first, second].contains(&&rate),
                    "{first} then {second} Hz: {rate} Hz at {snr_db} dB in scan {scan}"
                );
            }
        }
    }
    // Of 0.8 s of each code the time of detection is half, and in noise more; at 0 and 5 dB few are heard.
    assert!(heard * 10 > asked * 3, "{heard} of {asked}");
    let noise = Noise::new(500.0, 0.0, 320.0, RATE, 1);
    assert_eq!(decided(&unit, noise, 1_000), []);
}

/// Goal: bytes with a bit error are not taken for others. Method: noise at which one byte in ten has one.
#[test]
fn a_byte_with_a_wrong_bit_is_told() {
    let tones = TONES;
    let mut receiver = FskReceiver::new(tones, RATE as f32, 60.0);
    let bytes: Vec<u8> = (0..400u32).map(|n| (n * 37) as u8).collect();
    let wave = FskWave::new(&bytes, (9_650.0, 150.0), 300.0, 500.0, RATE);
    let noise = Noise::new(500.0, 11.0, 300.0, RATE, 3);
    let received: Vec<_> = wave
        .zip(noise)
        .filter_map(|(signal, noise)| receiver.take((signal + noise) as f32))
        .collect();
    let good = received
        .iter()
        .filter(|one| matches!(one, Received::Byte(_)))
        .count();
    assert!(
        received.len() - good < 40 && good > 360,
        "{good} of {}",
        received.len()
    );
}

/// Goal: what a person looks at is what was made, and an hour of it takes no more room than seconds do. Method: a code and
/// bytes; then silence after them, until every reduction has taken place many times.
#[test]
fn a_picture_shows_what_is_there_and_stays_small() {
    let mut picture = Picture::new(RATE, (3_000.0, 36.0), TONES);
    let code = CodeWave::new(3_000.0, 10.0, 500.0, RATE).take(96_000);
    let twc = FskWave::new(&[0x5a; 20], (9_650.0, 150.0), 300.0, 200.0, RATE);
    let samples: Vec<f32> = code
        .zip(twc.chain(std::iter::repeat(0.0)))
        .map(|(code, twc)| (code + twc) as f32)
        .collect();
    samples
        .chunks(1_000)
        .for_each(|samples| picture.take(samples));
    let (envelope, each_s) = picture.envelope();
    let at = |s: f64| envelope[(s / each_s) as usize];
    // 10 Hz: on from the beginning of each tenth of a second, off after the half of it.
    assert!((at(1.025).high - 500.0).abs() < 30.0, "{:?}", at(1.025));
    assert!(at(1.075).high < 30.0, "{:?}", at(1.075));
    let (spectrum, hz) = picture.mean_spectrum();
    let loudest = (0..spectrum.len()).max_by(|a, b| spectrum[*a].total_cmp(&spectrum[*b]));
    let loudest_hz = loudest.expect("a spectrum") as f64 * hz;
    assert!((loudest_hz - 3_000.0).abs() < 2.0 * hz, "{loudest_hz}");
    let (spectra, _) = picture.spectra();
    let row = |hz: f64| (hz / picture.row_hz()) as usize;
    let early = &spectra[2];
    assert!(
        early[row(9_800.0)] > early[row(7_000.0)] + 30.0,
        "the tones of TWC"
    );
    assert!(picture.eye().len() > 50);
    assert!((picture.eye().iter()).all(|curve| curve.last().expect("a decision").abs() > 0.9));

    let silence = vec![0.0; 48_000];
    (0..200).for_each(|_| picture.take(&silence));
    let (wave, each_s) = picture.wave();
    assert!((512..=1_024).contains(&wave.len()), "{}", wave.len());
    let length_s = wave.len() as f64 * each_s;
    assert!((length_s - 202.0).abs() < 2.0 * each_s, "{length_s} s");
    let (spectra, each_s) = picture.spectra();
    assert!((256..=512).contains(&spectra.len()), "{}", spectra.len());
    let length_s = spectra.len() as f64 * each_s;
    assert!((length_s - 202.0).abs() < 3.0 * each_s, "{length_s} s");
    assert!(picture.eye().len() <= 200);
}

/// Goal: a recording of several channels is read from each, and what nobody could hold in memory is refused or cut.
#[test]
fn channels_are_read_each_and_not_without_end() {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("channels.wav");
    let write = |channels: u16, sample_rate: u32| {
        let spec = hound::WavSpec {
            channels,
            sample_rate,
            bits_per_sample: 16,
            sample_format: hound::SampleFormat::Int,
        };
        let mut writer = hound::WavWriter::create(&path, spec).expect("begun");
        let code = CodeWave::new(3_000.0, 10.0, 4_000.0, RATE);
        for sample in code.take(72_000) {
            for channel in 0..channels {
                let sample = if channel == 1 { sample } else { 0.0 };
                writer.write_sample(sample as i16).expect("written");
            }
        }
        writer.finalize().expect("written");
    };
    let unit = unit();
    write(2, 48_000);
    let reading = read(&path, &unit, FULL_SCALE_MV).expect("read");
    assert_eq!(reading.sources.len(), 1, "{reading:?}");
    assert_eq!(reading.sources[0].channel, 2);
    write(20, 48_000);
    let reading = read(&path, &unit, FULL_SCALE_MV).expect("read");
    assert_eq!(reading.sources.len(), 1, "{reading:?}");
    assert_eq!(reading.not_understood[0].why, Why::Channels(20));
    write(1, 48_000);
    let mut bytes = std::fs::read(&path).expect("the file");
    bytes[24..28].copy_from_slice(&2_000_000_000u32.to_le_bytes());
    bytes[28..32].copy_from_slice(&4_000_000_000u32.to_le_bytes());
    std::fs::write(&path, bytes).expect("another rate");
    let refused = read(&path, &unit, FULL_SCALE_MV).expect_err("no recording");
    assert!(
        refused.to_string().contains("2000000000 Hz"),
        "{}",
        refused.to_string()
    );
}

/// Goal: what is no recording of such signals ends in words, not in a code and not in a panic.
#[test]
fn what_is_no_such_signal_is_said() {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("x.wav");
    let unit = unit();
    let write = |samples: &mut dyn Iterator<Item = f64>| {
        wav::write(&path, (48_000, 1), FULL_SCALE_MV, samples).expect("written");
        read(&path, &unit, FULL_SCALE_MV).expect("read")
    };
    let silence = write(&mut std::iter::repeat_n(0.0, 96_000));
    assert_eq!(
        (silence.sources.len(), silence.not_understood.len()),
        (0, 0)
    );
    let noise = write(&mut Noise::new(500.0, 0.0, 320.0, RATE, 5).take(960_000));
    assert_eq!(noise.sources, [], "20 s of noise");
    let direct = write(&mut std::iter::repeat_n(2_000.0, 96_000));
    assert_eq!(direct.sources, []);
    let square = write(&mut (0..96_000).map(|n| if n / 50 % 2 == 0 { 3_900.0 } else { -3_900.0 }));
    assert_eq!(square.sources, []);
    for reading in [direct, square] {
        let [unknown] = &reading.not_understood[..] else {
            panic!("{reading:?}");
        };
        assert!(
            unknown
                .why
                .to_string()
                .contains("no code of this unit configuration"),
            "{unknown:?}"
        );
    }
    // Cut off in the middle of a sample, and before the first.
    let bytes = std::fs::read(&path).expect("the file");
    std::fs::write(&path, &bytes[..bytes.len() / 2 + 1]).expect("cut");
    let cut = read(&path, &unit, FULL_SCALE_MV).expect("as far as it goes");
    let said = cut.not_understood.last().expect("said").why.to_string();
    assert!(said.contains("cut off or damaged"), "{said}");
    for text in [&b""[..], b"RIFF", b"not a recording", &bytes[..30]] {
        std::fs::write(&path, text).expect("written");
        let refused = read(&path, &unit, FULL_SCALE_MV).expect_err("no recording");
        assert!(
            refused.to_string().contains("x.wav"),
            "{}",
            refused.to_string()
        );
    }
}

/// The figures of `docs/dev/figures.md` on TWC: bit errors over Eb/N0 with known bit timing.
#[test]
#[ignore = "measures for minutes: cargo test --release -p ptu-runs figures_of_twc -- --ignored --nocapture"]
fn figures_of_twc() {
    let tones = TONES;
    let per_bit = RATE / f64::from(tones.bit_rate);
    for db in [4.0, 6.0, 8.0, 10.0, 12.0] {
        let mut random = protocol::Random::new(db as u64);
        let mut demodulator = Demodulator::new(tones, RATE as f32);
        let (bits, mut leans) = (1_000_000, Vec::new());
        let sent: Vec<bool> = (0..bits).map(|_| random.chance(0.5)).collect();
        let noise = Noise::new(500.0, db, f64::from(tones.bit_rate), RATE, db as u64 + 50);
        let wave = keyed(&sent, per_bit as usize, 500.0);
        for (signal, noise) in wave.zip(noise) {
            leans.extend(
                demodulator
                    .take((signal + noise) as f32)
                    .map(|bit| bit.lean),
            );
        }
        let per_bit = demodulator.values_per_bit(tones.bit_rate) as usize;
        // Filter and bit length delay a bit by a fixed number of values: found on the first thousand bits.
        let errors = |delay: usize, bits: std::ops::Range<usize>| {
            let wrong = |place: &usize| {
                let lean = leans.get(place * per_bit + delay);
                lean.is_some_and(|lean| (*lean > 0.0) != sent[*place])
            };
            bits.filter(wrong).count()
        };
        let delay = (0..3 * per_bit).min_by_key(|delay| errors(*delay, 0..1_000));
        let measured = errors(delay.unwrap_or(0), 1_000..bits) as f64 / (bits - 1_000) as f64;
        let theory = 0.5 * (-10f64.powf(db / 10.0) / 2.0).exp();
        let needs_db = 10.0 * (-2.0 * (2.0 * measured).ln()).log10();
        println!(
            "TWC {db} dB: {measured:.6} of the bits wrong, theory {theory:.6}; as theory at {needs_db:.2} dB"
        );
    }
}

/// Bits as two tones of one phase, mV.
fn keyed(bits: &[bool], per_bit: usize, level_mv: f64) -> impl Iterator<Item = f64> + '_ {
    let mut phase = 0.0f64;
    bits.iter()
        .flat_map(move |bit| std::iter::repeat_n(*bit, per_bit))
        .map(move |bit| {
            let tone = if bit { 9_800.0 } else { 9_500.0 };
            phase = (phase + tone / RATE).fract();
            level_mv * std::f64::consts::SQRT_2 * (std::f64::consts::TAU * phase).cos()
        })
}
