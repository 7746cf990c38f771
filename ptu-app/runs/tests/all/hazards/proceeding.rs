//! What the row `proceeds` of the table permits a driver without a code, and where the row `yard_codes` ends the yard.
//!
//! Both are written from the table alone. A code counts where it has been there so long, without a break and without a
//! neighbour, that no receiver may have missed it.

use protocol::config::{CodeMeaning, SpeedCode, UnitConfig};
use protocol::signal::Signal;
use protocol::{Duration, Instant};

use super::observed::Observed;

/// Motion slower than this counts as standing, km/h: tolerance of standstill, and what wheels and windows make of it.
const STANDS_KMH: f64 = 1.08 + 0.4;

/// Since when a condition holds without a break, by one code rate: codes that alternate may be none.
#[derive(Default)]
struct Held {
    since: Option<Instant>,
    rate_hz: f64,
}

impl Held {
    fn for_long(&mut self, seen: Observed<'_>, holds: bool, time: Duration) -> bool {
        let rate_hz = seen.value(Signal::CodeRateHz);
        let same = rate_hz == std::mem::replace(&mut self.rate_hz, rate_hz);
        if !holds || !same {
            self.since = None;
            return false;
        }
        seen.now.since(*self.since.get_or_insert(seen.now)) > time
    }
}

/// Time in which no receiver misses a code, nor keeps an old one.
fn surely(config: &UnitConfig) -> Duration {
    let receiver = &config.receiver;
    Duration::from_ms(u64::from(receiver.hold_ms + receiver.detect_ms + 500))
}

/// Whether the antenna has a sound signal, and no other beside it.
fn alone(seen: Observed<'_>, config: &Receiver) -> bool {
    let level = seen.value(Signal::LevelMv);
    let sound = (1.2 * config.least_mv..0.8 * config.most_mv).contains(&level);
    sound && seen.value(Signal::CrosstalkMv) < 0.1 * level && seen.powered
}

struct Receiver {
    least_mv: f64,
    most_mv: f64,
    surely: Duration,
}

impl Receiver {
    fn new(config: &UnitConfig) -> Self {
        Self {
            least_mv: config.receiver.level_min_mv,
            most_mv: config.receiver.level_max_mv,
            surely: surely(config),
        }
    }
}

/// A driver who stopped without a code and braked at standstill may go on.
pub(super) struct Proceeding {
    limit_kmh: Option<f64>,
    receiver: Receiver,
    granted: bool,
    controller: f64,
    coded: Held,
}

impl Proceeding {
    pub fn new(config: &UnitConfig) -> Self {
        Self {
            limit_kmh: config.stop_and_proceed.as_ref().map(|rule| rule.limit_kmh),
            receiver: Receiver::new(config),
            granted: false,
            controller: 0.0,
            coded: Held::default(),
        }
    }

    /// One scan with the limit of the track's own code, km/h; the limit that it may proceed at, 0 = not.
    pub fn note(&mut self, seen: Observed<'_>, code_kmh: f64) -> f64 {
        let Some(limit_kmh) = self.limit_kmh else {
            return 0.0;
        };
        let by_driver = matches!(seen.value(Signal::ModeSwitch) as u8, 1 | 2);
        let stands = seen.kmh() < STANDS_KMH || seen.blind;
        let controller = seen.value(Signal::Controller);
        let before = std::mem::replace(&mut self.controller, controller);
        // A notch that was held before the train stood is no act.
        self.granted |= stands && controller < 0.0 && before >= 0.0;
        // An absolute stop is no lack of a code.
        let signal = code_kmh > 0.0 || seen.value(Signal::CodeRateHz) == 0.0;
        let coded = signal && alone(seen, &self.receiver);
        let ends = self.coded.for_long(seen, coded, self.receiver.surely);
        self.granted &= by_driver && !ends;
        if self.granted { limit_kmh } else { 0.0 }
    }
}

/// A code of the line, or one that cancels yard mode, has ended the yard's limit; where the table has no code for the yard,
/// one that says stop.
pub(super) struct YardEnded {
    codes: Vec<SpeedCode>,
    /// The code table has codes for the yard.
    has_yard: bool,
    receiver: Receiver,
    ended: bool,
    ends: Held,
}

impl YardEnded {
    pub fn new(config: &UnitConfig) -> Self {
        let codes = config.codes.clone();
        Self {
            has_yard: codes.iter().any(|code| code.meaning != CodeMeaning::Line),
            codes,
            receiver: Receiver::new(config),
            ended: false,
            ends: Held::default(),
        }
    }

    pub fn note(&mut self, seen: Observed<'_>) -> bool {
        let rate_hz = seen.value(Signal::CodeRateHz);
        let near = |code: &&SpeedCode| {
            (code.rate_hz - rate_hz).abs() < 0.2
                && (code.carrier_hz - seen.value(Signal::CarrierHz)).abs() < 10.0
        };
        // A table without codes of the yard has one that says stop.
        let ends_yard = |code: &SpeedCode| match self.has_yard {
            true => code.meaning != CodeMeaning::Yard,
            false => code.limit_kmh == 0.0,
        };
        let ends = self.codes.iter().find(near).is_some_and(ends_yard);
        let in_yard = seen.value(Signal::ModeSwitch) as u8 == 1;
        let ends = in_yard && ends && alone(seen, &self.receiver);
        self.ended |= self.ends.for_long(seen, ends, self.receiver.surely);
        // Back in the yard by a code that may be one of it, or by the switch; a unit without supply forgets.
        let of_yard = |code: &SpeedCode| {
            let (own, other) = (rate_hz, seen.crosstalk[1]);
            let about = |hz: f64| (code.rate_hz - hz).abs() < 1.0;
            !ends_yard(code) && (about(own) || about(other))
        };
        self.ended &= in_yard && seen.powered && !self.codes.iter().any(of_yard);
        self.ended
    }
}

#[cfg(test)]
mod tests {
    use protocol::signal::Sample;

    use super::super::seoul34;
    use super::*;

    const MANUAL: f64 = 2.0;
    const YARD: f64 = 1.0;

    /// Permitted speed after five seconds of this desk, speed and code rate (a level, too, where there is a rate
    /// given).
    fn after(
        proceeding: &mut Proceeding,
        ended: &mut YardEnded,
        [switch, controller, kmh]: [f64; 3],
        rate_hz: Option<f64>,
    ) -> (f64, bool) {
        let mut sample = Sample::default();
        sample.set(Signal::ModeSwitch, switch);
        sample.set(Signal::Controller, controller);
        sample.set(Signal::CarrierHz, 990.0);
        sample.set(Signal::CodeRateHz, rate_hz.unwrap_or(0.0));
        sample.set(Signal::LevelMv, rate_hz.map_or(0.0, |_| 500.0));
        let mut last = (0.0, false);
        for scan in 0..500 {
            let mut seen = Observed::at_rest(Instant::from_us(scan * 10_000), &sample);
            seen.speed_mps = kmh / 3.6;
            let code_kmh = if rate_hz == Some(8.6) { 60.0 } else { 0.0 };
            last = (proceeding.note(seen, code_kmh), ended.note(seen));
        }
        last
    }

    /// Goal: the monitor permits what the table permits, so that the search can find a unit that permits more.
    #[test]
    fn what_the_rules_permit_is_this_table() {
        let setup = seoul34();
        let config = &setup.config.content;
        for (desk, rate_hz, kmh) in [
            ([MANUAL, -4.0, 0.0], None, 15.0),
            ([MANUAL, -4.0, 5.0], None, 0.0),
            ([MANUAL, 0.0, 0.0], None, 0.0),
            ([3.0, -4.0, 0.0], None, 0.0),
            ([MANUAL, -4.0, 0.0], Some(0.0), 0.0),
            ([MANUAL, -4.0, 0.0], Some(8.6), 0.0),
        ] {
            let (mut proceeding, mut ended) = (Proceeding::new(config), YardEnded::new(config));
            let found = after(&mut proceeding, &mut ended, desk, rate_hz);
            assert_eq!(found, (kmh, false), "{desk:?} {rate_hz:?}");
        }
        let (mut held, mut ended) = (Proceeding::new(config), YardEnded::new(config));
        for kmh in [5.0, 0.0] {
            let (found_kmh, _) = after(&mut held, &mut ended, [MANUAL, -4.0, kmh], None);
            assert_eq!(found_kmh, 0.0, "a notch that is held, {kmh} km/h");
        }
        for (rate_hz, ends) in [(3.2, false), (16.8, true), (8.6, true), (24.5, false)] {
            let (mut proceeding, mut ended) = (Proceeding::new(config), YardEnded::new(config));
            let found = after(&mut proceeding, &mut ended, [YARD, 0.0, 0.0], Some(rate_hz));
            assert_eq!(found.1, ends, "{rate_hz} Hz");
        }
    }
}
