//! Makes a waveform and writes it to a file.

use std::path::Path;

use btu_rig::waveform::{CodeWave, FskWave, MarkerWave, Noise, Teeth, ToothedWheel};
use protocol::config::{SpeedCode, UnitConfig};

use super::{SAMPLE_HZ, wav};
use crate::failure::{Failure, SoundTrouble, Unknown};

/// Band that the noise beside a code is measured in, Hz: that of a receiver of codes.
const CODE_BAND_HZ: f64 = 320.0;
/// Band that the noise beside a marker is measured in, Hz: that of a receiver of markers.
const MARKER_BAND_HZ: f64 = 440.0;

/// What to make.
#[derive(Clone, Debug, PartialEq)]
pub enum Wave {
    /// A speed code of the unit configuration, by its name, for so long.
    Code {
        /// Name of the code, as `55`.
        name: String,
        /// Duration of the code, s.
        seconds: f64,
    },
    /// Bytes as TWC.
    Twc(Vec<u8>),
    /// A marker as a train passes it; the train is above the marker in the middle of the samples.
    Marker {
        /// 1 to 4 = PSM1 to PSM4.
        number: u8,
        /// Speed of the train, km/h.
        kmh: f64,
    },
}

/// What was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Made {
    /// Length, s.
    pub seconds: f64,
    /// Samples that were beyond full scale, and were cut off there.
    pub clipped: u64,
}

/// Most bytes that are made together.
const MOST_BYTES: usize = 2_048;

/// Bytes from pairs of hex digits, with or without blanks.
///
/// # Errors
/// The text has other characters than hex digits, an odd number of them, none or too many.
pub fn bytes_of(text: &str) -> Result<Vec<u8>, SoundTrouble> {
    let digits: Vec<u32> = (text.chars().filter(|letter| !letter.is_whitespace()))
        .map(|letter| letter.to_digit(16))
        .collect::<Option<_>>()
        .ok_or(SoundTrouble::NoBytes)?;
    if digits.is_empty() || digits.len() % 2 == 1 || digits.len() > 2 * MOST_BYTES {
        return Err(SoundTrouble::HowManyBytes(MOST_BYTES));
    }
    let pairs = digits.chunks_exact(2);
    Ok(pairs.map(|pair| (pair[0] << 4 | pair[1]) as u8).collect())
}

/// The tone of TWC between bytes, Hz.
pub fn rest_hz(unit: &UnitConfig) -> f64 {
    unit.twc.middle_hz + unit.twc.apart_hz
}

/// Frequencies by which the levels of codes and of TWC are measured, Hz.
pub fn reference_hz(unit: &UnitConfig) -> [f64; 2] {
    let carrier = unit.codes.first().map(|code| code.carrier_hz);
    [carrier.unwrap_or(1_000.0), unit.twc.middle_hz]
}

/// How strong a waveform is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// Level while it is on, mV rms.
    pub level_mv: f64,
    /// Level over white noise that is added, dB: of a code or marker in the receiver's band, of TWC in the bandwidth of a
    /// bit.
    pub snr_db: Option<f64>,
    /// Seed of the noise.
    pub seed: u64,
}

/// Samples, mV, that may be made on another thread.
pub type Samples = Box<dyn Iterator<Item = f64> + Send>;

/// The samples of a waveform, mV.
///
/// # Errors
/// There is no such code.
pub fn samples(wave: &Wave, unit: &UnitConfig, strength: Strength) -> Result<Samples, Failure> {
    let rate = f64::from(SAMPLE_HZ);
    let Strength {
        level_mv,
        snr_db,
        seed,
    } = strength;
    let (samples, band_hz): (Samples, f64) = match wave {
        Wave::Code { name, seconds } => {
            let SpeedCode {
                carrier_hz,
                rate_hz,
                ..
            } = code(unit, name)?;
            let wave = CodeWave::new(*carrier_hz, *rate_hz, level_mv, rate)
                .shifted(unit.receiver.shift_hz, rate);
            let count = (seconds * rate).round() as usize;
            (Box::new(wave.take(count)), CODE_BAND_HZ)
        }
        Wave::Twc(bytes) => {
            let twc = &unit.twc;
            let tones = (twc.middle_hz, twc.apart_hz);
            let wave = FskWave::new(bytes, tones, twc.bits_per_s, level_mv, rate);
            (Box::new(wave), twc.bits_per_s)
        }
        Wave::Marker { number, kmh } => {
            let marker = &unit.marker;
            let tone_hz = marker.tones_hz.get(usize::from(*number).wrapping_sub(1));
            let tone_hz = *tone_hz.ok_or_else(|| Failure::usage(SoundTrouble::NoMarker))?;
            let mut wave = MarkerWave::new(tone_hz, level_mv, marker.reach_m, rate);
            let (from_m, step_m) = (-2.0 * wave.heard_within_m(), kmh / 3.6 / rate);
            let count = (-2.0 * from_m / step_m) as usize;
            let samples =
                (0..count).map(move |n| wave.at(from_m + step_m * n as f64).unwrap_or(0.0));
            (Box::new(samples), MARKER_BAND_HZ)
        }
    };
    Ok(match snr_db {
        Some(snr_db) => {
            let noise = Noise::new(level_mv, snr_db, band_hz, rate, seed);
            Box::new(samples.zip(noise).map(|(sample, noise)| sample + noise))
        }
        None => samples,
    })
}

/// Writes a waveform to a WAV file.
///
/// # Errors
/// There is no such code, or the file cannot be written.
pub fn make(
    wave: &Wave,
    unit: &UnitConfig,
    strength: Strength,
    (path, full_scale_mv): (&Path, f64),
) -> Result<Made, Failure> {
    let mut count = 0u64;
    let counted = samples(wave, unit, strength)?.inspect(|_| count += 1);
    let clipped = wav::write(path, (SAMPLE_HZ, 1), full_scale_mv, counted)?;
    Ok(Made {
        seconds: count as f64 / f64::from(SAMPLE_HZ),
        clipped,
    })
}

/// Writes both lines of a speed sensor to a WAV file of two channels, so many seconds at a speed in km/h.
///
/// # Errors
/// The file cannot be written.
pub fn make_tacho(
    teeth: Teeth,
    (kmh, seconds): (f64, f64),
    unit: &UnitConfig,
    strength: Strength,
    (path, full_scale_mv): (&Path, f64),
) -> Result<Made, Failure> {
    let rate = f64::from(SAMPLE_HZ);
    let Strength {
        level_mv,
        snr_db,
        seed,
    } = strength;
    let per_s = kmh / 3.6 / unit.metres_per_pulse();
    let noise = |seed| snr_db.map(|db| Noise::new(level_mv, db, rate / 2.0, rate, seed));
    let mut noise = [noise(seed), noise(seed.wrapping_add(1))];
    let lines = ToothedWheel::new(teeth, per_s, level_mv, rate).take((seconds * rate) as usize);
    let samples = lines.flat_map(|lines| {
        let noisy = lines.into_iter().zip(&mut noise);
        let noisy =
            noisy.map(|(mv, noise)| mv + noise.as_mut().and_then(Iterator::next).unwrap_or(0.0));
        noisy.collect::<Vec<_>>()
    });
    let clipped = wav::write(path, (SAMPLE_HZ, 2), full_scale_mv, samples)?;
    Ok(Made { seconds, clipped })
}

fn code<'a>(unit: &'a UnitConfig, name: &str) -> Result<&'a SpeedCode, Failure> {
    let found = unit.codes.iter().find(|code| code.name == name);
    found.ok_or_else(|| {
        let names: Vec<_> = unit.codes.iter().map(|code| code.name.as_str()).collect();
        Failure::usage(Unknown::Code(name.to_owned(), names.join(", ")))
    })
}
