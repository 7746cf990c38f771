//! Speed-code decoding: carrier, code rate and level against the unit's code table.

use protocol::config::{ReceiverConfig, SpeedCode, UnitConfig};
use protocol::event::Event;
use protocol::{Duration, Instant, Speed};

use crate::kernel::EventLog;
use crate::signals::AntennaSignal;
use crate::timer::OnDelay;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Code {
    /// Nothing valid: the most restrictive limit holds.
    #[default]
    None,
    /// Carrier without modulation: absolute stop.
    AbsoluteStop,
    /// A code of the table, by index.
    Known(u8),
}

/// The decoder: a code counts once it has been steady, and stays in force for a hold time after the
/// last time it was heard.
#[derive(Debug)]
pub struct CodeDecoder {
    code: Code,
    heard: Instant,
    candidate: Code,
    steady: OnDelay,
    unknown: OnDelay,
    unknown_reported: bool,
}

impl CodeDecoder {
    /// Nothing received yet.
    pub fn new() -> Self {
        Self {
            code: Code::None,
            heard: Instant::ZERO,
            candidate: Code::None,
            steady: OnDelay::default(),
            unknown: OnDelay::default(),
            unknown_reported: false,
        }
    }

    pub fn step(
        &mut self,
        now: Instant,
        signal: AntennaSignal,
        config: &UnitConfig,
        log: &mut EventLog,
    ) {
        let match_ = lookup(signal, config);
        if match_ != self.candidate {
            self.candidate = match_;
            self.steady.clear();
        }
        let receiver = &config.receiver;
        let detect = Duration::from_ms(u64::from(receiver.detect_ms));
        let steady = self.steady.update(now, match_ != Code::None, detect);
        if steady || (match_ == self.code && match_ != Code::None) {
            self.code = match_;
            self.heard = now;
        }
        let hold = Duration::from_ms(u64::from(receiver.hold_ms));
        if self.code != Code::None && now.since(self.heard) > hold {
            self.code = Code::None;
            log.push(now, Event::CodeLost, 0);
        }
        let strange = match_ == Code::None && in_level(signal, receiver);
        self.report_unknown(now, strange, signal, detect + hold, log);
    }

    fn report_unknown(
        &mut self,
        now: Instant,
        strange: bool,
        signal: AntennaSignal,
        patience: Duration,
        log: &mut EventLog,
    ) {
        if !self.unknown.update(now, strange, patience) {
            self.unknown_reported &= strange;
        } else if !self.unknown_reported {
            self.unknown_reported = true;
            log.push(
                now,
                Event::CodeUnknown,
                libm::round(signal.rate_hz * 100.0) as i32,
            );
        }
    }

    pub fn code(&self) -> Code {
        self.code
    }

    /// The code heard in this scan, in force or not.
    pub fn candidate(&self) -> Code {
        self.candidate
    }

    /// The limit the code in force stands for; none means zero.
    pub fn limit(&self, codes: &[SpeedCode]) -> Speed {
        match self.code {
            Code::Known(index) => codes
                .get(usize::from(index))
                .map_or(Speed::ZERO, |c| Speed::from_kmh(c.limit_kmh)),
            Code::None | Code::AbsoluteStop => Speed::ZERO,
        }
    }
}

impl Default for CodeDecoder {
    fn default() -> Self {
        Self::new()
    }
}

fn in_level(signal: AntennaSignal, receiver: &ReceiverConfig) -> bool {
    signal.level_mv >= receiver.level_min_mv && signal.level_mv <= receiver.level_max_mv
}

fn lookup(signal: AntennaSignal, config: &UnitConfig) -> Code {
    let receiver = &config.receiver;
    if !in_level(signal, receiver) {
        return Code::None;
    }
    let on_carrier = |code: &&SpeedCode| {
        libm::fabs(signal.carrier_hz - code.carrier_hz) <= receiver.carrier_tolerance_hz
    };
    if signal.rate_hz == 0.0 {
        let heard = config.codes.iter().any(|code| on_carrier(&code));
        return if heard {
            Code::AbsoluteStop
        } else {
            Code::None
        };
    }
    config
        .codes
        .iter()
        .position(|code| {
            on_carrier(&code)
                && libm::fabs(signal.rate_hz - code.rate_hz) <= receiver.rate_tolerance_hz
        })
        .map_or(Code::None, |index| Code::Known(index as u8))
}
