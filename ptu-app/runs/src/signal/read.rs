//! What is in a file of waveforms, as the unit's receivers hear it: which codes and bytes, from when to when.

use std::fmt;
use std::path::Path;

use protocol::config::UnitConfig;
use serde::{Serialize, Serializer};

use super::meter::Meter;
use super::picture::Picture;
use super::receive::Receivers;
use super::tacho::Tacho;
use super::wav::{End, Wav};
use crate::failure::Failure;

/// What is in a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Reading {
    /// Length, s.
    pub duration_s: f64,
    /// How loud each channel is, whatever is in it.
    pub levels: Vec<Level>,
    /// Signals, in order of their beginning.
    pub sources: Vec<Source>,
    /// What is in it and was not understood.
    pub not_understood: Vec<NotUnderstood>,
}

/// How loud a channel is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Level {
    /// Channel of the file, from 1.
    pub channel: usize,
    /// Level of the whole, mV rms.
    pub level_mv: f64,
    /// The greatest level for 0.1 s, mV rms.
    pub most_mv: f64,
    /// The strongest line, Hz; none of silence and of less than a spectrum.
    pub strongest_hz: Option<f64>,
    /// Its mean level, mV rms.
    pub strongest_mv: Option<f64>,
}

impl Level {
    pub(super) fn of(meter: &Meter, channel: usize) -> Self {
        let (level_mv, most_mv) = meter.levels_mv();
        let strongest = meter.strongest();
        Self {
            channel,
            level_mv,
            most_mv,
            strongest_hz: strongest.map(|of| of.0),
            strongest_mv: strongest.map(|of| of.1),
        }
    }
}

/// A signal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Source {
    /// `code`, `twc`, `marker` or `tacho`.
    pub kind: &'static str,
    /// Channel of the file, from 1.
    pub channel: usize,
    /// Beginning, s.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// Name of the code, empty for one that the unit configuration does not have; of TWC its bytes in hex.
    pub what: String,
    /// Carrier, Hz; of TWC the middle of the tones.
    pub carrier_hz: f64,
    /// Code rate or bit rate, Hz.
    pub rate_hz: f64,
    /// Level, mV rms; of TWC not measured.
    pub level_mv: Option<f64>,
    /// Level over the noise in the receiver's band, dB, if it is known.
    pub snr_db: Option<f64>,
    /// Of TWC: bytes with a wrong parity or without a stop bit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bad_bytes: Option<u32>,
    /// Of a speed sensor: what its lines tell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tacho: Option<Tacho>,
}

/// A part of a file that no receiver understood.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NotUnderstood {
    /// Beginning, s.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// Why, as far as can be said.
    #[serde(rename = "what", serialize_with = "in_words")]
    pub why: Why,
}

/// Why a part of a file was not understood.
#[derive(Clone, Debug, PartialEq)]
pub enum Why {
    /// So many samples a second are too few for these frequencies, Hz.
    Slow {
        /// Samples a second.
        sample_hz: f64,
        /// Highest frequencies that are missed.
        for_hz: Vec<f64>,
    },
    /// The channel has so much, mV rms, and it is no code of the unit configuration and no TWC.
    Unknown {
        /// Number of the channel, from 1.
        channel: usize,
        /// How loud, mV rms.
        level_mv: f64,
    },
    /// A speed sensor has two lines, and the file has one channel.
    OneLine,
    /// The lines from this channel on change as those of no speed sensor do.
    NoSensor(usize),
    /// So many samples of the channel are as great as the file holds: the signal is clipped.
    Clipped {
        /// Number of the channel, from 1.
        channel: usize,
        /// How many.
        samples: u64,
    },
    /// The file has so many channels, and only the first are read.
    Channels(usize),
    /// The file is cut off or damaged, with the reader's words.
    Broken(String),
}

impl fmt::Display for Why {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Slow { sample_hz, for_hz } => {
                let of: Vec<_> = for_hz.iter().map(f64::to_string).collect();
                let of = of.join(" and ");
                write!(
                    out,
                    "{sample_hz} samples a second are too few for {of} Hz; record with 48 000"
                )
            }
            Self::Unknown { channel, level_mv } => write!(
                out,
                "channel {channel}: {level_mv:.0} mV rms that are no code of this unit configuration and no TWC"
            ),
            Self::OneLine => write!(out, "one channel: a speed sensor has two lines"),
            Self::NoSensor(channel) => write!(
                out,
                "channel {channel}: noise, or no speed sensor: its pulses come too unevenly for a wheel"
            ),
            Self::Clipped { channel, samples } => write!(
                out,
                "channel {channel}: clipped, {samples} samples are as great as the file holds; record with less gain"
            ),
            Self::Channels(of) => write!(
                out,
                "{of} channels: only the first {} are read",
                Receivers::MOST_CHANNELS
            ),
            Self::Broken(why) => write!(out, "the file is cut off or damaged from here on ({why})"),
        }
    }
}

fn in_words<S: Serializer>(why: &Why, to: S) -> Result<S::Ok, S::Error> {
    to.collect_str(why)
}

impl Reading {
    /// Something is not understood at this time.
    pub(super) fn tell(&mut self, at_s: f64, why: Why) {
        self.not_understood.push(NotUnderstood {
            from_s: at_s,
            to_s: at_s,
            why,
        });
    }

    /// Tells which channels of a file that was read are clipped.
    pub(super) fn tell_clipped(&mut self, wav: &Wav) {
        for (channel, samples) in wav.clipped() {
            self.tell(0.0, Why::Clipped { channel, samples });
        }
    }
}

/// Reads a WAV file for a unit of this configuration; full scale stands for `full_scale_mv`.
///
/// # Errors
/// It cannot be read or is no WAV file.
pub fn read(path: &Path, unit: &UnitConfig, full_scale_mv: f64) -> Result<Reading, Failure> {
    let wav = Wav::open(path)?;
    let receivers = Receivers::new(wav.channels(), wav.sample_hz().into(), unit, false);
    whole(wav, receivers, full_scale_mv).map(|(reading, _)| reading)
}

/// Reads a file as [`read`] does, and makes what a person looks at.
///
/// # Errors
/// It cannot be read or is no WAV file.
pub fn read_and_picture(
    path: &Path,
    unit: &UnitConfig,
    full_scale_mv: f64,
) -> Result<(Reading, Vec<Picture>), Failure> {
    let wav = Wav::open(path)?;
    let receivers = Receivers::new(wav.channels(), wav.sample_hz().into(), unit, true);
    whole(wav, receivers, full_scale_mv)
}

/// The file's next block is read while the receivers take the last one.
fn whole(
    mut wav: Wav,
    mut receivers: Receivers<'_>,
    full_scale_mv: f64,
) -> Result<(Reading, Vec<Picture>), Failure> {
    let frames = receivers.block();
    let mut block = wav.block(frames, Receivers::MOST_CHANNELS, full_scale_mv);
    loop {
        let (samples, end) = block;
        let next = receivers.take_while(&samples, || {
            (end.is_none()).then(|| wav.block(frames, Receivers::MOST_CHANNELS, full_scale_mv))
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
