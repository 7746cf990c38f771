//! Speed-code decoding: carrier, code rate and level against the unit's code table.

use protocol::config::{CodeMeaning, ReceiverConfig, SpeedCode, UnitConfig};
use protocol::event::Event;
use protocol::{Duration, Instant, SCAN, Speed};

use super::heard::{Code, Heard};
use crate::kernel::{EventLog, hundredths};
use crate::signals::AntennaSignal;
use crate::timer::{OnDelay, ms};

/// Greatest error in the beginning of a code, as a receiver of waveforms states it by `heard_for`.
const KNOWN_TO: Duration = Duration::from_ms(500);

/// A code that comes more often than this within the hold time flickers; at a border that a train crosses it comes
/// twice.
const SELDOM: usize = 2;

/// The decoder: a code counts once it has been steady, and stays in force for a hold time after the
/// last time it was confirmed: heard for as long as a detection takes within one hold time.
///
/// Of codes that alternate the most restrictive one holds: it takes over by the sum of its times, and one that comes
/// back after it must be steady for the hold time.
#[derive(Clone, Debug, Default)]
pub struct CodeDecoder {
    pub code: Code,
    /// When the code in force was confirmed last.
    confirmed: Instant,
    candidate: Code,
    /// Time since which the candidate is heard.
    since: Instant,
    /// The candidate comes back after a more restrictive code, and must be steady for the hold
    /// time.
    comes_back: bool,
    heard: Heard,
    /// When a more restrictive code took the place of another, or was heard again after a less restrictive one.
    restricted: Option<Instant>,
    /// The last code that was heard beside the one in force, and when.
    other: Option<(Code, Instant)>,
    /// The code in force was heard, and not for long enough, since it was confirmed.
    unconfirmed: bool,
    /// The code in force took over by the sum of its times.
    by_sum: bool,
    flicker_reported: bool,
    unknown: OnDelay,
    unknown_reported: bool,
}

impl CodeDecoder {
    /// One scan. With `confirms`, single scans in which a code in force is heard do not renew the code.
    pub fn step(
        &mut self,
        now: Instant,
        signal: AntennaSignal,
        confirms: bool,
        config: &UnitConfig,
        log: &mut EventLog,
    ) {
        let match_ = lookup(signal, config);
        let receiver = &config.receiver;
        let detect = ms(receiver.detect_ms);
        let hold = ms(receiver.hold_ms);
        self.heard.note(now, match_, hold);
        let stricter = |code: Code, than: Code| most_kmh(code, config) < most_kmh(than, config);
        if match_ != self.candidate {
            // Between two codes a receiver of waveforms hears none.
            let after = |(other, at)| now.since(at) < hold && stricter(match_, other);
            if match_ != Code::None && match_ == self.code && self.other.is_some_and(after) {
                self.restricted = Some(now);
            }
            let comes_back = self.restricted.is_some_and(|at| now.since(at) < hold);
            self.comes_back = comes_back && stricter(self.code, match_) && confirms;
            self.candidate = match_;
            self.since = now;
        }
        // A receiver of waveforms has had the code for a while when it hands it on.
        self.since = self.since.min(now.back(signal.heard_for));
        // A code that may be over already must not permit more.
        let patience = match stricter(match_, self.code) {
            true => detect,
            // The beginning of a code that comes and goes is known only to [`KNOWN_TO`].
            false if self.comes_back => hold + signal.heard_for.min(KNOWN_TO),
            false => detect + signal.lags,
        };
        let steady = match_ != Code::None && now.since(self.since) >= patience;
        if match_ != Code::None && match_ != self.code {
            self.other = Some((match_, now));
        }
        // `Heard` counts each scan whole: its time is one scan longer than the time since a steady code began.
        let heard = self.heard.time(match_) + signal.heard_for;
        let enough = heard >= detect + SCAN || !confirms;
        let takes_over = enough && match_ != Code::None && stricter(match_, self.code);
        if steady || takes_over && confirms {
            if stricter(match_, self.code) {
                self.restricted = Some(now);
            }
            self.by_sum = !steady;
            self.flicker_reported &= !steady;
            self.confirm(now, signal, match_);
        } else if match_ == self.code && match_ != Code::None {
            match enough {
                true => self.confirm(now, signal, match_),
                false => self.unconfirmed = true,
            }
        }
        let often = match_ == self.code && self.heard.times(match_) > SELDOM;
        self.flickers(now, self.by_sum && often, log);
        if self.code != Code::None && now.since(self.confirmed) > hold {
            // One silence that has just ended is no flicker.
            let back = match_ == self.code && self.heard.came_back(self.code);
            self.code = Code::None;
            self.flickers(now, self.unconfirmed && !back, log);
            log.push(now, Event::CodeLost, 0);
        }
        let strange = match_ == Code::None && in_level(signal, receiver);
        let patience = detect + hold - signal.heard_for;
        self.report_unknown(now, strange, signal, patience, log);
    }

    fn confirm(&mut self, now: Instant, signal: AntennaSignal, code: Code) {
        let before = if code == self.code {
            self.confirmed
        } else {
            Instant::ZERO
        };
        self.code = code;
        self.confirmed = before.max(now.back(signal.lags));
        self.unconfirmed = false;
    }

    /// Logs once that codes do not stay long enough, until one is steady.
    fn flickers(&mut self, now: Instant, does: bool, log: &mut EventLog) {
        if does && !self.flicker_reported {
            self.flicker_reported = true;
            let heard = self.heard.time(self.candidate).as_ms();
            log.push(now, Event::CodeFlickers, heard as i32);
        }
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
            log.push(now, Event::CodeUnknown, hundredths(signal.rate_hz));
        }
    }

    /// The code of the table that is in force.
    pub fn known<'a>(&self, codes: &'a [SpeedCode]) -> Option<&'a SpeedCode> {
        match self.code {
            Code::Known(index) => codes.get(usize::from(index)),
            Code::None | Code::AbsoluteStop => None,
        }
    }

    /// The code in force says stop, on the line and in a yard.
    pub fn stops(&self, codes: &[SpeedCode]) -> bool {
        let of_table =
            |code: &SpeedCode| code.meaning == CodeMeaning::Line && code.limit_kmh == 0.0;
        self.code == Code::AbsoluteStop || self.known(codes).is_some_and(of_table)
    }

    /// The limit under cab signal that the code in force stands for; none means zero.
    pub fn limit(&self, codes: &[SpeedCode]) -> Speed {
        self.known(codes)
            .map_or(Speed::ZERO, |code| Speed::from_kmh(code.line_kmh()))
    }
}

fn in_level(signal: AntennaSignal, receiver: &ReceiverConfig) -> bool {
    signal.level_mv >= receiver.level_min_mv && signal.level_mv <= receiver.level_max_mv
}

/// The limit that a code stands for, km/h; none and a stop permit nothing. A code of the yard, which permits nothing on
/// the line, is less than any of the line and more than a stop.
fn most_kmh(code: Code, config: &UnitConfig) -> f64 {
    match code {
        Code::Known(index) => {
            (config.codes.get(usize::from(index))).map_or(0.0, |code| match code.meaning {
                CodeMeaning::Yard => f64::MIN_POSITIVE,
                CodeMeaning::Line | CodeMeaning::YardCancel => code.limit_kmh,
            })
        }
        Code::None | Code::AbsoluteStop => 0.0,
    }
}

/// The code that a signal stands for.
pub fn lookup(signal: AntennaSignal, config: &UnitConfig) -> Code {
    let receiver = &config.receiver;
    if !in_level(signal, receiver) {
        return Code::None;
    }
    let on_carrier = |code: &&SpeedCode| config.is_on_carrier(code, signal.carrier_hz);
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
mod tests;
