//! Plays waveforms.

use std::io::Write;
use std::sync::atomic::Ordering;

use super::carried::Carried;
use super::{CHANNELS, Direction, SAMPLE_HZ, Side, programs};
use protocol::config::UnitConfig;

use crate::failure::Failure;
use crate::signal::{rest_hz, sample_of_16_bits};
use crate::stop::Stop;

/// Level at the beginning, dB below what is asked for, and the time until it is reached, s.
const BEGINS_DB: f64 = -20.0;
const RISES_IN_S: f64 = 0.5;
/// Samples that are written together, for each channel: 10 ms.
const TOGETHER: usize = 480;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Played {
    /// For how long, s.
    pub seconds: f64,
    /// Samples beyond what the device can make, cut off there.
    pub clipped: u64,
    /// Times that the device had no samples in time.
    pub underruns: u64,
    /// Somebody stopped it.
    pub stopped: bool,
}

/// What is played while the level rises.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lead {
    /// The waveform from its beginning.
    Within,
    /// Tones of these frequencies, Hz, and levels, mV rms, before the waveform, so that its beginning is not weak.
    Before([(u32, u32); CHANNELS]),
}

impl Lead {
    /// The rest of TWC before its first byte.
    pub fn of_twc(unit: &UnitConfig, level_mv: f64) -> Self {
        let hz = rest_hz(unit) as u32;
        Self::Before(Side::ALL.map(|side| match side {
            Side::Atp => (hz, 0),
            Side::Twc => (hz, level_mv as u32),
        }))
    }
}

/// Plays samples, mV of each channel, until there are no more or `stop` is pressed; `full_scale_mv` says what the
/// device makes of the greatest sample. The sound begins 20 dB below its level and reaches it in half a second.
///
/// # Errors
/// Nothing here carries sound, or the device cannot be played on.
pub fn play(
    samples: impl Iterator<Item = [f64; CHANNELS]>,
    lead: Lead,
    (device, full_scale_mv): (&str, [f64; CHANNELS]),
    stop: &Stop,
) -> Result<Played, Failure> {
    let mut command = programs::carrier(Direction::Output, device)?;
    let mut carried = Carried::start(&mut command, true, stop)?;
    let rise = (RISES_IN_S * f64::from(SAMPLE_HZ)) as u64;
    let before = match lead {
        Lead::Within => 0,
        Lead::Before(_) => rise,
    };
    let tone = move |at: u64| match lead {
        Lead::Within => [0.0; CHANNELS],
        Lead::Before(tones) => tones.map(|(hz, level_mv)| {
            let turns = at as f64 * f64::from(hz) / f64::from(SAMPLE_HZ);
            f64::from(level_mv)
                * std::f64::consts::SQRT_2
                * (std::f64::consts::TAU * turns.fract()).cos()
        }),
    };
    let mut samples = (0..before).map(tone).chain(samples);
    let mut played = Played::default();
    let mut count = 0u64;
    let mut bytes = Vec::with_capacity(TOGETHER * CHANNELS * 2);
    loop {
        bytes.clear();
        for together in samples.by_ref().take(TOGETHER) {
            let below = (1.0 - count as f64 / rise as f64).max(0.0) * BEGINS_DB;
            let gain = 10f64.powf(below / 20.0);
            for (mv, full) in together.iter().zip(full_scale_mv) {
                let (kept, is_clipped) = sample_of_16_bits(gain * mv / full);
                played.clipped += u64::from(is_clipped);
                bytes.extend(kept.to_le_bytes());
            }
            count += 1;
        }
        if bytes.is_empty() || stop.presses() > 0 {
            break;
        }
        let written = carried.input.as_mut().map(|input| input.write_all(&bytes));
        if !matches!(written, Some(Ok(()))) && stop.presses() == 0 {
            return Err(carried.failed("play on", device));
        }
    }
    played.underruns = carried.gaps.load(Ordering::Relaxed);
    played.seconds = count as f64 / f64::from(SAMPLE_HZ);
    carried.wait();
    played.stopped = stop.presses() > 0;
    Ok(played)
}
