//! Operating modes and the automatic-mode sequence [S2 §3.1]: conditions → Automatic → Automatic
//! Run, with the reason for every refusal.

use protocol::Instant;
use protocol::event::Event;
use protocol::message::{Mode, ModeSwitch, Refusals};

use crate::kernel::EventLog;
use crate::timer::Edge;

/// Refusals that do not hinder Automatic, only Automatic Run.
const RUN_ONLY: Refusals = Refusals::NO_DEPARTURE;
/// Refusals that end Automatic Run once it has begun.
const RUN_ENDS: Refusals = Refusals::DOORS_OPEN
    .union(Refusals::MODE_SWITCH)
    .union(Refusals::CAB_INACTIVE)
    .union(Refusals::CONTROLLER_NOT_NEUTRAL)
    .union(Refusals::EB_APPLIED)
    .union(Refusals::TCMS_NOT_READY)
    .union(Refusals::ATO_NOT_READY)
    .union(Refusals::SELF_TEST);

/// What the sequence looks at.
#[derive(Clone, Copy, Debug)]
pub struct ModeInputs {
    /// Start-up has finished and inputs are alive.
    pub ready: bool,
    /// Cab active.
    pub cab_active: bool,
    /// Mode switch.
    pub switch: ModeSwitch,
    /// Preconditions that do not hold, departure left out.
    pub lacking: Refusals,
    /// Wayside gives departure.
    pub departure: bool,
    /// Start button pressed.
    pub start: bool,
    /// The train has reached the stop point and stands.
    pub arrived: bool,
}

/// The sequence.
#[derive(Debug, Default)]
pub struct ModeSequence {
    mode: Mode,
    start: Edge,
    refusals: Refusals,
}

impl ModeSequence {
    /// One cycle.
    pub fn step(&mut self, now: Instant, inputs: ModeInputs, log: &mut EventLog) {
        let pressed = self.start.rises(inputs.start);
        let departing = match inputs.switch {
            ModeSwitch::Driverless => inputs.departure,
            _ => inputs.departure && pressed,
        };
        self.refusals = inputs.lacking;
        self.refusals.set(Refusals::NO_DEPARTURE, !inputs.departure);
        let next = next(self.mode, &inputs, departing);
        if pressed && next != Mode::AutomaticRun {
            log.push(
                now,
                Event::AutomaticRefused,
                i32::from(self.refusals.bits()),
            );
        }
        if next != self.mode {
            self.mode = next;
            log.push(now, Event::ModeChanged, i32::from(next.code()));
        }
    }

    /// The mode.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Preconditions that do not hold.
    pub fn refusals(&self) -> Refusals {
        self.refusals
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
    // When ATO fails on the way the service brake stops the train first: nobody may be driving.
    let ends = if lacking.contains(Refusals::NOT_STANDSTILL) {
        RUN_ENDS.difference(Refusals::ATO_NOT_READY)
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
mod tests {
    use super::*;

    const GOOD: ModeInputs = ModeInputs {
        ready: true,
        cab_active: true,
        switch: ModeSwitch::Automatic,
        lacking: Refusals::empty(),
        departure: true,
        start: false,
        arrived: false,
    };

    #[test]
    fn the_sequence_is_this_table() {
        let lacking = |r| ModeInputs { lacking: r, ..GOOD };
        let switch = |s| ModeInputs { switch: s, ..GOOD };
        let cases = [
            (Mode::Manual, GOOD, false, Mode::Automatic),
            (Mode::Manual, GOOD, true, Mode::Automatic),
            (Mode::Automatic, GOOD, true, Mode::AutomaticRun),
            (
                Mode::Automatic,
                lacking(Refusals::NO_TWC),
                true,
                Mode::Manual,
            ),
            (
                Mode::AutomaticRun,
                lacking(Refusals::NOT_STANDSTILL),
                false,
                Mode::AutomaticRun,
            ),
            (
                Mode::AutomaticRun,
                lacking(Refusals::NO_TWC),
                false,
                Mode::AutomaticRun,
            ),
            (
                Mode::AutomaticRun,
                lacking(Refusals::DOORS_OPEN),
                false,
                Mode::Manual,
            ),
            (
                Mode::AutomaticRun,
                lacking(Refusals::ATO_NOT_READY),
                false,
                Mode::Manual,
            ),
            (
                Mode::AutomaticRun,
                lacking(Refusals::ATO_NOT_READY.union(Refusals::NOT_STANDSTILL)),
                false,
                Mode::AutomaticRun,
            ),
            (
                Mode::AutomaticRun,
                ModeInputs {
                    arrived: true,
                    ..GOOD
                },
                false,
                Mode::Automatic,
            ),
            (
                Mode::AutomaticRun,
                switch(ModeSwitch::Manual),
                false,
                Mode::Manual,
            ),
            (
                Mode::AutomaticRun,
                ModeInputs {
                    cab_active: false,
                    ..GOOD
                },
                false,
                Mode::Off,
            ),
            (
                Mode::Manual,
                ModeInputs {
                    ready: false,
                    ..GOOD
                },
                true,
                Mode::Off,
            ),
            (Mode::Off, switch(ModeSwitch::Yard), false, Mode::Yard),
            (Mode::Off, switch(ModeSwitch::Unknown(9)), false, Mode::Off),
        ];
        for (from, inputs, departing, to) in cases {
            assert_eq!(
                next(from, &inputs, departing),
                to,
                "{from:?} {inputs:?} {departing}"
            );
        }
    }
}
