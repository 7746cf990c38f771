//! WAV files: samples of any usual format, as mV.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use hound::{SampleFormat, WavReader, WavSpec, WavWriter};

use crate::failure::Failure;
use crate::new_file::{NewFile, kind};

/// Highest sample rate that is read, Hz.
const MOST_HZ: u32 = 768_000;

/// A file to read.
pub struct Wav {
    reader: WavReader<BufReader<File>>,
    shown: String,
}

/// Why there are no more samples.
pub enum End {
    /// The file is read.
    Whole,
    /// It is cut off, or damaged from here on.
    Broken(String),
}

impl Wav {
    /// Opens a file.
    ///
    /// # Errors
    /// It cannot be read, or is no WAV file that can be understood.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let shown = path.display().to_string();
        let failed = |error: hound::Error| match error {
            hound::Error::IoError(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => {
                Failure::bench(format!("cannot read {shown}: {error}"))
            }
            error => Failure::usage(format!(
                "{shown} is no WAV file that can be read ({error}); give a file of PCM or floating-point samples"
            )),
        };
        let file = fault_db::open_regular_file(path)
            .map_err(|error| Failure::bench(format!("cannot read {shown}: {error}")))?;
        let reader = WavReader::new(BufReader::new(file)).map_err(failed)?;
        let spec = reader.spec();
        if spec.channels == 0 || !(1..=MOST_HZ).contains(&spec.sample_rate) {
            return Err(Failure::usage(format!(
                "{shown} has {} channels at {} Hz: nothing that can be read",
                spec.channels, spec.sample_rate
            )));
        }
        Ok(Self { reader, shown })
    }

    /// Rate of its samples, Hz.
    pub fn sample_hz(&self) -> u32 {
        self.reader.spec().sample_rate
    }

    /// Number of channels.
    pub fn channels(&self) -> usize {
        usize::from(self.reader.spec().channels)
    }

    /// The next samples, mV, of its first `most` channels, `frames` of each or less at its end, and why there are no more.
    /// What is no number is silence.
    pub fn block(
        &mut self,
        frames: usize,
        most: usize,
        full_scale_mv: f64,
    ) -> (Vec<Vec<f32>>, Option<End>) {
        let WavSpec {
            channels,
            bits_per_sample,
            sample_format,
            ..
        } = self.reader.spec();
        let channels = usize::from(channels);
        let mut block = vec![Vec::new(); channels.min(most)];
        let (mut place, mut passed) = (0, 0);
        let mut pass = |sample: f64| {
            if let Some(channel) = block.get_mut(place) {
                let mv = sample * full_scale_mv;
                channel.push(if mv.is_finite() { mv as f32 } else { 0.0 });
            }
            place = (place + 1) % channels;
            passed += 1;
        };
        let wanted = frames * channels;
        let read: hound::Result<()> = match sample_format {
            SampleFormat::Float => (self.reader.samples::<f32>().take(wanted))
                .try_for_each(|sample| sample.map(|sample| pass(f64::from(sample)))),
            SampleFormat::Int => {
                let full = 2f64.powi(i32::from(bits_per_sample) - 1);
                (self.reader.samples::<i32>().take(wanted))
                    .try_for_each(|sample| sample.map(|sample| pass(f64::from(sample) / full)))
            }
        };
        // A frame that is cut off in its middle is none.
        let whole = block.last().map_or(0, Vec::len);
        block.iter_mut().for_each(|channel| channel.truncate(whole));
        let end = match read {
            Ok(()) if passed < wanted => Some(End::Whole),
            Ok(()) => None,
            Err(error) => Some(End::Broken(format!("{}: {error}", self.shown))),
        };
        (block, end)
    }
}

/// Writes samples, mV, as 16 bits; how many were beyond full scale and are cut off there.
///
/// # Errors
/// The file cannot be written.
pub fn write(
    path: &Path,
    sample_hz: u32,
    full_scale_mv: f64,
    samples: impl Iterator<Item = f64>,
) -> Result<u64, Failure> {
    let failed =
        |error: hound::Error| Failure::bench(format!("cannot write {}: {error}", path.display()));
    let spec = WavSpec {
        channels: 1,
        sample_rate: sample_hz,
        bits_per_sample: 16,
        sample_format: SampleFormat::Int,
    };
    let file = NewFile::begin(path, kind::WAV)?;
    let mut writer = WavWriter::new(file.writer()?, spec).map_err(failed)?;
    let mut clipped = 0;
    for sample in samples {
        let sample = (sample / full_scale_mv * 32_768.0).round();
        let kept = sample.clamp(-32_768.0, 32_767.0);
        clipped += u64::from(sample != kept);
        writer.write_sample(kept as i16).map_err(failed)?;
    }
    writer.finalize().map_err(failed)?;
    file.finish()?;
    Ok(clipped)
}
