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
#[derive(Clone, Debug)]
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

/// The code that a signal stands for.
pub fn lookup(signal: AntennaSignal, config: &UnitConfig) -> Code {
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

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use protocol::SCAN;

    use super::*;

    const SILENCE: AntennaSignal = signal(0.0, 0.0, 0.0);
    /// Code 55 of the default table, which is its fifth.
    const CODE_55: AntennaSignal = signal(3000.0, 15.0, 500.0);

    const fn signal(carrier_hz: f64, rate_hz: f64, level_mv: f64) -> AntennaSignal {
        AntennaSignal {
            carrier_hz,
            rate_hz,
            level_mv,
        }
    }

    /// A decoder with its clock and its log: detects in 400 ms, holds for 1 000 ms, takes 60 to 2 000 mV.
    struct Receiver {
        decoder: CodeDecoder,
        config: UnitConfig,
        log: EventLog,
        now: Instant,
    }

    impl Receiver {
        fn new() -> Self {
            let text = include_str!("../../../scripts/units/sg100.toml");
            Self {
                decoder: CodeDecoder::new(),
                config: UnitConfig::from_toml(text).unwrap(),
                log: EventLog::default(),
                now: Instant::from_ms(5000),
            }
        }

        /// Hears a signal for some time; when each code came into force, ms from the first scan.
        fn hear(&mut self, signal: AntennaSignal, ms: u64) -> Vec<(u64, Code)> {
            let (begin, mut before, mut changes) = (self.now, self.decoder.code(), Vec::new());
            while self.now < begin + Duration::from_ms(ms) {
                self.decoder
                    .step(self.now, signal, &self.config, &mut self.log);
                if self.decoder.code() != before {
                    before = self.decoder.code();
                    changes.push((self.now.since(begin).as_ms(), before));
                }
                self.now += SCAN;
            }
            changes
        }

        /// Events so far, with their parameters.
        fn events(&self) -> Vec<(u16, i32)> {
            let entries = (0..).map_while(|index| self.log.entries().at_or_after(index));
            entries.map(|entry| (entry.code, entry.parameter)).collect()
        }
    }

    fn event(event: Event, parameter: i32) -> (u16, i32) {
        (event.definition().code, parameter)
    }

    #[test]
    fn a_code_counts_when_it_was_steady_and_is_lost_after_the_hold_time() {
        let mut receiver = Receiver::new();
        assert_eq!(receiver.hear(CODE_55, 1000), [(400, Code::Known(4))]);
        let scan_ms = SCAN.as_ms();
        // It was heard last one scan before the silence.
        assert_eq!(receiver.hear(SILENCE, 2000), [(1000, Code::None)]);
        assert_eq!(receiver.events(), [event(Event::CodeLost, 0)]);
        // Steady means without a break: 390 ms twice is not 400.
        for _ in 0..2 {
            assert_eq!(receiver.hear(CODE_55, 400 - scan_ms), []);
            assert_eq!(receiver.hear(SILENCE, scan_ms), []);
        }
        // Another code meanwhile begins the time anew, too.
        assert_eq!(receiver.hear(signal(3000.0, 12.0, 500.0), 300), []);
        assert_eq!(receiver.hear(CODE_55, 500), [(400, Code::Known(4))]);
    }

    /// A code in force that is heard for one scan only is in force for another hold time; another one is not.
    #[test]
    fn one_scan_renews_the_code_in_force_and_no_other() {
        let scan_ms = SCAN.as_ms();
        for (rate_hz, lost) in [(15.0, false), (12.0, true)] {
            let mut receiver = Receiver::new();
            receiver.hear(CODE_55, 1000);
            receiver.hear(SILENCE, 600);
            receiver.hear(signal(3000.0, rate_hz, 500.0), scan_ms);
            receiver.hear(SILENCE, 600);
            assert_eq!(receiver.decoder.code() == Code::None, lost, "{rate_hz} Hz");
        }
    }

    #[test]
    fn level_carrier_and_rate_are_taken_within_their_tolerances() {
        for (signal, code) in [
            (signal(3000.0, 15.0, 60.0), Code::Known(4)),
            (signal(3000.0, 15.0, 59.9), Code::None),
            (signal(3000.0, 15.0, 2000.0), Code::Known(4)),
            (signal(3000.0, 15.0, 2000.1), Code::None),
            (signal(2950.0, 15.0, 500.0), Code::Known(4)),
            (signal(2949.0, 15.0, 500.0), Code::None),
            (signal(3050.0, 15.0, 500.0), Code::Known(4)),
            (signal(3051.0, 15.0, 500.0), Code::None),
            (signal(3000.0, 14.5, 500.0), Code::Known(4)),
            (signal(3000.0, 14.4, 500.0), Code::None),
            (signal(3000.0, 0.0, 500.0), Code::AbsoluteStop),
            (signal(4000.0, 0.0, 500.0), Code::None),
        ] {
            let mut receiver = Receiver::new();
            receiver.hear(signal, 1000);
            assert_eq!(receiver.decoder.code(), code, "{signal:?}");
        }
    }

    #[test]
    fn an_unknown_code_is_logged_once_with_its_rate_each_time_it_comes() {
        let mut receiver = Receiver::new();
        let unknown = signal(3000.0, 18.3, 500.0);
        receiver.hear(unknown, 1400);
        assert_eq!(receiver.events(), []);
        receiver.hear(unknown, 3000);
        let once = event(Event::CodeUnknown, 1830);
        assert_eq!(receiver.events(), [once]);
        receiver.hear(signal(3000.0, 18.3, 10.0), 3000);
        assert_eq!(receiver.events(), [once]);
        receiver.hear(unknown, 3000);
        assert_eq!(receiver.events(), [once, once]);
    }
}
