//! Makes a waveform and writes it to a file.

use std::path::Path;

use ato_under_test::receivers::Tones;
use btu_rig::waveform::{CodeWave, FskWave, Noise};
use protocol::config::{SpeedCode, UnitConfig};

use super::{SAMPLE_HZ, wav};
use crate::failure::Failure;

/// Band that the noise beside a code is measured in, Hz: that of a receiver of codes.
const CODE_BAND_HZ: f64 = 320.0;

/// What to make.
#[derive(Clone, Debug, PartialEq)]
pub enum Wave {
    /// A speed code of the unit configuration, by its name, for so long.
    Code {
        /// Its name, as `55`.
        name: String,
        /// How long, s.
        seconds: f64,
    },
    /// Bytes as TWC.
    Twc(Vec<u8>),
}

/// What was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Made {
    /// Length, s.
    pub seconds: f64,
    /// Samples that were beyond full scale, and were cut off there.
    pub clipped: u64,
}

/// Writes a waveform with `level_mv`, rms while it is on, to a WAV file; with `snr_db`, white noise is added: of a code in
/// the receiver's band, of TWC in the bandwidth of a bit.
///
/// # Errors
/// There is no such code, or the file cannot be written.
pub fn make(
    wave: &Wave,
    unit: &UnitConfig,
    (level_mv, snr_db, seed): (f64, Option<f64>, u64),
    (path, full_scale_mv): (&Path, f64),
) -> Result<Made, Failure> {
    let rate = f64::from(SAMPLE_HZ);
    let (samples, band_hz): (Box<dyn Iterator<Item = f64>>, f64) = match wave {
        Wave::Code { name, seconds } => {
            let SpeedCode {
                carrier_hz,
                rate_hz,
                ..
            } = code(unit, name)?;
            let wave = CodeWave::new(*carrier_hz, *rate_hz, level_mv, rate);
            let count = (seconds * rate).round() as usize;
            (Box::new(wave.take(count)), CODE_BAND_HZ)
        }
        Wave::Twc(bytes) => {
            let Tones {
                middle_hz,
                apart_hz,
                bit_rate,
            } = Tones::DEFAULT;
            let tones = (f64::from(middle_hz), f64::from(apart_hz));
            let wave = FskWave::new(bytes, tones, bit_rate.into(), level_mv, rate);
            (Box::new(wave), bit_rate.into())
        }
    };
    let mut count = 0u64;
    let mut noise = snr_db.map(|snr_db| Noise::new(level_mv, snr_db, band_hz, rate, seed));
    let noisy = samples.map(|sample| {
        count += 1;
        sample + noise.as_mut().and_then(Iterator::next).unwrap_or(0.0)
    });
    let clipped = wav::write(path, SAMPLE_HZ, full_scale_mv, noisy)?;
    Ok(Made {
        seconds: count as f64 / rate,
        clipped,
    })
}

fn code<'a>(unit: &'a UnitConfig, name: &str) -> Result<&'a SpeedCode, Failure> {
    let found = unit.codes.iter().find(|code| code.name == name);
    found.ok_or_else(|| {
        let names: Vec<_> = unit.codes.iter().map(|code| code.name.as_str()).collect();
        Failure::usage(format!(
            "the unit configuration has no code \"{name}\"; it has {}",
            names.join(", ")
        ))
    })
}
