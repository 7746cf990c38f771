//! Whose act lets the train start: a person's, or an order of the wayside, after the last thing that stopped it.

use btu_rig::lever::Lever;
use protocol::signal::Signal;
use protocol::{Duration, Instant};

use super::monitor::{MOVES_KMH, NO_POWER_N};
use super::observed::Observed;

/// Time for which a departure is on its way, or an act that was over before its condition may still count.
const ON_ITS_WAY: Duration = Duration::from_ms(1_000);
/// Time at a position of the mode switch by which a person has chosen it.
const CHOSEN: Duration = Duration::from_ms(1_000);
/// Time after which a train that stands does so for the unit, too: its standstill, and the window of its speed.
const STANDS: Duration = Duration::from_ms(1_000);
/// Time in which the brake line closes again behind the lever's emergency brake.
const CLOSES: Duration = Duration::from_ms(300);
/// Way in which ATO may correct a stop, m, and its speed, km/h.
const JOG_M: f64 = 6.2;
const JOG_KMH: f64 = 5.6;

/// Permission that was given, and has not ended.
#[derive(Default)]
pub(super) struct Authority {
    by_hand: bool,
    by_ato: bool,
    lever: f64,
    /// When a person moved the lever from its emergency brake to power.
    from_brake: Option<Instant>,
    switch: u8,
    turned: Instant,
    departure: bool,
    given: Option<Instant>,
    stood: bool,
    /// Since when the train stands.
    still: Option<Instant>,
    begun: bool,
    traction_n: f64,
}

impl Authority {
    /// Power without anybody's act, so far from a stop point, m. One scan.
    pub fn lacks(&mut self, seen: Observed<'_>, off_stop_m: Option<f64>, powers: bool) -> bool {
        let (before_hand, before_ato) = (self.by_hand, self.by_ato);
        self.end(seen);
        self.begin(seen);
        let given_anew = self.by_ato && self.given == Some(seen.now);
        self.begun = self.by_hand && !before_hand || self.by_ato && !before_ato || given_anew;
        let jogs = off_stop_m.is_some_and(|m| m < JOG_M) && seen.kmh() < JOG_KMH;
        // What fades under the brake, and after it, is no start.
        let fades = seen.traction_n < std::mem::replace(&mut self.traction_n, seen.traction_n);
        let powers = powers && !seen.on(Signal::EbLoop) && !fades;
        match seen.by_ato() {
            true => powers && !self.by_ato && !jogs,
            false => powers && !self.by_hand,
        }
    }

    /// A start was allowed in this scan.
    pub fn begins(&self) -> bool {
        self.begun
    }

    fn end(&mut self, seen: Observed<'_>) {
        let switch = seen.switch();
        let enabled = [
            seen.on(Signal::DoorEnableLeft),
            seen.on(Signal::DoorEnableRight),
        ];
        let stands = seen.kmh() < MOVES_KMH;
        // A train under power has begun its run before it moves.
        let still = stands && seen.traction_n <= NO_POWER_N;
        self.still = self.still.filter(|_| still).or(still.then_some(seen.now));
        let forced = (0..2).any(|side| seen.doors_open[side] && !enabled[side] && stands);
        if seen.on(Signal::EbLoop) || forced || !seen.on(Signal::Hcr) || !seen.powered {
            (self.by_hand, self.by_ato) = (false, false);
        }
        if switch != self.switch {
            // From automatic to driverless a run goes on, of a train that does not surely stand.
            let stands = self.still.is_some_and(|at| seen.now.since(at) > STANDS);
            let goes_on = matches!((self.switch, switch), (3, 4) | (4, 3)) && !stands;
            self.by_ato &= goes_on;
            self.turned = seen.now;
        }
        self.switch = switch;
        let at_stop = seen.to_stop_m.is_some_and(|m| m.abs() < JOG_M);
        let stood = stands && at_stop;
        if stood && !self.stood {
            self.by_ato = false;
        }
        self.stood = stood;
        // At driverless no lever drives.
        if seen.value(Signal::Controller) <= 0.0 && stands || switch == 4 {
            self.by_hand = false;
        }
    }

    fn begin(&mut self, seen: Observed<'_>) {
        let lever = seen.value(Signal::Controller);
        let before = std::mem::replace(&mut self.lever, lever);
        let braked = seen.on(Signal::EbLoop);
        // Half of the first notch is told as none.
        if lever > 0.0 && before == Lever::Emergency.number() {
            self.from_brake = Some(seen.now);
        }
        // The act is the same while the line that the lever itself opened closes.
        let released = (self.from_brake).is_some_and(|at| seen.now.since(at) < CLOSES);
        let moved = lever > 0.0 && (before <= 0.0 || released);
        let by_lever = moved && !braked || lever == 0.0;
        self.by_hand |= by_lever && self.switch != 4;
        let heard = seen.value(Signal::Wayside) == 1.0 && seen.powered;
        let departure = seen.on(Signal::Departure) && heard;
        if departure && !std::mem::replace(&mut self.departure, departure) {
            self.given = Some(seen.now);
        }
        self.departure = departure;
        let fresh = self.given.is_some_and(|at| seen.now.since(at) < ON_ITS_WAY);
        let chosen = seen.now.since(self.turned);
        let turned = chosen >= CHOSEN && chosen < CHOSEN + ON_ITS_WAY;
        let driverless = self.switch == 4 && (fresh || turned && departure);
        self.by_ato |= !braked && (seen.start || driverless);
    }
}
