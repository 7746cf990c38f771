//! Records waveforms.

use std::io::Read;
use std::path::Path;
use std::sync::atomic::Ordering;

use hound::{SampleFormat, WavSpec, WavWriter};

use super::carried::Carried;
use super::{CHANNELS, Direction, SAMPLE_HZ, programs};
use crate::failure::Failure;
use crate::new_file::{NewFile, cannot_write, kind};
use crate::signal::FULL_SCALE_MV;
use crate::stop::Stop;

/// Samples that are taken together, for each channel: 20 ms.
const TOGETHER: usize = 960;
/// Longest recording, s: a WAV file holds no more.
pub const MOST_RECORDED_S: f64 = 3.0 * 3_600.0;

/// Gets the samples of each channel, mV, block by block; its failure ends the recording.
pub type Take<'a> = dyn FnMut(&[Vec<f32>]) -> Result<(), Failure> + 'a;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Recorded {
    /// For how long, s.
    pub seconds: f64,
    /// Samples at the end of the device's range, of each channel: it was too loud.
    pub clipped: [u64; CHANNELS],
    /// Times that samples were lost.
    pub overruns: u64,
}

/// Records samples, mV of each channel, for a time or until `stop` is pressed; `full_scale_mv` says what the greatest
/// sample of the device stands for. `take` gets the samples block by block.
///
/// # Errors
/// Nothing here carries sound, the device cannot be recorded from, or `take` fails.
pub fn record(
    (device, full_scale_mv): (&str, [f64; CHANNELS]),
    seconds: Option<f64>,
    stop: &Stop,
    take: &mut Take<'_>,
) -> Result<Recorded, Failure> {
    let mut command = programs::carrier(Direction::Input, device)?;
    let mut carried = Carried::start(&mut command, false, stop)?;
    let most =
        (seconds.unwrap_or(MOST_RECORDED_S).min(MOST_RECORDED_S) * f64::from(SAMPLE_HZ)) as u64;
    let mut recorded = Recorded::default();
    let mut count = 0u64;
    let mut bytes = vec![0; TOGETHER * CHANNELS * 2];
    while count < most && stop.presses() == 0 {
        let together = TOGETHER.min((most - count) as usize);
        let bytes = &mut bytes[..together * CHANNELS * 2];
        let read = carried
            .output
            .as_mut()
            .map(|output| output.read_exact(bytes));
        if !matches!(read, Some(Ok(()))) {
            if stop.presses() > 0 {
                break;
            }
            return Err(carried.failed("record from", device));
        }
        let mut block = vec![Vec::new(); CHANNELS];
        for (place, sample) in bytes.chunks_exact(2).enumerate() {
            let channel = place % CHANNELS;
            let sample = i16::from_le_bytes([sample[0], sample[1]]);
            recorded.clipped[channel] += u64::from(matches!(sample, i16::MIN | i16::MAX));
            let mv = f64::from(sample) / 32_768.0 * full_scale_mv[channel];
            block[channel].push(mv as f32);
        }
        take(&block)?;
        count += together as u64;
    }
    recorded.overruns = carried.gaps.load(Ordering::Relaxed);
    recorded.seconds = count as f64 / f64::from(SAMPLE_HZ);
    Ok(recorded)
}

/// Records to a WAV file, whose full scale stands for the usual level; `heard` gets the samples, too. What was recorded
/// is in the file even if this program is killed, but for the last second; a file that was there stays until a second is
/// recorded.
///
/// # Errors
/// As [`record`], or the file cannot be written.
pub fn record_to_file(
    path: &Path,
    device: (&str, [f64; CHANNELS]),
    seconds: Option<f64>,
    stop: &Stop,
    heard: &mut dyn FnMut(&[Vec<f32>]),
) -> Result<Recorded, Failure> {
    let failed = |error: hound::Error| cannot_write(path, &error);
    // Floating point: cards of any sensitivity fit, and nothing is rounded twice.
    let spec = WavSpec {
        channels: CHANNELS as u16,
        sample_rate: SAMPLE_HZ,
        bits_per_sample: 32,
        sample_format: SampleFormat::Float,
    };
    let mut file = NewFile::begin(path, kind::WAV)?;
    let mut writer = WavWriter::new(file.writer()?, spec).map_err(failed)?;
    let mut unsaved = 0;
    let recorded = record(device, seconds, stop, &mut |block| {
        let [atp, twc] = block else { return Ok(()) };
        for pair in atp.iter().zip(twc) {
            for sample in [pair.0, pair.1] {
                let sample = f64::from(*sample) / FULL_SCALE_MV;
                writer.write_sample(sample as f32).map_err(failed)?;
            }
        }
        unsaved += atp.len();
        if unsaved >= SAMPLE_HZ as usize {
            writer.flush().map_err(failed)?;
            file.appear()?;
            unsaved = 0;
        }
        heard(block);
        Ok(())
    });
    writer.finalize().map_err(failed)?;
    let recorded = recorded?;
    file.finish()?;
    Ok(recorded)
}
