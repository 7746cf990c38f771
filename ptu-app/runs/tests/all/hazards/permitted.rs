//! Greatest speed that the train may run at, by the codes in the antenna and the mode switch, and the wheels by
//! which speed is measured.

use protocol::config::{SpeedCode, UnitConfig};
use protocol::signal::Signal;
use protocol::{Duration, Instant};

use super::memory::{Confirmed, Lately};
use super::observed::Observed;
use super::proceeding::{Proceeding, YardEnded};

/// Time for which a code that is no longer there may still be in force, and the desk's order on its way, beside hold time
/// of the receiver and detection, ms: filter, scans.
const CODE_HELD_MS: u32 = 500;
/// Time for which the order of the desk, or a limit that it gave, is on its way.
const SWITCHED: Duration = Duration::from_ms(700);
/// Share of the time of detection for which a code is there before the unit may count it.
const NEARLY: f64 = 0.9;
/// Ratio of the levels of two codes from which on the stronger may count: the table's 4 dB, less what noise makes of it.
const APART: f64 = 1.58 * 0.95;
/// Train that counts as under way when a wheel diameter is keyed in, km/h: beyond the tolerance of standstill.
const UNDER_WAY_KMH: f64 = 1.08 + 0.4;

/// The greatest limits that may be in force, km/h, and how much faster than measured the train may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Permitted {
    /// Limit of any code that was in the antenna, km/h.
    pub most_kmh: f64,
    /// Limit of any code that was there for as long as a detection takes, km/h.
    pub confirmed_kmh: f64,
    /// Limit by what the table takes of two codes at once, km/h.
    pub selected_kmh: f64,
    /// True speed over that measured, by any wheel diameter that was keyed in: 1 at least.
    pub keyed: f64,
    /// True speed over measured speed, by diameters of the permitted range that were keyed in at
    /// standstill.
    pub admitted: f64,
}

/// Watches antenna, mode switch and what is keyed in.
pub(super) struct Limits {
    codes: Vec<SpeedCode>,
    level_mv: (f64, f64),
    code_held: Duration,
    yard_kmh: f64,
    yard_ended: YardEnded,
    proceeding: Proceeding,
    emergency_kmh: f64,
    /// Limits by the track's own code or the mode switch, and by a neighbouring track's code.
    each: [Heard; 2],
    selected: Lately,
    /// Limits by code and mode switch.
    by_switch: [Lately; 3],
    wheels: Wheels,
}

/// Limits by one code: at all, and confirmed.
struct Heard {
    lately: Lately,
    confirmed: Confirmed,
}

impl Heard {
    fn note(&mut self, now: Instant, limit_kmh: f64, held: Duration) -> [f64; 2] {
        let lately = self.lately.note(now, limit_kmh, held);
        [
            lately.fold(0.0, f64::max),
            self.confirmed.note(now, limit_kmh, held),
        ]
    }
}

impl Limits {
    pub fn new(config: &UnitConfig) -> Self {
        let receiver = &config.receiver;
        let needs = Duration::from_secs(NEARLY * f64::from(receiver.detect_ms) / 1e3);
        let within = Duration::from_ms(u64::from(receiver.hold_ms));
        let held_ms = receiver.hold_ms + receiver.detect_ms + CODE_HELD_MS;
        Self {
            codes: config.codes.clone(),
            level_mv: (receiver.level_min_mv, receiver.level_max_mv),
            code_held: Duration::from_ms(u64::from(held_ms)),
            yard_kmh: config.overspeed.yard_kmh,
            yard_ended: YardEnded::new(config),
            proceeding: Proceeding::new(config),
            emergency_kmh: config.overspeed.emergency_kmh,
            each: [(); 2].map(|()| Heard {
                lately: Lately::default(),
                confirmed: Confirmed::new(needs, within),
            }),
            selected: Lately::default(),
            by_switch: Default::default(),
            wheels: Wheels::new(config),
        }
    }

    pub fn note(&mut self, seen: Observed<'_>) -> Permitted {
        let [own_kmh, second_kmh, selected_kmh] = self.by_codes(seen);
        let ended = self.yard_ended.note(seen);
        let proceeds_kmh = self.proceeding.note(seen, own_kmh);
        let switch = seen.value(Signal::ModeSwitch) as u8;
        let [own, second] = &mut self.each;
        let own = own.note(seen.now, own_kmh, self.code_held);
        let second = second.note(seen.now, second_kmh, self.code_held);
        let selected = self.selected.note(seen.now, selected_kmh, self.code_held);
        let selected = selected.fold(0.0, f64::max);
        let codes = [own[0].max(second[0]), own[1].max(second[1]), selected];
        // By the mode switch, whose order is on its way for a while.
        let [most_kmh, confirmed_kmh, selected_kmh] = std::array::from_fn(|which| {
            let limit_kmh = match switch {
                1 if ended => codes[which].max(proceeds_kmh).min(self.yard_kmh),
                1 => self.yard_kmh,
                2..=4 => codes[which].max(proceeds_kmh),
                5 => self.emergency_kmh,
                _ => 0.0,
            };
            let limits = self.by_switch[which].note(seen.now, limit_kmh, SWITCHED);
            limits.fold(0.0, f64::max)
        });
        let [keyed, admitted] = self.wheels.note(seen);
        Permitted {
            most_kmh,
            confirmed_kmh,
            selected_kmh,
            keyed,
            admitted,
        }
    }

    /// Limit of the track's own code, of the neighbouring track's, and the greatest by what the table takes of both.
    fn by_codes(&self, seen: Observed<'_>) -> [f64; 3] {
        let own_mv = seen.value(Signal::LevelMv);
        let own = [
            seen.value(Signal::CarrierHz),
            seen.value(Signal::CodeRateHz),
        ];
        let second_mv = seen.value(Signal::CrosstalkMv);
        let own_kmh = self.code_limit_kmh(own, own_mv);
        let second_kmh = self.code_limit_kmh(seen.crosstalk, second_mv);
        let (stronger_mv, weaker_mv, stronger_kmh) = match own_mv > second_mv {
            true => (own_mv, second_mv, own_kmh),
            false => (second_mv, own_mv, second_kmh),
        };
        let apart = stronger_mv >= APART * weaker_mv;
        [own_kmh, second_kmh, if apart { stronger_kmh } else { 0.0 }]
    }

    /// Limit of a code, km/h; near its tolerances it may count.
    fn code_limit_kmh(&self, [carrier_hz, rate_hz]: [f64; 2], level_mv: f64) -> f64 {
        let (least_mv, most_mv) = self.level_mv;
        if !(0.8 * least_mv..=1.2 * most_mv).contains(&level_mv) {
            return 0.0;
        }
        let near = |code: &&SpeedCode| {
            (code.rate_hz - rate_hz).abs() < 0.7 && (code.carrier_hz - carrier_hz).abs() < 60.0
        };
        let limits = self.codes.iter().filter(near).map(SpeedCode::line_kmh);
        limits.fold(0.0, f64::max)
    }
}

/// Wheel diameters that were keyed in since the unit had its supply last.
struct Wheels {
    configured_mm: f64,
    range_mm: std::ops::RangeInclusive<f64>,
    keyed: f64,
    admitted: f64,
    /// Markers passed under way since one was keyed in, and the last of them.
    passed: usize,
    marker: f64,
}

/// Markers by which a wheel is known, and how far off it may be then.
const PROVES: usize = 3;
const PROVED: f64 = 1.03;

impl Wheels {
    fn new(config: &UnitConfig) -> Self {
        let tacho = &config.tacho;
        let configured_mm = tacho.wheel_diameter_mm;
        Self {
            configured_mm,
            range_mm: configured_mm - tacho.worn_mm..=configured_mm + tacho.over_mm,
            keyed: 1.0,
            admitted: 1.0,
            passed: 0,
            marker: 0.0,
        }
    }

    /// True speed over measured speed: by any diameter keyed in, and by diameters of the permitted range keyed in at
    /// standstill. With a greater diameter the unit measures more than the train runs, and the train is slower.
    fn note(&mut self, seen: Observed<'_>) -> [f64; 2] {
        if !seen.powered {
            (self.keyed, self.admitted) = (1.0, 1.0);
            return [1.0; 2];
        }
        if let Some(mm) = seen.wheel_mm.filter(|mm| *mm > 0.0) {
            let factor = self.configured_mm / mm;
            self.keyed = self.keyed.max(factor);
            let stands = seen.kmh() < UNDER_WAY_KMH || seen.blind;
            if stands && self.range_mm.contains(&mm) {
                self.admitted = self.admitted.max(factor);
                self.passed = 0;
            }
        }
        let marker = seen.value(Signal::MarkerCoil);
        let new = std::mem::replace(&mut self.marker, marker) != marker;
        self.passed += usize::from(new && seen.kmh() > UNDER_WAY_KMH && seen.pulsed == 0);
        let proved = self.passed >= PROVES && seen.displaced == [0.0; 4];
        let admitted = if proved {
            self.admitted.min(PROVED)
        } else {
            self.admitted
        };
        [self.keyed, admitted]
    }
}

#[cfg(test)]
mod tests {
    use protocol::message::ModeSwitch;
    use protocol::signal::Sample;

    use super::*;
    use crate::setup;

    /// Permitted speeds after two seconds of this antenna, desk and motion, each with the change that `see` makes.
    fn permitted(see: impl Fn(&mut Observed<'_>), antenna: [f64; 3], second_mv: f64) -> Permitted {
        let setup = setup(&[]);
        let mut limits = Limits::new(&setup.config.content);
        let mut sample = Sample::default();
        let [carrier_hz, rate_hz, level_mv] = antenna;
        sample.set(Signal::ModeSwitch, f64::from(ModeSwitch::Manual.code()));
        sample.set(Signal::CarrierHz, carrier_hz);
        sample.set(Signal::CodeRateHz, rate_hz);
        sample.set(Signal::LevelMv, level_mv);
        sample.set(Signal::CrosstalkMv, second_mv);
        let mut last = None;
        for scan in 0..200 {
            let mut seen = Observed::at_rest(Instant::from_us(scan * 10_000), &sample);
            see(&mut seen);
            last = Some(limits.note(seen));
        }
        last.expect("scans")
    }

    /// Goal: of two codes the monitor takes what the table takes. Method: 25 in the own track, 75 in the neighbouring one,
    /// 6 dB and 3 dB weaker, and 6 dB stronger.
    #[test]
    fn of_two_codes_the_stronger_counts_where_it_is_apart() {
        let setup = setup(&[]);
        let codes = &setup.config.content.codes;
        let code = |kmh: f64| {
            codes
                .iter()
                .find(|code| code.limit_kmh == kmh)
                .expect("a code")
        };
        let (own, other) = (code(25.0), code(75.0));
        for (second_mv, selected_kmh) in [(0.0, 25.0), (250.0, 25.0), (354.0, 0.0), (1_000.0, 75.0)]
        {
            let neighbour =
                |seen: &mut Observed<'_>| seen.crosstalk = [other.carrier_hz, other.rate_hz];
            let found = permitted(neighbour, [own.carrier_hz, own.rate_hz, 500.0], second_mv);
            assert_eq!(found.selected_kmh, selected_kmh, "{second_mv} mV");
            let most_kmh = if second_mv > 0.0 { 75.0 } else { 25.0 };
            assert_eq!((found.most_kmh, found.confirmed_kmh), (most_kmh, most_kmh));
        }
    }

    /// Goal: a diameter that the table refuses permits nothing. Method: 800 and 700 mm of 860, at rest and under way.
    #[test]
    fn a_wheel_diameter_counts_of_the_range_and_at_rest() {
        let cases = [
            (800.0, 0.0, 1.075, 1.075),
            (700.0, 0.0, 860.0 / 700.0, 1.0),
            (800.0, 3.0, 1.075, 1.0),
            (0.0, 0.0, 1.0, 1.0),
        ];
        for (mm, speed_mps, keyed, admitted) in cases {
            let see = |seen: &mut Observed<'_>| {
                (seen.wheel_mm, seen.speed_mps) = (Some(mm), speed_mps);
            };
            let found = permitted(see, [0.0; 3], 0.0);
            assert_eq!((found.keyed, found.admitted), (keyed, admitted), "{mm} mm");
        }
        let mut wheels = Wheels::new(&setup(&[]).config.content);
        let sample = Sample::default();
        let mut seen = Observed::at_rest(Instant::ZERO, &sample);
        seen.wheel_mm = Some(800.0);
        assert_eq!(wheels.note(seen), [1.075; 2]);
        (seen.wheel_mm, seen.powered) = (None, false);
        assert_eq!(wheels.note(seen), [1.0; 2], "a power-up goes back");
    }
}
