//! An independent monitor of the train: what must never be, written from the table in `docs/protection.md` and from
//! nothing of the unit's code.
//!
//! It sees the track, the desk, the brake line and the wheels as they are, and of the unit its contacts alone.

use protocol::config::{SpeedCode, UnitConfig};
use protocol::signal::{Sample, Signal};
use protocol::{Duration, Instant};

use super::memory::{Asleep, Blind, Confirmed, Lately, Runs};

/// Motion above this is no standstill, km/h: standstill tolerance and what wheels and windows make of it.
const MOVES_KMH: f64 = 1.08 + 0.4;
/// Wheels slower than this stand, km/h: a pulse every 27 mm tells no more within half a second.
const STANDS_KMH: f64 = 0.25;
/// What a measured speed may be off, km/h.
const SPEED_OFF_KMH: f64 = 0.6;
/// Time for which a code that is no longer there may still be in force, and the desk's order on its way: hold time of
/// the receiver, detection, filter.
const CODE_HELD: Duration = Duration::from_ms(1_900);
/// Time from a cause to a contact, beside the table's: scans of unit and bench, and window of the speed.
const SLACK: Duration = Duration::from_ms(300);
/// Wheels that slow the train by less do not, m/s².
const SLOWS_MPS2: f64 = 0.3;
/// Share of the time of detection for which a code is there before the unit may count it.
const NEARLY: f64 = 0.8;
/// Traction that is none, N: what an inverter still gives while its order fades.
pub(super) const NO_POWER_N: f64 = 10_000.0;
/// Place that the unit may take for the stop point's, m: its tolerance, and what its position may be off.
const AT_STOP_POINT_M: f64 = 0.3 + 0.9;
/// Speed of a jog, km/h.
const JOG_KMH: f64 = 5.0;
/// Overrun after which a train may be jogged back, m: the table's, and what its position may be off.
const JOGS_FROM_M: f64 = 5.3 + 0.9;
/// Way against the reverser, m: tolerance, and one pulse window at the speed of a train that rolls.
const ROLLED_BACK_M: f64 = 0.5 + 0.5;

/// A row of the table that was broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Hazard {
    /// Faster than the limit and its margin, and no service brake.
    OverLimit,
    /// The same for long, neither slowed nor under the emergency brake.
    OverLimitUnslowed,
    /// Motion where there is no limit above zero.
    MovesUnderStop,
    /// Motion with a door open.
    MovesWithDoorOpen,
    /// Doors enabled on a train that moves.
    EnabledMoving,
    /// Doors enabled on a side that no station data gave.
    EnabledWrongSide,
    /// Doors enabled away from the stop point.
    EnabledElsewhere,
    /// Doors ordered to open on a side that is not enabled.
    OrderedUnenabled,
    /// Power under the emergency brake.
    PowerUnderBrake,
    /// Way against the reverser, but for a jog back to the stop point.
    RolledBack,
    /// A jog that is fast, and no brake.
    JogTooFast,
    /// Faster than any code lets it that was there long enough to be detected.
    UnconfirmedCode,
    /// Power by ATO after the open brake line has ended its run, and nobody began another.
    DrivesOnByItself,
    /// Motion of a train that is put away, or was woken with a self-test that failed.
    SleepingMoves,
    /// Motion with the reverser in neutral.
    RollsNeutral,
}

impl Hazard {
    /// Its row in the table.
    pub fn row(self) -> &'static str {
        match self {
            Self::OverLimit => "over_limit",
            Self::OverLimitUnslowed => "over_limit_unslowed",
            Self::MovesUnderStop => "moves_under_stop",
            Self::MovesWithDoorOpen => "moves_with_door_open",
            Self::EnabledMoving => "enabled_moving",
            Self::EnabledWrongSide => "enabled_wrong_side",
            Self::EnabledElsewhere => "enabled_elsewhere",
            Self::OrderedUnenabled => "ordered_unenabled",
            Self::PowerUnderBrake => "power_under_brake",
            Self::RolledBack => "rolled_back",
            Self::JogTooFast => "jog_too_fast",
            Self::UnconfirmedCode => "unconfirmed_code",
            Self::DrivesOnByItself => "drives_on_by_itself",
            Self::SleepingMoves => "sleeping_moves",
            Self::RollsNeutral => "rolls_neutral",
        }
    }
}

/// What happened in a scan.
#[derive(Clone, Copy)]
pub struct Observed<'a> {
    pub now: Instant,
    pub sample: &'a Sample,
    /// Of the train, m/s, forward positive.
    pub speed_mps: f64,
    /// Forward positive, m/s².
    pub accel_mps2: f64,
    /// Distance to the stop point, m, where a section is laid.
    pub to_stop_m: Option<f64>,
    /// Traction at the wheels, N; 0 while the bench turns them.
    pub traction_n: f64,
    /// Reverser: 1, 0, -1.
    pub reverser: i8,
    /// The start button is pressed, or was a moment ago.
    pub start: bool,
    /// No tachometer gives pulses.
    pub blind: bool,
    /// The unit has its supply.
    pub powered: bool,
}

impl Observed<'_> {
    pub(super) fn on(&self, signal: Signal) -> bool {
        self.value(signal) > 0.5
    }

    pub(super) fn value(&self, signal: Signal) -> f64 {
        self.sample.get(signal).unwrap_or(0.0)
    }

    pub(super) fn kmh(&self) -> f64 {
        self.speed_mps.abs() * 3.6
    }
}

pub struct Monitor {
    codes: Vec<SpeedCode>,
    level_mv: (f64, f64),
    yard_kmh: f64,
    emergency_kmh: f64,
    limits: Lately,
    confirmed: Confirmed,
    runs: Runs,
    asleep: Asleep,
    blind: Blind,
    sides: Lately,
    /// Sides on which doors may be enabled, left and right.
    given: [bool; 2],
    /// Way against the reverser since the train last stood, m.
    against_m: f64,
    /// Since when each condition holds.
    since: Vec<Option<Instant>>,
}

impl Monitor {
    pub fn new(config: &UnitConfig) -> Self {
        Self {
            codes: config.codes.clone(),
            level_mv: (config.receiver.level_min_mv, config.receiver.level_max_mv),
            yard_kmh: config.overspeed.yard_kmh,
            emergency_kmh: config.overspeed.emergency_kmh,
            limits: Lately::default(),
            confirmed: Confirmed::new(
                Duration::from_secs(NEARLY * f64::from(config.receiver.detect_ms) / 1e3),
                Duration::from_ms(u64::from(config.receiver.hold_ms)),
            ),
            runs: Runs::default(),
            asleep: Asleep::default(),
            blind: Blind::default(),
            sides: Lately::default(),
            given: [false; 2],
            against_m: 0.0,
            since: Vec::new(),
        }
    }

    /// One scan; what has been there for longer than the table allows.
    pub fn step(&mut self, seen: Observed<'_>) -> Option<Hazard> {
        let conditions = self.conditions(seen);
        self.since.resize(conditions.len(), None);
        let mut found = None;
        for (since, (hazard, holds, allowed)) in self.since.iter_mut().zip(conditions) {
            if !holds {
                *since = None;
            } else if seen.now.since(*since.get_or_insert(seen.now)) > allowed + SLACK {
                found = found.or(Some(hazard));
            }
        }
        found
    }

    fn conditions(&mut self, seen: Observed<'_>) -> [(Hazard, bool, Duration); 15] {
        let (limit_kmh, confirmed_kmh) = self.most_permitted_kmh(seen);
        let (eb, fsb) = (seen.on(Signal::EbLoop), seen.on(Signal::Fsb));
        let (left, right) = (
            seen.on(Signal::DoorEnableLeft),
            seen.on(Signal::DoorEnableRight),
        );
        let kmh = seen.kmh();
        let blind = self.blind.note(seen);
        let moves = kmh > MOVES_KMH && !blind;
        let above =
            |margin_kmh| limit_kmh > 0.0 && kmh > limit_kmh + margin_kmh + SPEED_OFF_KMH && !blind;
        let side = seen.value(Signal::WaysideDoorSide);
        let (mut left_given, mut right_given) = (false, false);
        for side in self.sides.note(seen.now, side, Duration::from_ms(2_500)) {
            left_given |= side == 1.0 || side == 3.0;
            right_given |= side == 2.0 || side == 3.0;
        }
        // What was enabled so lasts until the doors are proved closed.
        let open = !seen.on(Signal::Doors);
        let [left_kept, right_kept] = self.given;
        left_given |= left_kept && left && open;
        right_given |= right_kept && right && open;
        self.given = [left_given, right_given];
        let elsewhere = seen.to_stop_m.is_none_or(|m| m.abs() > AT_STOP_POINT_M);
        let ms = Duration::from_ms;
        [
            (Hazard::OverLimit, above(3.0) && !eb && !fsb, ms(300)),
            (
                Hazard::OverLimitUnslowed,
                above(6.0)
                    && !eb
                    && seen.speed_mps * seen.accel_mps2 > -SLOWS_MPS2 * seen.speed_mps.abs(),
                ms(6_000),
            ),
            (
                Hazard::MovesUnderStop,
                limit_kmh == 0.0 && moves && !eb && !fsb,
                ms(500),
            ),
            (
                Hazard::MovesWithDoorOpen,
                moves && !seen.on(Signal::Doors) && !eb,
                ms(100),
            ),
            (Hazard::EnabledMoving, moves && (left || right), ms(0)),
            (
                Hazard::EnabledWrongSide,
                left && !left_given || right && !right_given,
                ms(0),
            ),
            (
                Hazard::EnabledElsewhere,
                (left || right) && elsewhere,
                ms(0),
            ),
            (
                Hazard::OrderedUnenabled,
                seen.on(Signal::DoorOrderLeft) && !left
                    || seen.on(Signal::DoorOrderRight) && !right,
                ms(0),
            ),
            (
                Hazard::PowerUnderBrake,
                eb && seen.traction_n > NO_POWER_N,
                ms(500),
            ),
            (
                Hazard::RolledBack,
                seen.reverser != 0 && self.rolled_back(seen, fsb) && !eb && !blind,
                ms(0),
            ),
            (
                Hazard::JogTooFast,
                jogs_back(seen) && kmh > JOG_KMH + SPEED_OFF_KMH && !eb && !fsb && !blind,
                ms(300),
            ),
            (
                Hazard::UnconfirmedCode,
                moves && kmh > confirmed_kmh + 3.0 + SPEED_OFF_KMH && !eb && !fsb,
                ms(500),
            ),
            (
                Hazard::DrivesOnByItself,
                self.runs.goes_on(seen, eb),
                ms(200),
            ),
            (
                Hazard::SleepingMoves,
                self.asleep.note(seen) && moves && !eb,
                ms(500),
            ),
            (
                Hazard::RollsNeutral,
                seen.reverser == 0 && self.rolled_back(seen, fsb) && !eb && !blind,
                ms(0),
            ),
        ]
    }

    /// The greatest limit that may still be in force, km/h: of what was there at all, and of what was there for as long
    /// as a detection takes.
    fn most_permitted_kmh(&mut self, seen: Observed<'_>) -> (f64, f64) {
        let limit_kmh = match seen.value(Signal::ModeSwitch) as u8 {
            1 => self.yard_kmh,
            2..=4 => self.code_limit_kmh(seen),
            5 => self.emergency_kmh,
            _ => 0.0,
        };
        let lately = self.limits.note(seen.now, limit_kmh, CODE_HELD);
        let most_kmh = lately.fold(0.0, f64::max);
        let confirmed_kmh = self.confirmed.note(seen.now, limit_kmh, CODE_HELD);
        (most_kmh, confirmed_kmh)
    }

    /// Limit of the code in the antenna, km/h; near its tolerances it may count.
    fn code_limit_kmh(&self, seen: Observed<'_>) -> f64 {
        let (least_mv, most_mv) = self.level_mv;
        let level_mv = seen.value(Signal::LevelMv);
        if !(0.8 * least_mv..=1.2 * most_mv).contains(&level_mv) {
            return 0.0;
        }
        let rate_hz = seen.value(Signal::CodeRateHz);
        let carrier_hz = seen.value(Signal::CarrierHz);
        let near = |code: &&SpeedCode| {
            (code.rate_hz - rate_hz).abs() < 0.7 && (code.carrier_hz - carrier_hz).abs() < 60.0
        };
        let limits = self.codes.iter().filter(near).map(|code| code.limit_kmh);
        limits.fold(0.0, f64::max)
    }

    /// A jog back does not count, nor does what its brake takes to stop the train.
    fn rolled_back(&mut self, seen: Observed<'_>, fsb: bool) -> bool {
        let jogs = jogs_back(seen) && (seen.kmh() <= JOG_KMH + SPEED_OFF_KMH || fsb);
        let way_m = match seen.reverser {
            0 => seen.speed_mps.abs() * 0.01,
            towards => -f64::from(towards) * seen.speed_mps * 0.01,
        };
        let against_m = if jogs { 0.0 } else { way_m };
        self.against_m = (self.against_m + against_m).max(0.0);
        // A brake that was released at standstill begins anew.
        if seen.kmh() < STANDS_KMH || seen.on(Signal::EbLoop) {
            self.against_m = 0.0;
        }
        self.against_m > ROLLED_BACK_M
    }
}

/// The train may be jogging back: mode switch at automatic or driverless, past the stop point, doors closed.
fn jogs_back(seen: Observed<'_>) -> bool {
    let switch = matches!(seen.value(Signal::ModeSwitch) as u8, 3 | 4);
    let past = |to_stop_m: f64| (-JOGS_FROM_M..AT_STOP_POINT_M).contains(&to_stop_m);
    let backward = seen.reverser == 1 && seen.speed_mps < 0.0;
    switch && backward && seen.on(Signal::Doors) && seen.to_stop_m.is_some_and(past)
}
