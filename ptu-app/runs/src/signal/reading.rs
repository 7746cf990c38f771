//! What is heard in a recording, and when: the receivers of all signals answer in these types.

use std::fmt;

use serde::{Serialize, Serializer};

use super::meter::Meter;
use super::wav::Wav;

/// Time between two askings of the receivers of codes, s: their answers are most of their work.
pub(super) const ASKED_EVERY_S: f64 = 0.1;
/// Most entries of each kind in an answer.
pub(super) const MOST: usize = 100_000;
/// Channels of a recording that are read at most.
pub const MOST_CHANNELS: usize = 8;

/// Times of the samples of a block.
#[derive(Clone, Copy)]
pub(super) struct Clock {
    /// Samples before the block.
    pub(super) before: u64,
    pub(super) sample_hz: f64,
    pub(super) asked_every: usize,
}

impl Clock {
    /// When the sample of this place is over, s.
    pub(super) fn at_s(self, place: usize) -> f64 {
        (self.before + place as u64 + 1) as f64 / self.sample_hz
    }
}

/// Signals that were found in a file of a recording, and how loud its channels are.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Reading {
    /// Length, s.
    pub duration_s: f64,
    /// Level of each channel, whatever signals it holds.
    pub levels: Vec<Level>,
    /// Signals, in order of their beginning.
    pub sources: Vec<Source>,
    /// Parts of the recording that no receiver understood or that could not be read, each with the reason.
    pub not_understood: Vec<NotUnderstood>,
}

/// How loud a channel is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Level {
    /// Channel of the file, from 1.
    pub channel: usize,
    /// Level of the whole channel, mV rms.
    pub level_mv: f64,
    /// The greatest level for 0.1 s, mV rms.
    pub most_mv: f64,
    /// Frequency of the strongest line, Hz; `None` for silence, and for fewer samples than a spectrum takes.
    pub strongest_hz: Option<f64>,
    /// Mean level of the strongest line, mV rms.
    pub strongest_mv: Option<f64>,
}

impl Level {
    pub(super) fn of(meter: &Meter, channel: usize) -> Self {
        let (level_mv, most_mv) = meter.levels_mv();
        let strongest = meter.spectrum.strongest();
        Self {
            channel,
            level_mv,
            most_mv,
            strongest_hz: strongest.map(|of| of.0),
            strongest_mv: strongest.map(|of| of.1),
        }
    }
}

/// A signal that was found, from its beginning to its end.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
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
    /// Bytes of TWC with a wrong parity or without a stop bit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bad_bytes: Option<u32>,
    /// Wheel and sensor, as the lines of a speed sensor tell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tacho: Option<Tacho>,
}

/// What the two lines of a speed sensor tell.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Tacho {
    /// Pulses forward.
    pub forward: u64,
    /// Pulses backward.
    pub backward: u64,
    /// Mean speed between the first pulse and the last, km/h.
    pub mean_kmh: f64,
    /// Slowest and fastest of all periods, without the gaps, km/h.
    pub kmh: [f64; 2],
    /// Line B behind line A, degrees of a period.
    pub phase_deg: f64,
    /// Share of the time for which line A and line B are high, %.
    pub duty_percent: [f64; 2],
    /// Teeth that the wheel lacks, each counted once, in however many turns.
    pub missing_teeth: u64,
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
    /// The lines from this channel on change as the lines of no speed sensor do.
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
                MOST_CHANNELS
            ),
            Self::Broken(why) => write!(out, "the file is cut off or damaged from here on ({why})"),
        }
    }
}

fn in_words<S: Serializer>(why: &Why, to: S) -> Result<S::Ok, S::Error> {
    to.collect_str(why)
}

impl Reading {
    /// Tells why the file is not understood at this time.
    pub(super) fn tell(&mut self, at_s: f64, why: Why) {
        let (from_s, to_s) = (at_s, at_s);
        self.not_understood
            .push(NotUnderstood { from_s, to_s, why });
    }

    /// Tells which channels of a file that was read are clipped.
    pub(super) fn tell_clipped(&mut self, wav: &Wav) {
        for (channel, samples) in wav.clipped() {
            self.tell(0.0, Why::Clipped { channel, samples });
        }
    }
}
