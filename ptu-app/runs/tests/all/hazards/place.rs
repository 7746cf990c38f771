//! Where the train is in truth: platforms, whether the unit can know it, and what explains that it does not.

use protocol::line::{Line, Section};
use protocol::message::{DoorSide, ModeSwitch};
use protocol::signal::Signal;
use protocol::{Duration, Instant};

use super::monitor::{Invariant, MOVES_KMH, NO_POWER_N};
use super::observed::Observed;

/// Place that may be the stop point's, m: tolerance, and what a position may be off behind the last marker.
const AT_STOP_POINT_M: f64 = 0.3 + 0.5;
/// Time for which what slid, or was laid, may still be believed.
const LATELY: Duration = Duration::from_ms(20_000);
/// Time in which ATO may still correct a stop after the next section was laid.
const CORRECTS: Duration = Duration::from_ms(10_000);
/// Time for which doors that were enabled at the last platform stay so.
const LEFT: Duration = Duration::from_ms(2_000);

/// The platform at which the train stands.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Platform {
    pub there: bool,
    /// Left and right.
    pub sides: [bool; 2],
}

pub(super) struct TrainPlace {
    line: Line,
    section: u16,
    /// Distance to run in the section when the section was laid, m.
    laid_m: Option<f64>,
    laid: Instant,
    /// The section was laid behind another.
    follows: bool,
    /// The train has come to a stop point since the unit has its supply, and since its cab was last left.
    arrived: bool,
    arrivals: usize,
    standing: bool,
    /// Section at whose stop point the train stood when the next was laid.
    ended: Option<u16>,
    /// Section whose data the wayside gave when the last start was allowed.
    begun_with: u16,
    slid: Option<Instant>,
    pulsed_before: usize,
}

impl TrainPlace {
    pub fn new(line: &Line) -> Self {
        Self {
            line: line.clone(),
            section: 0,
            laid_m: None,
            laid: Instant::ZERO,
            follows: false,
            arrived: false,
            arrivals: 0,
            standing: false,
            ended: None,
            begun_with: 0,
            slid: None,
            pulsed_before: 0,
        }
    }

    pub fn note(&mut self, seen: Observed<'_>) {
        if seen.section != self.section {
            self.ended = self.standing.then_some(self.section);
            self.follows = self.section != 0;
            self.section = seen.section;
            self.laid_m = seen.to_stop_m;
            self.laid = seen.now;
            self.pulsed_before = seen.pulsed;
        }
        let at_stop = seen.to_stop_m.is_some_and(|m| m.abs() < AT_STOP_POINT_M);
        let standing = at_stop && seen.kmh() < 0.25;
        if standing && !self.standing {
            self.arrivals += 1;
            self.arrived = true;
        }
        self.standing = standing;
        let cab_left = seen.switch() == ModeSwitch::Off.code() || !seen.on(Signal::Hcr);
        self.arrived &= seen.powered && !cab_left;
        if !seen.powered {
            self.arrivals = 0;
        }
        if seen.sliding {
            self.slid = Some(seen.now);
        }
    }

    /// A start was allowed. A train under way has begun by the data before: another order starts nothing.
    pub fn begin(&mut self, seen: Observed<'_>) {
        if seen.kmh() < MOVES_KMH {
            self.begun_with = seen.told;
        }
    }

    /// Distance to the nearest stop point, m: that of the section's end, or for a while that of the one before.
    pub fn off_stop_m(&self, seen: Observed<'_>) -> Option<f64> {
        let to_stop_m = seen.to_stop_m?.abs();
        let corrects = self.follows && seen.now.since(self.laid) < CORRECTS;
        let left = self.laid_m.filter(|_| corrects);
        let behind_m = left.zip(seen.to_stop_m).map(|(laid, to)| (laid - to).abs());
        Some(to_stop_m.min(behind_m.unwrap_or(f64::INFINITY)))
    }

    fn section(&self) -> Option<&Section> {
        self.line.section(self.section)
    }

    /// The platform of the section's end, or where it begins the one before.
    pub fn platform(&self, seen: Observed<'_>) -> Platform {
        let Some(section) = self.section() else {
            return Platform::default();
        };
        let at_end = seen.to_stop_m.is_some_and(|m| m.abs() < AT_STOP_POINT_M);
        let run_m = self.laid_m.zip(seen.to_stop_m).map(|(laid, to)| laid - to);
        let at_begin = run_m.is_some_and(|m| m.abs() < AT_STOP_POINT_M);
        let of = |section: &Section| match DoorSide::from_label(&section.door_side) {
            Some(DoorSide::Left) => [true, false],
            Some(DoorSide::Right) => [false, true],
            Some(DoorSide::Both) => [true, true],
            _ => [false, false],
        };
        if at_end {
            return Platform {
                there: true,
                sides: of(section),
            };
        }
        // Where the last section ended the train stands at a platform.
        let before = self.line.before(section).filter(|_| at_begin);
        before.map_or_else(Platform::default, |before| Platform {
            there: self.arrived
                || self.ended == Some(before.section)
                || seen.now.since(self.laid) < LEFT,
            sides: of(before),
        })
    }

    /// ATO begins to power by data of another section than it departs into, although the train has stood at a stop point
    /// and the next is known.
    pub fn driven_by_other(&self, seen: Observed<'_>) -> bool {
        let heard = seen.value(Signal::Wayside) == 1.0;
        let run_m = self
            .laid_m
            .zip(seen.to_stop_m)
            .map_or(0.0, |(laid, to)| laid - to);
        let begins = run_m.abs() < 30.0 && seen.now.since(self.laid) > LEFT;
        let powers = seen.by_ato() && seen.traction_n > NO_POWER_N;
        powers && begins && heard && self.arrived && self.begun_with != seen.section
    }

    /// The exported condition that explains a breach.
    pub fn condition(&self, seen: Observed<'_>, invariant: Invariant) -> Option<&'static str> {
        // What wheels measure explains neither a start nor the place that data are of.
        let by_unit = matches!(
            invariant,
            Invariant::I5 | Invariant::I7 | Invariant::I10 | Invariant::I11
        );
        let by_place = matches!(invariant, Invariant::I4 | Invariant::I10);
        let slid = self.slid.is_some_and(|at| seen.now.since(at) < LATELY);
        let alike = seen.displaced[1] != 0.0
            && seen.displaced[1..]
                .iter()
                .all(|by_m| *by_m == seen.displaced[1]);
        let conditions = [
            ("rails_slippery", slid && !by_unit),
            (
                "markers_that_lie_nowhere",
                by_place && seen.pulsed >= self.pulsed_before + 2,
            ),
            (
                "place_lost",
                invariant == Invariant::I10 && seen.displaced != [0.0; 4],
            ),
            (
                "place_unknown",
                by_place && !self.arrived && seen.told != seen.section,
            ),
            (
                "markers_alike_on_unknown_wheels",
                by_place && alike && self.arrivals < 2,
            ),
        ];
        let found = conditions.iter().find(|(_, holds)| *holds);
        found.map(|(name, _)| *name)
    }
}
