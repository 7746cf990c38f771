//! WAV files: samples of any usual format, as mV.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use hound::{SampleFormat, WavSpec, WavWriter};

use super::wav_head::{self, Head};
use crate::failure::{Failure, FileTrouble};
use crate::new_file::{NewFile, cannot_write, kind};

/// Highest sample rate that is read, Hz.
const MOST_HZ: u32 = 768_000;

/// From this part of full scale on a sample is the greatest of its sign; so many in a row are a clipped wave.
const GREATEST: f64 = 0.9999;
const IN_A_ROW: u64 = 3;

/// Bytes that are read together, more than a frame of any number of channels.
const PIECE: usize = 1 << 20;

/// A file to read.
pub struct Wav {
    file: BufReader<File>,
    head: Head,
    /// Bytes that are still to come, as far as the file says.
    left: Option<u64>,
    shown: String,
    /// Samples at full scale of each channel: of the present row, and of all rows.
    clipped: Vec<[u64; 2]>,
}

/// Why there are no more samples.
pub enum End {
    /// The file is read.
    Whole,
    /// The file is cut off, or damaged from here on.
    Broken(String),
}

impl Wav {
    /// Opens a file.
    ///
    /// # Errors
    /// The file cannot be read, or is no WAV file that can be understood.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let shown = path.display().to_string();
        let file = fault_db::open_regular_file(path)
            .map_err(|error| Failure::bench(FileTrouble::unread(path, error)))?;
        let mut file = BufReader::new(file);
        let head = wav_head::read(&mut file)
            .map_err(|why| Failure::usage(FileTrouble::NoWav(shown.clone(), why.to_string())))?;
        if !(1..=MOST_HZ).contains(&head.sample_hz) {
            return Err(Failure::usage(FileTrouble::NoSamples(
                shown,
                head.channels,
                head.sample_hz,
            )));
        }
        Ok(Self {
            file,
            head,
            left: head.length,
            shown,
            clipped: Vec::new(),
        })
    }

    /// Channels, counted from 1, whose signal was clipped, and how many samples of each.
    pub fn clipped(&self) -> impl Iterator<Item = (usize, u64)> {
        let numbered = (1..).zip(&self.clipped);
        numbered.filter_map(|(channel, [_, all])| (*all > 0).then_some((channel, *all)))
    }

    /// Rate of its samples, Hz.
    pub fn sample_hz(&self) -> u32 {
        self.head.sample_hz
    }

    /// Number of channels.
    pub fn channels(&self) -> usize {
        usize::from(self.head.channels)
    }

    /// The next samples, mV, of the first `most` channels, `frames` of each or fewer at the end, and why there are no
    /// more. A sample that is no finite number is silence.
    pub fn block(
        &mut self,
        frames: usize,
        most: usize,
        full_scale_mv: f64,
    ) -> (Vec<Vec<f32>>, Option<End>) {
        let (channels, bytes) = (self.channels(), self.head.bytes);
        let frame = channels * bytes;
        let at_once = PIECE / frame * frame;
        let wanted = frames as u64 * frame as u64;
        let allowed = self.left.map_or(wanted, |left| left.min(wanted));
        let mut block = vec![Vec::new(); channels.min(most)];
        self.clipped.resize(block.len(), [0; 2]);
        let (mut got, mut read, mut failed) = (0, Vec::new(), None);
        while got < allowed && failed.is_none() {
            read.clear();
            let piece = (allowed - got).min(at_once as u64);
            let result = (&mut self.file).take(piece).read_to_end(&mut read);
            failed = result.err().map(|error| error.to_string());
            got += read.len() as u64;
            // A frame that is cut off in its middle is none.
            for frame in read.chunks_exact(frame) {
                let slots = block.iter_mut().zip(&mut self.clipped);
                for (sample, (channel, [row, all])) in frame.chunks_exact(bytes).zip(slots) {
                    let sample = self.head.sample(sample);
                    *row = if sample.abs() < GREATEST { 0 } else { *row + 1 };
                    *all += if *row == IN_A_ROW {
                        *row
                    } else {
                        u64::from(*row > IN_A_ROW)
                    };
                    let mv = sample * full_scale_mv;
                    channel.push(if mv.is_finite() { mv as f32 } else { 0.0 });
                }
            }
            if (read.len() as u64) < piece {
                break;
            }
        }
        if got < allowed && self.left.is_some() {
            failed.get_or_insert("it ends before all samples that its head tells of".to_owned());
        }
        let end = match failed {
            Some(what) => Some(End::Broken(format!("{}: {what}", self.shown))),
            None => (got < wanted).then_some(End::Whole),
        };
        self.left = self.left.map(|left| left - got);
        (block, end)
    }
}

/// A part of full scale as a sample of 16 bits, and whether the part was beyond full scale and is cut off there.
pub(crate) fn sample_of_16_bits(part: f64) -> (i16, bool) {
    let sample = (part * 32_768.0).round();
    // A conversion to an integer ends at the greatest of its sign.
    let kept = sample as i16;
    (kept, f64::from(kept) != sample)
}

/// Writes samples, mV, of so many channels by turns, as 16 bits. Counts those beyond full scale, which are cut off
/// there.
///
/// # Errors
/// The file cannot be written.
pub fn write(
    path: &Path,
    (sample_hz, channels): (u32, u16),
    full_scale_mv: f64,
    samples: impl Iterator<Item = f64>,
) -> Result<u64, Failure> {
    let failed = |error: hound::Error| cannot_write(path, &error);
    let spec = WavSpec {
        channels,
        sample_rate: sample_hz,
        bits_per_sample: 16,
        sample_format: SampleFormat::Int,
    };
    let file = NewFile::begin(path, kind::WAV)?;
    let mut writer = WavWriter::new(file.writer()?, spec).map_err(failed)?;
    let mut clipped = 0;
    for sample in samples {
        let (kept, is_clipped) = sample_of_16_bits(sample / full_scale_mv);
        clipped += u64::from(is_clipped);
        writer.write_sample(kept).map_err(failed)?;
    }
    writer.finalize().map_err(failed)?;
    file.finish()?;
    Ok(clipped)
}

#[cfg(test)]
mod tests;
