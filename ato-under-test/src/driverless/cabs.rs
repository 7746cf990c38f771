//! Turn-back with change of cabs [S4].
//!
//! On a turn-back order ([`Cabs::turn_back`]) the unit holds the train and asks TCMS for the change of cabs. TCMS drops
//! this cab's head control relay and picks up the other cab's: the unit goes to mode off, which applies its emergency
//! brake. The cab whose relay picks up while the mode switch is at driverless takes the train over and holds it:
//! station data of the section that leaves from there must come without a departure first, so that the departure that
//! follows is meant for this cab.

use protocol::event::{Event, RELAY_DROPPED};
use protocol::message::OrderState;
use protocol::{Duration, Instant};

use crate::kernel::EventLog;

/// Parameters of [`Event::ChangeOfCabs`].
const HANDED_OVER: i32 = 1;
const TAKEN_OVER: i32 = 2;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Stage {
    #[default]
    Idle,
    Asked {
        since: Instant,
    },
    HandedOver,
    TakingOver,
    Ready,
    Failed,
}

/// Inputs of the change of cabs in a cycle.
#[derive(Clone, Copy, Debug, Default)]
pub struct CabInputs {
    /// Head control relay of this cab; `None` = the inputs are lost.
    pub hcr: Option<bool>,
    /// TCMS reads that relay as dropped.
    pub dropped_by_tcms: bool,
    /// The mode switch is at driverless.
    pub driverless: bool,
    pub standstill: bool,
    /// An automatic run is under way.
    pub running: bool,
    /// Station of valid station data, if they are for the beginning of a section.
    pub departs_from: Option<u16>,
    pub departure: bool,
}

/// Decides which cab has the train, as far as turn-backs change that.
#[derive(Clone, Debug, Default)]
pub struct Cabs {
    stage: Stage,
    hcr: Option<bool>,
    /// Station at which this cab gave the train up.
    given_up_at: Option<u16>,
}

impl Cabs {
    /// Begins a turn-back at this station.
    pub fn turn_back(&mut self, now: Instant, station: u16) {
        self.stage = Stage::Asked { since: now };
        self.given_up_at = Some(station);
    }

    /// One cycle; the cabs must be changed within `most`.
    pub fn step(&mut self, now: Instant, inputs: CabInputs, most: Duration, log: &mut EventLog) {
        let before = self.hcr;
        self.hcr = inputs.hcr.or(before);
        let hcr = self.hcr == Some(true);
        let braked = inputs.standstill || self.stage == Stage::HandedOver;
        let picked_up = before == Some(false) && hcr && braked;
        let stage = match self.stage {
            Stage::Asked { .. } if inputs.hcr == Some(false) => {
                log.push(now, Event::ChangeOfCabs, HANDED_OVER);
                Stage::HandedOver
            }
            Stage::HandedOver if !hcr => Stage::HandedOver,
            _ if picked_up && inputs.driverless => {
                log.push(now, Event::ChangeOfCabs, TAKEN_OVER);
                Stage::TakingOver
            }
            // Somebody in the cab has taken the train.
            _ if !inputs.driverless => Stage::Idle,
            Stage::Asked { since } if now.since(since) >= most => {
                let dropped = if inputs.dropped_by_tcms {
                    RELAY_DROPPED
                } else {
                    0
                };
                log.push(now, Event::CabsNotChanged, dropped);
                Stage::Failed
            }
            Stage::TakingOver if self.may_leave(&inputs) => Stage::Ready,
            Stage::Ready if inputs.running => Stage::Idle,
            other => other,
        };
        self.stage = stage;
        if !self.busy() {
            self.given_up_at = None;
        }
    }

    /// Station data are for a section from where the train was given up, and departure is still to come.
    fn may_leave(&self, inputs: &CabInputs) -> bool {
        let here = |station| self.given_up_at.is_none_or(|at| at == station);
        inputs.departs_from.is_some_and(here) && !inputs.departure
    }

    /// TCMS is asked to change the cabs.
    pub fn asks(&self) -> bool {
        matches!(self.stage, Stage::Asked { .. })
    }

    pub fn handed_over(&self) -> bool {
        self.stage == Stage::HandedOver
    }

    /// The holding brake is asked for.
    pub fn holds(&self) -> bool {
        !matches!(self.stage, Stage::Idle | Stage::Ready | Stage::HandedOver)
    }

    /// No run may begin.
    pub fn bars_run(&self) -> bool {
        !matches!(self.stage, Stage::Idle | Stage::Ready)
    }

    /// A turn-back is under way, or this cab does not have the train.
    pub fn busy(&self) -> bool {
        matches!(
            self.stage,
            Stage::Asked { .. } | Stage::HandedOver | Stage::TakingOver
        )
    }

    pub fn state(&self) -> OrderState {
        match self.stage {
            Stage::Idle => OrderState::Idle,
            Stage::Asked { .. } => OrderState::TurningBack,
            Stage::HandedOver => OrderState::HandedOver,
            Stage::TakingOver => OrderState::TakingOver,
            Stage::Ready => OrderState::Ready,
            Stage::Failed => OrderState::Failed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::with;

    const MOST: Duration = Duration::from_ms(6000);
    const STATION: u16 = 824;

    const STANDING: CabInputs = CabInputs {
        hcr: Some(true),
        dropped_by_tcms: false,
        driverless: true,
        standstill: true,
        running: false,
        departs_from: None,
        departure: false,
    };

    /// State after the given inputs, 50 ms each, with a cab that begins in this stage.
    fn after(stage: Stage, inputs: &[CabInputs]) -> OrderState {
        let mut cabs = Cabs {
            stage,
            hcr: Some(!matches!(stage, Stage::HandedOver)),
            given_up_at: Some(STATION),
        };
        let mut log = EventLog::default();
        for (at, inputs) in inputs.iter().enumerate() {
            cabs.step(Instant::from_ms(50 * at as u64), *inputs, MOST, &mut log);
        }
        cabs.state()
    }

    #[test]
    fn the_change_of_cabs_is_this_table() {
        let asked = Stage::Asked {
            since: Instant::ZERO,
        };
        let off = with(STANDING, |it| it.hcr = Some(false));
        let lost = with(STANDING, |it| it.hcr = None);
        let manual = with(STANDING, |it| it.driverless = false);
        let moves = with(STANDING, |it| it.standstill = false);
        let data = |station, departure| CabInputs {
            departs_from: Some(station),
            departure,
            ..STANDING
        };
        let runs = with(STANDING, |it| it.running = true);
        use OrderState::{Failed, HandedOver, Idle, Ready, TakingOver, TurningBack};
        let cases: [(Stage, &[CabInputs], OrderState); 19] = [
            (Stage::Idle, &[STANDING], Idle),
            (Stage::Idle, &[off], Idle),
            (Stage::Idle, &[off, STANDING], TakingOver),
            (Stage::Idle, &[off, moves], Idle),
            (Stage::Idle, &[lost, STANDING], Idle),
            (asked, &[STANDING, lost, STANDING], TurningBack),
            (asked, &[off], HandedOver),
            (asked, &[manual], Idle),
            (asked, &[STANDING; 122], Failed),
            (Stage::HandedOver, &[off, off, lost], HandedOver),
            (Stage::HandedOver, &[off, STANDING], TakingOver),
            (
                Stage::HandedOver,
                &[with(manual, |it| it.hcr = Some(true))],
                Idle,
            ),
            (Stage::TakingOver, &[data(STATION, true)], TakingOver),
            (Stage::TakingOver, &[data(STATION + 1, false)], TakingOver),
            (Stage::TakingOver, &[data(STATION, false)], Ready),
            (Stage::TakingOver, &[manual], Idle),
            (Stage::Ready, &[runs], Idle),
            (Stage::Failed, &[STANDING, lost], Failed),
            (Stage::Failed, &[manual], Idle),
        ];
        for (stage, inputs, expected) in cases {
            assert_eq!(after(stage, inputs), expected, "{stage:?} {inputs:?}");
        }
    }

    /// A train that is not ready to depart is held, or has its emergency brake applied because the cab is given up.
    #[test]
    fn the_train_is_held_for_as_long_as_it_may_not_leave() {
        for stage in [
            Stage::Idle,
            Stage::Asked {
                since: Instant::ZERO,
            },
            Stage::HandedOver,
            Stage::TakingOver,
            Stage::Ready,
            Stage::Failed,
        ] {
            let cabs = Cabs {
                stage,
                ..Cabs::default()
            };
            let braked = cabs.holds() || cabs.handed_over();
            assert_eq!(cabs.bars_run(), braked, "{stage:?}");
        }
    }

    #[test]
    fn a_cab_that_takes_the_train_over_without_having_had_it_takes_any_station() {
        let mut cabs = Cabs::default();
        let mut log = EventLog::default();
        let mut step = |cabs: &mut Cabs, inputs| cabs.step(Instant::ZERO, inputs, MOST, &mut log);
        for hcr in [Some(false), Some(true)] {
            step(&mut cabs, CabInputs { hcr, ..STANDING });
        }
        assert_eq!(cabs.state(), OrderState::TakingOver);
        let data = with(STANDING, |it| it.departs_from = Some(7));
        step(&mut cabs, data);
        assert_eq!(cabs.state(), OrderState::Ready);
    }
}
