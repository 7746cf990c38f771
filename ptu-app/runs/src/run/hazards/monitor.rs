//! An independent monitor of the train: what must never be, written from the table in `docs/protection.md` and from
//! nothing of the unit's code.
//!
//! It sees the track, the desk, the brake line and the wheels as they are, and of the unit its contacts alone.

use protocol::config::UnitConfig;
use protocol::signal::{Sample, Signal};
use protocol::{Duration, Instant};

use super::memory::{Asleep, Blind, Lately, Runs};
use super::permitted::{Limits, Permitted};

/// Motion above this is no standstill, km/h: standstill tolerance and what wheels and windows make of it.
const MOVES_KMH: f64 = 1.08 + 0.4;
/// Wheels slower than this stand, km/h: a pulse every 27 mm tells no more within half a second.
const STANDS_KMH: f64 = 0.25;
/// What a measured speed may be off, km/h.
const SPEED_OFF_KMH: f64 = 0.6;
/// Time from a cause to a contact, beside the table's: scans of unit and bench, and window of the speed.
const SLACK: Duration = Duration::from_ms(300);
/// Wheels that slow the train by less do not, m/s².
const SLOWS_MPS2: f64 = 0.3;
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
    /// Power by ATO after the open brake line has ended its run, and no other was begun.
    DrivesOnByItself,
    /// Motion of a train that is put away, or was woken with a self-test that failed.
    SleepingMoves,
    /// Motion with the reverser in neutral.
    RollsNeutral,
    /// Faster than the code of the own track lets it, by that of a neighbouring one.
    Crosstalk,
    /// Faster than the limit by a wheel diameter that has to be refused.
    WrongWheels,
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
            Self::Crosstalk => "crosstalk",
            Self::WrongWheels => "wrong_wheels",
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
    /// Carrier and code rate of a neighbouring track's code, Hz; its level is a signal.
    pub crosstalk: [f64; 2],
    /// Wheel diameter that is being keyed in, mm; 0 = as configured.
    pub wheel_mm: Option<f64>,
}

impl<'a> Observed<'a> {
    /// A train at rest on the bench, forward, with its unit supplied.
    pub(super) fn at_rest(now: Instant, sample: &'a Sample) -> Self {
        Self {
            now,
            sample,
            speed_mps: 0.0,
            accel_mps2: 0.0,
            to_stop_m: None,
            traction_n: 0.0,
            reverser: 1,
            start: false,
            blind: false,
            powered: true,
            crosstalk: [0.0; 2],
            wheel_mm: None,
        }
    }
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
    /// Margins of the service brake and of the emergency brake, km/h.
    margins_kmh: [f64; 2],
    limits: Limits,
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
            margins_kmh: {
                let fsb_kmh = config.overspeed.fsb_margin_kmh;
                [fsb_kmh, config.overspeed.eb_margin_kmh.unwrap_or(fsb_kmh)]
            },
            limits: Limits::new(config),
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

    fn conditions(&mut self, seen: Observed<'_>) -> [(Hazard, bool, Duration); 17] {
        let Permitted {
            most_kmh,
            confirmed_kmh,
            selected_kmh,
            keyed,
            admitted,
        } = self.limits.note(seen);
        let (eb, fsb) = (seen.on(Signal::EbLoop), seen.on(Signal::Fsb));
        let (left, right) = (
            seen.on(Signal::DoorEnableLeft),
            seen.on(Signal::DoorEnableRight),
        );
        let kmh = seen.kmh();
        let blind = self.blind.note(seen);
        let moves = kmh > MOVES_KMH && !blind;
        let beyond = |limit_kmh: f64, margin_kmh: f64, factor: f64| {
            kmh > (limit_kmh + margin_kmh) * factor + SPEED_OFF_KMH
        };
        let above =
            |margin_kmh, factor| most_kmh > 0.0 && beyond(most_kmh, margin_kmh, factor) && !blind;
        let [fsb_kmh, eb_kmh] = self.margins_kmh;
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
            (
                Hazard::OverLimit,
                above(fsb_kmh, keyed) && !eb && !fsb,
                ms(300),
            ),
            (
                Hazard::OverLimitUnslowed,
                above(eb_kmh, keyed)
                    && !eb
                    && seen.speed_mps * seen.accel_mps2 > -SLOWS_MPS2 * seen.speed_mps.abs(),
                ms(6_000),
            ),
            (
                Hazard::MovesUnderStop,
                most_kmh == 0.0 && moves && !eb && !fsb,
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
                seen.reverser != 0 && self.rolled_back(seen, fsb, blind) && !eb,
                ms(0),
            ),
            (
                Hazard::JogTooFast,
                jogs_back(seen) && beyond(JOG_KMH, 0.0, keyed) && !eb && !fsb && !blind,
                ms(300),
            ),
            (
                Hazard::UnconfirmedCode,
                moves && beyond(confirmed_kmh, fsb_kmh, keyed) && !eb && !fsb,
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
                seen.reverser == 0 && self.rolled_back(seen, fsb, blind) && !eb,
                ms(0),
            ),
            (
                Hazard::Crosstalk,
                moves && beyond(selected_kmh, fsb_kmh, keyed) && !eb && !fsb,
                ms(500),
            ),
            (
                Hazard::WrongWheels,
                above(fsb_kmh, admitted) && !eb && !fsb,
                ms(300),
            ),
        ]
    }

    /// A jog back does not count, nor does what its brake takes to stop the train, nor the way that no wheel has measured.
    fn rolled_back(&mut self, seen: Observed<'_>, fsb: bool, blind: bool) -> bool {
        let jogs = jogs_back(seen) && (seen.kmh() <= JOG_KMH + SPEED_OFF_KMH || fsb);
        let way_m = match seen.reverser {
            0 => seen.speed_mps.abs() * 0.01,
            towards => -f64::from(towards) * seen.speed_mps * 0.01,
        };
        let against_m = if jogs { 0.0 } else { way_m };
        self.against_m = (self.against_m + against_m).max(0.0);
        // A brake that was released at standstill begins again.
        if seen.kmh() < STANDS_KMH || seen.on(Signal::EbLoop) || blind {
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
