//! Reads a file of waveforms with the unit's receivers: which codes and bytes are in it, from when to when.

use std::path::Path;

use ato_under_test::receivers::{CodeReceiver, FskReceiver, Heard, Received, Reception, Tones};
use protocol::config::{SpeedCode, UnitConfig};
use serde::Serialize;

use super::wav::{End, Wav};
use crate::failure::Failure;

/// How often the receivers of codes are asked, s.
const ASKED_EVERY_S: f64 = 0.05;
/// A code that is not heard for so long has ended, s.
const ENDS_AFTER_S: f64 = 0.3;
/// Bytes of TWC that are farther apart are two messages, s.
const APART_S: f64 = 0.2;
/// What is louder than the weakest level that is decoded, and understood by no receiver, is told from this length on, s.
const LEAST_UNKNOWN_S: f64 = 1.0;
/// Least sample rate, times the highest frequency of a signal.
const LEAST_RATE: f64 = 2.2;
/// Most entries of each kind in an answer.
const MOST: usize = 100_000;

/// What is in a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Reading {
    /// Length, s.
    pub duration_s: f64,
    /// Signals, in order of their beginning.
    pub sources: Vec<Source>,
    /// What is in it and was not understood.
    pub not_understood: Vec<NotUnderstood>,
}

/// A signal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Source {
    /// `code` or `twc`.
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
}

/// A part of a file that no receiver understood.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NotUnderstood {
    /// Beginning, s.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// What it is as far as can be said.
    pub what: String,
}

/// Reads a WAV file for a unit of this configuration; full scale stands for `full_scale_mv`.
///
/// # Errors
/// It cannot be read or is no WAV file.
pub fn read(path: &Path, unit: &UnitConfig, full_scale_mv: f64) -> Result<Reading, Failure> {
    let wav = Wav::open(path)?;
    let sample_hz = f64::from(wav.sample_hz());
    let mut reading = Reading::default();
    let mut channels: Vec<_> = (0..wav.channels())
        .map(|place| Channel::new(place + 1, unit, sample_hz, &mut reading))
        .collect();
    let mut samples = 0u64;
    let end = wav.each(full_scale_mv, |together| {
        samples += 1;
        for (channel, sample) in channels.iter_mut().zip(together) {
            channel.take(*sample, samples as f64 / sample_hz);
        }
    });
    reading.duration_s = samples as f64 / sample_hz;
    for channel in channels {
        channel.end(reading.duration_s, &mut reading);
    }
    if let End::Broken(why) = end {
        reading.not_understood.push(NotUnderstood {
            from_s: reading.duration_s,
            to_s: reading.duration_s,
            what: format!("the file is cut off or damaged from here on ({why})"),
        });
    }
    let by_time = |a: f64, b: f64| a.total_cmp(&b);
    (reading.sources).sort_by(|a, b| by_time(a.from_s, b.from_s).then(a.channel.cmp(&b.channel)));
    (reading.not_understood).sort_by(|a, b| by_time(a.from_s, b.from_s));
    Ok(reading)
}

/// One channel of a file with its receivers.
struct Channel<'a> {
    number: usize,
    unit: &'a UnitConfig,
    codes: Vec<Carrier<'a>>,
    twc: Option<Twc>,
    asked_s: f64,
    loud: Loud,
    done: Vec<Source>,
}

impl<'a> Channel<'a> {
    fn new(number: usize, unit: &'a UnitConfig, sample_hz: f64, reading: &mut Reading) -> Self {
        let mut codes: Vec<Carrier<'_>> = Vec::new();
        let mut too_high = Vec::new();
        for code in &unit.codes {
            if let Some(known) = codes.iter_mut().find(|of| of.carrier_hz == code.carrier_hz) {
                known.codes.push(code);
                known.rates_hz.push(code.rate_hz as f32);
            } else if sample_hz >= LEAST_RATE * code.carrier_hz {
                codes.push(Carrier::new(code, unit, sample_hz));
            } else {
                too_high.push(format!("the carrier of {} Hz", code.carrier_hz));
            }
        }
        let tones = Tones::DEFAULT;
        let highest = f64::from(tones.middle_hz + tones.apart_hz);
        let twc = (sample_hz >= LEAST_RATE * highest).then(|| Twc::new(unit, sample_hz));
        if twc.is_none() {
            too_high.push(format!("TWC at {highest} Hz"));
        }
        if number == 1 && !too_high.is_empty() {
            reading.not_understood.push(NotUnderstood {
                from_s: 0.0,
                to_s: 0.0,
                what: format!(
                    "{sample_hz} samples a second are too few for {}; record with 48 000",
                    too_high.join(" and ")
                ),
            });
        }
        Self {
            number,
            unit,
            codes,
            twc,
            asked_s: 0.0,
            loud: Loud::default(),
            done: Vec::new(),
        }
    }

    fn take(&mut self, sample_mv: f32, at_s: f64) {
        self.loud.square += f64::from(sample_mv) * f64::from(sample_mv);
        self.loud.samples += 1;
        for carrier in &mut self.codes {
            carrier.receiver.take(sample_mv);
        }
        if let Some(twc) = &mut self.twc {
            twc.take(sample_mv, at_s, self.number, &mut self.done);
        }
        if at_s - self.asked_s < ASKED_EVERY_S {
            return;
        }
        self.asked_s = at_s;
        let mut is_understood = self.twc.as_ref().is_some_and(|twc| twc.is_in_message(at_s));
        for carrier in &mut self.codes {
            is_understood |= carrier.ask(self.unit, at_s, self.number, &mut self.done);
        }
        let level_min = self.unit.receiver.level_min_mv;
        self.loud.ask(is_understood, at_s, level_min);
    }

    fn end(mut self, at_s: f64, reading: &mut Reading) {
        for carrier in &mut self.codes {
            self.done.extend(carrier.under_way.take());
        }
        if let Some(twc) = self.twc.as_mut() {
            self.done.extend(twc.under_way.take());
        }
        self.loud.close(at_s);
        let room = MOST.saturating_sub(reading.sources.len());
        reading.sources.extend(self.done.into_iter().take(room));
        let number = self.number;
        let unknown = self.loud.found.into_iter().map(|(from_s, to_s, level)| NotUnderstood {
            from_s,
            to_s,
            what: format!(
                "channel {number}: {level:.0} mV rms that are no code of this unit configuration and no TWC"
            ),
        });
        let room = MOST.saturating_sub(reading.not_understood.len());
        reading.not_understood.extend(unknown.take(room));
    }
}

/// The codes of one carrier.
struct Carrier<'a> {
    carrier_hz: f64,
    receiver: CodeReceiver,
    codes: Vec<&'a SpeedCode>,
    rates_hz: Vec<f32>,
    under_way: Option<Source>,
    heard_s: f64,
}

impl<'a> Carrier<'a> {
    fn new(code: &'a SpeedCode, unit: &UnitConfig, sample_hz: f64) -> Self {
        Self {
            carrier_hz: code.carrier_hz,
            receiver: CodeReceiver::new(
                Reception::of(&unit.receiver, code.carrier_hz),
                sample_hz as f32,
            ),
            codes: vec![code],
            rates_hz: vec![code.rate_hz as f32],
            under_way: None,
            heard_s: 0.0,
        }
    }

    /// Whether something is heard now.
    fn ask(
        &mut self,
        unit: &UnitConfig,
        at_s: f64,
        channel: usize,
        done: &mut Vec<Source>,
    ) -> bool {
        let Some(heard) = self.receiver.heard(&self.rates_hz) else {
            if at_s - self.heard_s > ENDS_AFTER_S {
                done.extend(self.under_way.take());
            }
            return false;
        };
        self.heard_s = at_s;
        let what = self.name(&heard, unit);
        let began_s = (at_s - f64::from(self.receiver.window_s())).max(0.0);
        match &mut self.under_way {
            Some(source) if source.what == what => source.to_s = at_s,
            under_way => {
                let source = Source {
                    kind: "code",
                    channel,
                    from_s: began_s,
                    to_s: at_s,
                    what,
                    carrier_hz: f64::from(heard.carrier_hz),
                    rate_hz: f64::from(heard.rate_hz),
                    level_mv: Some(f64::from(heard.level_mv)),
                    snr_db: heard.snr_db.map(f64::from),
                    bad_bytes: None,
                };
                done.extend(under_way.replace(source));
            }
        }
        true
    }

    /// The code's name, as the unit decodes it.
    fn name(&self, heard: &Heard, unit: &UnitConfig) -> String {
        let receiver = &unit.receiver;
        let is_carrier =
            (f64::from(heard.carrier_hz) - self.carrier_hz).abs() <= receiver.carrier_tolerance_hz;
        let code = self.codes.iter().find(|code| {
            (f64::from(heard.rate_hz) - code.rate_hz).abs() <= receiver.rate_tolerance_hz
        });
        match code {
            Some(code) if is_carrier => code.name.clone(),
            _ => String::new(),
        }
    }
}

/// The receiver of TWC, and the bytes that belong together.
struct Twc {
    receiver: FskReceiver,
    under_way: Option<Source>,
}

impl Twc {
    fn new(unit: &UnitConfig, sample_hz: f64) -> Self {
        let level_min = unit.receiver.level_min_mv as f32;
        Self {
            receiver: FskReceiver::new(Tones::DEFAULT, sample_hz as f32, level_min),
            under_way: None,
        }
    }

    fn is_in_message(&self, at_s: f64) -> bool {
        (self.under_way.as_ref()).is_some_and(|source| at_s - source.to_s < APART_S)
    }

    fn take(&mut self, sample_mv: f32, at_s: f64, channel: usize, done: &mut Vec<Source>) {
        let Some(received) = self.receiver.take(sample_mv) else {
            return;
        };
        if !self.is_in_message(at_s) {
            done.extend(self.under_way.take());
        }
        let tones = Tones::DEFAULT;
        let byte_s = 11.0 / f64::from(tones.bit_rate);
        let source = self.under_way.get_or_insert_with(|| Source {
            kind: "twc",
            channel,
            from_s: at_s - byte_s,
            to_s: at_s,
            what: String::new(),
            carrier_hz: f64::from(tones.middle_hz),
            rate_hz: f64::from(tones.bit_rate),
            level_mv: None,
            snr_db: None,
            bad_bytes: Some(0),
        });
        source.to_s = at_s;
        match received {
            Received::Byte(byte) => {
                let blank = if source.what.is_empty() { "" } else { " " };
                source.what.push_str(&format!("{blank}{byte:02x}"));
            }
            Received::Parity | Received::Framing => {
                source.bad_bytes = source.bad_bytes.map(|bad| bad + 1);
            }
        }
    }
}

/// What is loud and not understood.
#[derive(Default)]
struct Loud {
    square: f64,
    samples: u64,
    /// Since when, the sum of squared levels, and how many.
    under_way: Option<(f64, f64, u32)>,
    found: Vec<(f64, f64, f64)>,
}

impl Loud {
    fn ask(&mut self, is_understood: bool, at_s: f64, level_min_mv: f64) {
        let square = self.square / self.samples.max(1) as f64;
        (self.square, self.samples) = (0.0, 0);
        if is_understood || square.sqrt() < level_min_mv {
            return self.close(at_s);
        }
        let (_, sum, count) = self.under_way.get_or_insert((at_s - ASKED_EVERY_S, 0.0, 0));
        *sum += square;
        *count += 1;
    }

    fn close(&mut self, at_s: f64) {
        if let Some((from_s, sum, count)) = self.under_way.take()
            && at_s - from_s >= LEAST_UNKNOWN_S
            && self.found.len() < MOST
        {
            let level = (sum / f64::from(count)).sqrt();
            self.found.push((from_s.max(0.0), at_s, level));
        }
    }
}
