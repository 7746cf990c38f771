//! The receivers of codes on a channel, and the codes that they have heard.

use ato_under_test::receivers::{CodeReceiver, Heard, Reception};
use protocol::config::{SpeedCode, UnitConfig};

use super::fit::Envelope;
use super::reading::{ASKED_EVERY_S, Clock, MOST, Source};

/// A code that is not heard for so long has ended, s.
const ENDS_AFTER_S: f64 = 0.3;

/// The receivers of codes.
pub(super) struct Codes<'a> {
    pub(super) carriers: Vec<Carrier<'a>>,
    pub(super) done: Vec<Source>,
    /// Whether a code was heard at each asking of the last block.
    pub(super) understood: Vec<bool>,
}

impl Codes<'_> {
    pub(super) fn take_block(
        &mut self,
        samples: &[f32],
        clock: Clock,
        (channel, unit): (usize, &UnitConfig),
    ) {
        self.understood.clear();
        for (place, part) in samples.chunks(clock.asked_every).enumerate() {
            let mut understood = false;
            let at_s = clock.at_s((place + 1) * clock.asked_every - 1);
            for carrier in &mut self.carriers {
                part.iter().for_each(|sample| carrier.take(*sample));
                if part.len() == clock.asked_every {
                    understood |= carrier.ask(unit, at_s, channel, &mut self.done);
                }
            }
            self.understood.push(understood);
        }
        self.done.truncate(MOST);
    }
}

/// The codes of one carrier.
pub(super) struct Carrier<'a> {
    receiver: CodeReceiver,
    /// Envelope of a carrier that is switched on and off.
    envelope: Option<Envelope>,
    codes: Vec<&'a SpeedCode>,
    rates_hz: Vec<f32>,
    under_way: Option<Source>,
    /// What is heard now, and since when without a break, s.
    now: Option<(String, f64)>,
    /// How long a code is heard before it is listed, s: noise and a jump of the phase pass meanwhile.
    patience_s: f64,
    /// Askings of which the values of `under_way` are means.
    askings: f64,
    heard_s: f64,
}

impl<'a> Carrier<'a> {
    pub(super) fn new(carrier_hz: f64, unit: &'a UnitConfig, sample_hz: f64) -> Self {
        let reception = Reception::of(unit, carrier_hz);
        let codes = (unit.codes.iter()).filter(|code| unit.is_on_carrier(code, carrier_hz));
        let codes: Vec<_> = codes.collect();
        let receiver = CodeReceiver::new(reception, sample_hz as f32);
        let detected_s = f64::from(unit.receiver.detect_ms) / 1_000.0;
        Self {
            // Two askings in a row at least; else up to the asking that is nearest to the unit's time of detection.
            patience_s: (detected_s - f64::from(receiver.window_s())).max(ASKED_EVERY_S)
                - 0.5 * ASKED_EVERY_S,
            receiver,
            envelope: (unit.receiver.shift_hz == 0.0)
                .then(|| Envelope::new(carrier_hz, f64::from(reception.rates_hz.1), sample_hz)),
            now: None,
            rates_hz: codes.iter().map(|code| code.rate_hz as f32).collect(),
            codes,
            under_way: None,
            askings: 0.0,
            heard_s: 0.0,
        }
    }

    fn take(&mut self, sample_mv: f32) {
        self.receiver.take(sample_mv);
        if let Some(envelope) = &mut self.envelope {
            envelope.take(sample_mv);
        }
    }

    /// The code that is being heard, with its rate and level from its beginning until now.
    pub(super) fn under_way(&self) -> Option<Source> {
        let mut source = self.under_way.clone()?;
        let fit = (self.envelope.as_ref()).filter(|_| source.rate_hz > 0.0);
        let times = [source.from_s, source.to_s];
        if let Some((rate_hz, level_mv)) = fit.and_then(|of| of.fit(times, source.rate_hz)) {
            (source.rate_hz, source.level_mv) = (rate_hz, Some(level_mv));
        }
        Some(source)
    }

    /// Asks the receiver, and lists a code that has ended. Whether something is heard now.
    fn ask(
        &mut self,
        unit: &UnitConfig,
        at_s: f64,
        channel: usize,
        done: &mut Vec<Source>,
    ) -> bool {
        let Some(heard) = self.receiver.heard(&self.rates_hz) else {
            self.now = None;
            if at_s - self.heard_s > ENDS_AFTER_S {
                done.extend(self.under_way());
                self.under_way = None;
            }
            return false;
        };
        self.heard_s = at_s;
        let what = self.name(&heard, unit);
        if self.now.as_ref().is_none_or(|(now, _)| *now != what) {
            self.now = Some((what.clone(), at_s));
        }
        let since_s = self.now.as_ref().map_or(at_s, |(_, since_s)| *since_s);
        let is_listed = (self.under_way.as_ref()).is_some_and(|source| source.what == what);
        if !is_listed && at_s - since_s < self.patience_s {
            return true;
        }
        if !is_listed {
            done.extend(self.under_way());
        }
        let began_s = (since_s - f64::from(self.receiver.window_s())).max(0.0);
        match &mut self.under_way {
            Some(source) if source.what == what => {
                source.to_s = at_s;
                self.askings += 1.0;
                let mean = |mean: &mut f64, value: f32| {
                    *mean += (f64::from(value) - *mean) / self.askings;
                };
                mean(&mut source.carrier_hz, heard.carrier_hz);
                mean(&mut source.rate_hz, heard.rate_hz);
                if let Some(level_mv) = &mut source.level_mv {
                    mean(level_mv, heard.level_mv);
                }
                if let (Some(snr_db), Some(now)) = (&mut source.snr_db, heard.snr_db) {
                    mean(snr_db, now);
                }
            }
            under_way => {
                self.askings = 1.0;
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
                    ..Source::default()
                };
                *under_way = Some(source);
            }
        }
        true
    }

    /// The code's name, as the unit decodes it.
    fn name(&self, heard: &Heard, unit: &UnitConfig) -> String {
        let receiver = &unit.receiver;
        let code = self.codes.iter().find(|code| {
            (f64::from(heard.rate_hz) - code.rate_hz).abs() <= receiver.rate_tolerance_hz
        });
        match code {
            Some(code) if unit.is_on_carrier(code, heard.carrier_hz.into()) => code.name.clone(),
            _ => String::new(),
        }
    }
}
