//! What is in a file of waveforms, as the unit's receivers hear it: which codes and bytes, from when to when.

use std::path::Path;

use protocol::config::UnitConfig;

use super::picture::Picture;
use super::reading::{MOST_CHANNELS, Reading};
use super::receive::Receivers;
use super::wav::{End, Wav};
use crate::failure::Failure;

/// Reads a WAV file for a unit of this configuration; full scale stands for `full_scale_mv`.
///
/// # Errors
/// The file cannot be read or is no WAV file.
pub fn read(path: &Path, unit: &UnitConfig, full_scale_mv: f64) -> Result<Reading, Failure> {
    Ok(whole(path, unit, full_scale_mv, false)?.0)
}

/// Reads a file as [`read`] does, and makes the pictures of its channels.
///
/// # Errors
/// The file cannot be read or is no WAV file.
pub fn read_and_picture(
    path: &Path,
    unit: &UnitConfig,
    full_scale_mv: f64,
) -> Result<(Reading, Vec<Picture>), Failure> {
    whole(path, unit, full_scale_mv, true)
}

/// Reads the file's next block while the receivers take the last one.
fn whole(
    path: &Path,
    unit: &UnitConfig,
    full_scale_mv: f64,
    pictures: bool,
) -> Result<(Reading, Vec<Picture>), Failure> {
    let mut wav = Wav::open(path)?;
    let mut receivers = Receivers::new(wav.channels(), wav.sample_hz().into(), unit, pictures);
    let frames = receivers.block();
    let mut block = wav.block(frames, MOST_CHANNELS, full_scale_mv);
    loop {
        let (samples, end) = block;
        let next = receivers.take_while(&samples, || {
            (end.is_none()).then(|| wav.block(frames, MOST_CHANNELS, full_scale_mv))
        });
        match (next, end) {
            (Some(next), _) => block = next,
            (None, end) => {
                let broken = match end {
                    Some(End::Broken(why)) => Some(why),
                    _ => None,
                };
                let (mut reading, pictures) = receivers.end(broken);
                reading.tell_clipped(&wav);
                return Ok((reading, pictures));
            }
        }
    }
}
