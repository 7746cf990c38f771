//! An independent monitor of the train: invariants over what is true, whatever the unit says of it.
//!
//! It sees the track, the desk, the brake line, doors and wheels as they are, and of the unit its contacts alone. What is
//! explained by something else than the unit is a condition with a name, written down in `docs/protection.md`.

use protocol::config::UnitConfig;
use protocol::line::Line;
use protocol::signal::Signal;
use protocol::{Duration, Instant};

use super::authority::Authority;
use super::memory::{Asleep, Blind};
use super::observed::Observed;
use super::permitted::{Limits, Permitted};
use super::place::TrainPlace;

/// Motion above this is no standstill, km/h: standstill tolerance and what wheels and windows make of it.
pub(super) const MOVES_KMH: f64 = 1.08 + 0.4;
/// Speed, km/h, at which a brake has stopped the train.
const STOPPED_KMH: f64 = 0.1;
/// Tolerance of a measured speed, km/h.
const SPEED_OFF_KMH: f64 = 0.6;
/// Time from a cause to a contact, beside what is stated: scans of unit and bench, and window of the speed.
const SLACK: Duration = Duration::from_ms(300);
/// Wheels that slow the train by less do not, m/s².
const SLOWS_MPS2: f64 = 0.3;
/// Traction that is none, N: what an inverter still gives while its order fades.
pub(super) const NO_POWER_N: f64 = 10_000.0;
/// Speed of a jog, km/h.
const JOG_KMH: f64 = 5.0;
/// Sum of ways against or without a direction between two departures, m: tolerance, and one window at the speed of a roll.
const ROLLED_M: f64 = 0.5 + 0.5;
/// Time for which a line that is open applies no brake.
const BOUNCES: Duration = Duration::from_ms(100);
/// Time in which contacts of the desk that chatter brake a train, ms: three seconds by the slowest clock, and half a metre.
const CHATTERS_MS: u64 = 8_000;
/// Time in which the unit knows of a door, and the bench of a tester who is armed.
const TOLD: Duration = Duration::from_ms(1_000);
/// Way with a door open, m, and time in which a train that moves is braked.
const OPEN_WAY_M: f64 = 0.3;
const OPEN_BRAKED_S: f64 = 0.5;

/// Name of a breach of I2 by a train that no stop code stops.
pub(super) const UNDER_STOP: &str = "moves under a stop";

/// Conditions that must hold at any time; numbers are never used again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Invariant {
    /// The train runs only in the direction that its code and its reverser allow.
    I1,
    /// No faster than the code that is there.
    I2,
    /// No way with a door open.
    I3,
    /// Doors are enabled, and open by order, at a platform, on its side, at the place, at rest.
    I4,
    /// The train starts by an act of a person or an order of the wayside, given after the last thing
    /// that stopped the train.
    I5,
    /// The emergency brake is not released in motion.
    I6,
    /// A failed path of a brake is followed by the next brake.
    I7,
    I8,
    /// No power under a brake.
    I9,
    /// ATO drives only where its conditions hold in truth.
    I10,
    /// Tests move and open nothing.
    I11,
}

/// An invariant that was broken, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Breach {
    pub invariant: Invariant,
    pub how: &'static str,
    /// Condition of the scene that explains it.
    pub condition: Option<&'static str>,
}

/// Watches over all invariants.
pub struct Monitor {
    /// Margins of the service brake and of the emergency brake, km/h.
    margins_kmh: [f64; 2],
    limits: Limits,
    authority: Authority,
    place: TrainPlace,
    asleep: Asleep,
    blind: Blind,
    rolled_m: f64,
    open_m: f64,
    /// Greatest speed since they opened, m/s.
    open_mps: f64,
    /// Since when a door is open.
    opened: Option<Instant>,
    /// Whether a door was open when the tester was armed who is.
    armed_open: Option<bool>,
    /// Since when the brake line is open.
    line_open: Option<Instant>,
    released: Option<Instant>,
    /// Since when each condition holds.
    since: Vec<Option<Instant>>,
}

type Condition = (Invariant, &'static str, bool, u64);

impl Monitor {
    pub fn new(config: &UnitConfig, line: &Line) -> Self {
        let fsb_kmh = config.overspeed.fsb_margin_kmh;
        Self {
            margins_kmh: [fsb_kmh, config.overspeed.eb_margin_kmh.unwrap_or(fsb_kmh)],
            limits: Limits::new(config),
            authority: Authority::default(),
            place: TrainPlace::new(line),
            asleep: Asleep::default(),
            blind: Blind::default(),
            rolled_m: 0.0,
            open_m: 0.0,
            open_mps: 0.0,
            opened: None,
            armed_open: None,
            line_open: Some(Instant::ZERO),
            released: None,
            since: Vec::new(),
        }
    }

    /// One scan; what has been broken for longer than is stated.
    pub fn step(&mut self, seen: Observed<'_>) -> Option<Breach> {
        self.place.note(seen);
        let blind = self.blind.note(seen);
        let mut conditions = self.of_speed(seen, blind);
        conditions.extend(self.of_way(seen, blind));
        conditions.extend(self.of_doors(seen, blind));
        conditions.extend(self.of_orders(seen, blind));
        self.since.resize(conditions.len(), None);
        let mut found = None;
        for (since, (invariant, how, holds, ms)) in self.since.iter_mut().zip(conditions) {
            let allowed = Duration::from_ms(ms) + SLACK;
            if !holds {
                *since = None;
            } else if seen.now.since(*since.get_or_insert(seen.now)) > allowed {
                found = found.or(Some((invariant, how)));
            }
        }
        let (invariant, how) = found?;
        let condition = self.place.condition(seen, invariant);
        Some(Breach {
            invariant,
            how,
            condition,
        })
    }

    /// Speed against the code that is there.
    fn of_speed(&mut self, seen: Observed<'_>, blind: bool) -> Vec<Condition> {
        use Invariant::I2;
        let Permitted {
            most_kmh,
            confirmed_kmh,
            selected_kmh,
            keyed,
            admitted,
        } = self.limits.note(seen);
        let braked = seen.on(Signal::EbLoop) || seen.on(Signal::Fsb);
        let kmh = seen.kmh();
        let moves = kmh > MOVES_KMH && !blind;
        let [fsb_kmh, eb_kmh] = self.margins_kmh;
        let beyond = |limit_kmh: f64, margin_kmh: f64, factor: f64| {
            kmh > (limit_kmh + margin_kmh) * factor + SPEED_OFF_KMH
        };
        let above =
            |margin_kmh, factor| most_kmh > 0.0 && beyond(most_kmh, margin_kmh, factor) && !blind;
        let slowed = seen.speed_mps * seen.accel_mps2 < -SLOWS_MPS2 * seen.speed_mps.abs();
        let unslowed = above(eb_kmh, keyed) && !seen.on(Signal::EbLoop) && !slowed;
        vec![
            (I2, "over the limit", above(fsb_kmh, keyed) && !braked, 300),
            (I2, "over the limit, unslowed", unslowed, 6_000),
            (I2, UNDER_STOP, most_kmh == 0.0 && moves && !braked, 500),
            (
                I2,
                "by a code that was not there for long enough",
                moves && beyond(confirmed_kmh, fsb_kmh, keyed) && !braked,
                500,
            ),
            (
                I2,
                "by the code of a neighbouring track",
                moves && beyond(selected_kmh, fsb_kmh, keyed) && !braked,
                500,
            ),
            (
                I2,
                "by a wheel diameter that is refused, or that markers have disproved",
                above(fsb_kmh, admitted) && !braked,
                300,
            ),
            (
                I2,
                "a jog that is fast",
                seen.jogs_back() && beyond(JOG_KMH, 0.0, keyed) && !braked && !blind,
                300,
            ),
        ]
    }

    /// Direction and roll.
    fn of_way(&mut self, seen: Observed<'_>, blind: bool) -> Vec<Condition> {
        use Invariant::{I1, I8};
        let eb = seen.on(Signal::EbLoop);
        // A reverser that chatters is judged by I10.
        let wrong = seen.wrong_way() && !eb && !blind && !seen.chatters;
        if wrong {
            self.rolled_m += seen.speed_mps.abs() * 0.01;
        }
        // By the brake, once the service brake has stopped it, or by a departure, a new sum begins.
        let stopped = seen.on(Signal::Fsb) && seen.kmh() < STOPPED_KMH;
        if eb || blind || stopped || self.authority.begins() {
            self.rolled_m = 0.0;
        }
        let fast = seen.kmh() > JOG_KMH + SPEED_OFF_KMH || seen.traction_n > NO_POWER_N;
        vec![
            (
                I1,
                "runs the wrong way",
                wrong && fast && self.rolled_m > ROLLED_M,
                200,
            ),
            (
                I8,
                "rolls",
                self.rolled_m > ROLLED_M && !seen.on(Signal::Fsb),
                0,
            ),
        ]
    }

    fn of_doors(&mut self, seen: Observed<'_>, blind: bool) -> Vec<Condition> {
        use Invariant::{I3, I4, I11};
        let open = seen.doors_open.contains(&true);
        let braked = seen.on(Signal::EbLoop);
        self.open_m = match open {
            false => 0.0,
            // By the brake a new way begins.
            true if braked || blind => 0.0,
            true => self.open_m + seen.speed_mps.abs() * 0.01,
        };
        let speed_mps = seen.speed_mps.abs();
        self.open_mps = if open {
            self.open_mps.max(speed_mps)
        } else {
            0.0
        };
        self.opened = open.then(|| self.opened.unwrap_or(seen.now));
        // A bench that has not heard the unit for a moment does not know.
        let armed =
            (seen.sample.get(Signal::Armed)).map_or(self.armed_open.is_some(), |on| on > 0.5);
        let long = (self.opened).is_some_and(|since| seen.now.since(since) > TOLD);
        self.armed_open = armed.then(|| self.armed_open.unwrap_or(long));
        let most_m = OPEN_WAY_M + self.open_mps * OPEN_BRAKED_S;
        let enabled = [
            seen.on(Signal::DoorEnableLeft),
            seen.on(Signal::DoorEnableRight),
        ];
        let ordered = [
            seen.on(Signal::DoorOrderLeft),
            seen.on(Signal::DoorOrderRight),
        ];
        let any = enabled.contains(&true);
        let platform = self.place.platform(seen);
        let wrong = (0..2).any(|side| enabled[side] && !platform.sides[side]);
        let unenabled = (0..2).any(|side| ordered[side] && !enabled[side]);
        let forced = (0..2).any(|side| seen.doors_open[side] && !enabled[side]);
        let closes = seen.on(Signal::DoorOrderClose) && forced;
        let supervised = seen.powered && seen.on(Signal::Hcr) && seen.switch() != 0;
        let moves = seen.kmh() > MOVES_KMH && !blind;
        vec![
            (
                I3,
                "moves with a door open",
                open && !braked && self.open_m > most_m,
                0,
            ),
            (
                I3,
                "a door forced open, and no brake",
                forced && supervised && !braked && !seen.on(Signal::Fsb),
                1_000,
            ),
            (I4, "enabled in motion", any && moves, 0),
            (I4, "enabled away from the place", any && !platform.there, 0),
            (
                I4,
                "enabled where no platform is",
                platform.there && wrong,
                0,
            ),
            (I4, "ordered where nothing is enabled", unenabled, 0),
            (I4, "ordered to close where nothing is enabled", closes, 0),
            (
                I11,
                "armed with a door open",
                self.armed_open == Some(true),
                0,
            ),
            (
                I11,
                "enabled by tests",
                armed && any && !platform.there,
                1_000,
            ),
        ]
    }

    /// Starts, brakes and what ATO may.
    fn of_orders(&mut self, seen: Observed<'_>, blind: bool) -> Vec<Condition> {
        use Invariant::{I5, I6, I7, I9, I10, I11};
        let (line, fsb, asked) = (
            seen.on(Signal::EbLoop),
            seen.on(Signal::Fsb),
            seen.on(Signal::Eb),
        );
        let moves = seen.kmh() > MOVES_KMH && !blind;
        // A contact that bounces applies no brake.
        let applied = |since: Instant| seen.now.since(since) > BOUNCES;
        if self.line_open.is_some_and(applied) && !line && moves && !seen.sliding {
            self.released = Some(seen.now);
        }
        self.line_open = line.then(|| self.line_open.unwrap_or(seen.now));
        self.released = self.released.filter(|_| moves && !line);
        let powers = seen.traction_n > NO_POWER_N;
        let off_stop_m = self.place.off_stop_m(seen);
        let unasked = self.authority.lacks(seen, off_stop_m, powers);
        if self.authority.begins() {
            self.place.begin(seen);
        }
        // Wheels that slide are braked as much as the rails let them.
        let ineffective = line
            && seen.driven
            && !seen.sliding
            && seen.speed_mps * seen.accel_mps2 > -SLOWS_MPS2 * seen.speed_mps.abs();
        let hcr = seen.on(Signal::Hcr);
        let fit = hcr && seen.reverser == 1 && seen.doors_open == [false; 2];
        vec![
            (I5, "starts by itself", unasked, 200),
            (
                I6,
                "emergency brake released in motion",
                self.released.is_some(),
                0,
            ),
            (
                I7,
                "the emergency brake's path has failed",
                moves && asked && !line && !fsb,
                1_500,
            ),
            (
                I7,
                "the emergency brake does not act",
                moves && ineffective && asked && !fsb,
                3_500,
            ),
            (I9, "power under the emergency brake", line && powers, 500),
            (I9, "power under the service brake", fsb && powers, 800),
            (
                I9,
                "power not cut with the line open",
                line && seen.sample.get(Signal::PowerCut) == Some(0.0),
                700,
            ),
            (
                I10,
                "ATO drives where it may not",
                seen.by_ato() && moves && !fit && !line && !fsb,
                700,
            ),
            (
                I10,
                "a desk that chatters, unbraked",
                seen.chatters && moves && !line && !fsb,
                CHATTERS_MS,
            ),
            (
                I10,
                "ATO drives by data of another place",
                self.place.driven_by_other(seen),
                500,
            ),
            (I11, "moves by tests", seen.on(Signal::Armed) && powers, 500),
            (I11, "asleep", self.asleep.note(seen) && moves && !line, 500),
        ]
    }
}
