//! Operating modes and the automatic-mode sequence [S2 §3.1]: conditions → Automatic → Automatic
//! Run, with the reason for every refusal.
//!
//! When ATO has failed in a run, or TCMS no longer lets it run (permission taken back, link lost, a brake not
//! released), the service brake stops the train first: there may be no driver. Then there is no Automatic until the
//! failure is acknowledged or the mode switch has left its automatic positions.
//!
//! After each run, emergency brake and power-up, a driverless train waits for a new departure or the start button: a
//! departure that is still given began the run before, and acknowledging a brake does not send the train off. It
//! departs once its doors have been served.
//! A departure is new only if it was heard withheld before: neither the first one heard nor one heard again after
//! silence tells when it was given. A departure given on the way, while the emergency brake is applied, or before such
//! a failure is acknowledged, is not new either: that train could not go, and departure has to be given again.
//!
//! When others than the unit open the EB train line, a run ends at once, and the next is barred while the line is open.
//! The service brake stops the train, whether the line is closed again or not, and a driverless train waits for a new
//! departure. So it is when an open door or an inactive cab, also as TCMS reads them, ends a run in motion.

use protocol::Instant;
use protocol::event::Event;
use protocol::message::{Mode, ModeSwitch, Refusals};

use super::contacts::CHOSEN;
use crate::kernel::EventLog;
use crate::timer::{Edge, OnDelay};

/// Refusals that do not hinder Automatic, only Automatic Run.
const RUN_ONLY: Refusals = Refusals::NO_DEPARTURE
    .union(Refusals::DOOR_SEQUENCE)
    .union(Refusals::ORDERED);
/// Refusals that end Automatic Run once it has begun.
const RUN_ENDS: Refusals = Refusals::DOORS_OPEN
    .union(Refusals::MODE_SWITCH)
    .union(Refusals::CAB_INACTIVE)
    .union(Refusals::CONTROLLER_NOT_NEUTRAL)
    .union(Refusals::EB_APPLIED)
    .union(Refusals::TCMS_NOT_READY)
    .union(Refusals::ATO_NOT_READY)
    .union(Refusals::SELF_TEST);

/// Refusals that stop a train in motion: it has no driver, or a door is open.
const STOPS: Refusals = Refusals::DOORS_OPEN.union(Refusals::CAB_INACTIVE);

/// Refusals that stay until they are acknowledged: braking clears them, and driving on would cause them
/// again.
const KEPT: Refusals = Refusals::ATO_NOT_READY.union(Refusals::TCMS_NOT_READY);

#[derive(Clone, Copy, Debug)]
pub struct ModeInputs {
    /// Start-up has finished and inputs are alive.
    pub ready: bool,
    pub cab_active: bool,
    pub switch: ModeSwitch,
    /// Preconditions that do not hold, departure left out.
    pub lacking: Refusals,
    /// Departure is given, and there is somewhere to run to.
    pub departure: bool,
    /// Departure as station data have it: given or withheld; `None` = nothing is heard.
    pub heard: Option<bool>,
    pub start: bool,
    pub acknowledge: bool,
    /// The train stands at the end of its run.
    pub arrived: bool,
    /// A section began: the run that was authorised led through the section before.
    pub relocated: bool,
    /// The train stands away from the stop point, and ATO has given the stop point up.
    pub gave_up: bool,
    /// Others than the unit have opened the emergency brake line.
    pub line_open: bool,
    /// The unit itself reads that line, and does not have it from TCMS alone.
    pub line_fell: bool,
    /// Doors are open on a side that is not enabled.
    pub forced: bool,
}

#[derive(Clone, Debug)]
pub struct ModeSequence {
    mode: Mode,
    start: Edge,
    acknowledge: Edge,
    chosen: OnDelay,
    began: bool,
    /// Departure was heard withheld, and not given since.
    withheld: bool,
    /// Refusals of [`KEPT`] that ended a run and are not acknowledged.
    failed: Refusals,
    /// The next run needs a departure of its own.
    departs_anew: bool,
    stops: bool,
    /// Position of the mode switch in the cycle before.
    switch: ModeSwitch,
    refusals: Refusals,
}

impl ModeSequence {
    pub fn refusals(&self) -> Refusals {
        self.refusals
    }

    /// The line, a door or the cab has ended a run: the service brake stops the train.
    pub fn stops(&self) -> bool {
        self.stops
    }

    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// State at power-up: off; a departure that is given does not count as new.
    pub fn new() -> Self {
        Self {
            mode: Mode::Off,
            start: Edge::default(),
            acknowledge: Edge::default(),
            chosen: OnDelay::default(),
            began: false,
            withheld: false,
            failed: Refusals::empty(),
            departs_anew: true,
            stops: false,
            switch: ModeSwitch::Off,
            refusals: Refusals::empty(),
        }
    }

    pub fn step(&mut self, now: Instant, inputs: ModeInputs, log: &mut EventLog) {
        let pressed = self.start.rises(inputs.start);
        self.keep_failure(&inputs);
        self.stop_after_end(now, &inputs, log);
        let mut inputs = inputs;
        inputs.lacking.insert(self.failed);
        let driverless = inputs.switch == ModeSwitch::Driverless;
        let driverless = self.chosen.update(now, driverless, CHOSEN);
        let departing = inputs.departure
            && !inputs
                .lacking
                .intersects(Refusals::DOOR_SEQUENCE | Refusals::ORDERED)
            && (pressed || driverless && !self.departs_anew);
        self.refusals = inputs.lacking;
        self.refusals.set(Refusals::NO_DEPARTURE, !inputs.departure);
        let turned = core::mem::replace(&mut self.switch, inputs.switch) != inputs.switch;
        let stands = !inputs.lacking.contains(Refusals::NOT_STANDSTILL);
        // A driver who turns the switch at rest has to authorise the next run: in one of its positions a button
        // departs, in the other none is needed.
        inputs.arrived |= inputs.relocated || turned && stands;
        let next = next(self.mode, &inputs, departing);
        if pressed && next != Mode::AutomaticRun {
            log.push(
                now,
                Event::AutomaticRefused,
                i32::from(self.refusals.bits()),
            );
        }
        match (self.mode, next) {
            (Mode::AutomaticRun, Mode::AutomaticRun) => {}
            (Mode::AutomaticRun, _) => self.departs_anew = true,
            (_, Mode::AutomaticRun) => self.departs_anew = false,
            _ => {}
        }
        self.began = next == Mode::AutomaticRun && self.mode != next;
        if next != self.mode {
            self.mode = next;
            log.push(now, Event::ModeChanged, i32::from(next.code()));
        }
    }

    /// Latches the refusals that end a run, and clears them when they are acknowledged.
    fn keep_failure(&mut self, inputs: &ModeInputs) {
        let acknowledged = self.acknowledge.rises(inputs.acknowledge);
        // A departure given while the train is held is not new: whoever releases the train does not send it off.
        let held = inputs
            .lacking
            .intersects(Refusals::EB_APPLIED | Refusals::NOT_STANDSTILL)
            || self.failed();
        let departs = self.new_departure(inputs.heard) && !held;
        let left = !inputs.switch.is_automatic();
        let runs = self.mode == Mode::AutomaticRun;
        let ends = inputs.lacking.intersection(KEPT);
        if runs && !ends.is_empty() {
            self.failed.insert(ends);
            self.departs_anew = true;
            return;
        }
        if left || acknowledged && !runs {
            self.failed = Refusals::empty();
        }
        let braked = inputs.lacking.contains(Refusals::EB_APPLIED);
        // A door that was forced is looked after before the train departs.
        self.departs_anew |= runs && inputs.gave_up || braked || inputs.forced;
        self.departs_anew &= !departs;
    }

    /// Whether a departure is given now after it was withheld.
    fn new_departure(&mut self, heard: Option<bool>) -> bool {
        match heard {
            Some(true) => core::mem::take(&mut self.withheld),
            Some(false) => {
                self.withheld = true;
                false
            }
            None => false,
        }
    }

    /// Stops a train whose run is ended by the line, or in motion by a door or the cab; it does not go on by itself.
    fn stop_after_end(&mut self, now: Instant, inputs: &ModeInputs, log: &mut EventLog) {
        let moves = inputs.lacking.contains(Refusals::NOT_STANDSTILL);
        let lost = moves && inputs.lacking.intersects(STOPS);
        if self.mode == Mode::AutomaticRun && (inputs.line_open || lost) {
            self.departs_anew = true;
            self.stops = true;
        }
        // The emergency brake of a moving train logs its cause itself.
        let braked = inputs.line_fell && moves;
        if self.mode == Mode::AutomaticRun && inputs.line_open && !braked {
            log.push(now, Event::LineOpened, i32::from(!inputs.line_fell));
        }
        self.stops &= inputs.switch.is_automatic() && moves;
    }

    /// An automatic run has begun in the last cycle.
    pub fn begins(&self) -> bool {
        self.began
    }

    /// ATO has failed in a run, or could not go on with it, and that is not acknowledged.
    pub fn failed(&self) -> bool {
        !self.failed.is_empty()
    }

    /// TCMS did not let the run go on.
    pub fn forbidden(&self) -> bool {
        self.failed.contains(Refusals::TCMS_NOT_READY)
    }

    /// The switch is at driverless and no run is under way: no lever drives such a train.
    pub fn unmanned(&self) -> bool {
        self.switch == ModeSwitch::Driverless && self.mode != Mode::AutomaticRun
    }
}

/// The next mode: a table, so that it can be tested as one.
fn next(mode: Mode, inputs: &ModeInputs, departing: bool) -> Mode {
    if !inputs.ready || !inputs.cab_active {
        return Mode::Off;
    }
    match inputs.switch {
        ModeSwitch::Off | ModeSwitch::Unknown(_) => Mode::Off,
        ModeSwitch::Yard => Mode::Yard,
        ModeSwitch::Manual => Mode::Manual,
        ModeSwitch::Emergency => Mode::Emergency,
        ModeSwitch::Automatic | ModeSwitch::Driverless => automatic(mode, inputs, departing),
    }
}

fn automatic(mode: Mode, inputs: &ModeInputs, departing: bool) -> Mode {
    let lacking = inputs.lacking.difference(RUN_ONLY);
    let ends = if lacking.contains(Refusals::NOT_STANDSTILL) {
        RUN_ENDS.difference(KEPT)
    } else {
        RUN_ENDS
    };
    match mode {
        Mode::AutomaticRun if inputs.arrived => Mode::Automatic,
        Mode::AutomaticRun if !lacking.intersects(ends) => Mode::AutomaticRun,
        _ if !lacking.is_empty() => Mode::Manual,
        Mode::Automatic if departing => Mode::AutomaticRun,
        _ => Mode::Automatic,
    }
}

#[cfg(test)]
mod tests;
