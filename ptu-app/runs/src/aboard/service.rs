//! A service: section after section by the unit's ATO, with doors at the stations, and back to the depot.

use btu_rig::drive::{Drive, DrivePlan, Ending, Outcome};
use btu_rig::rig::LinkTrouble;
use btu_rig::stimulus::{DoorState, Stimulus, WaysideCondition};
use protocol::message::ModeSwitch;
use protocol::signal::Signal;
use protocol::{Duration, SCAN};

use super::{IN_DEPOT, UnitAboard, must};

/// How long doors stand open at a station, and how long the train stands before and after [default].
const OPEN: Duration = Duration::from_ms(20_000);
const CLOSED: Duration = Duration::from_ms(3_000);
/// How long a train takes to come to rest in a depot, at most: from 100 km/h at 1 m/s².
const STANDS_WITHIN: Duration = Duration::from_ms(30_000);
/// Time in which a button is pressed and the unit has answered.
const SETTLES: Duration = Duration::from_ms(1_500);

/// Doors at a station.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doors {
    /// The doors were opened and closed.
    Opened,
    /// The doors stayed closed: the unit enabled neither side.
    NotEnabled,
}

/// End of a section of a service.
#[derive(Clone, Debug)]
pub struct Arrival {
    pub section: u16,
    pub outcome: Outcome,
    /// Doors at the end of the section.
    pub doors: Doors,
}

impl Arrival {
    /// The train stopped by itself, so that the service may go on.
    pub fn stopped(&self) -> bool {
        self.outcome.ending == Ending::Stopped
    }
}

impl UnitAboard {
    /// Drives a section in virtual time, and serves the station at its end. The tester that is connected hears
    /// nothing of it, and the maintenance key is off.
    ///
    /// # Errors
    /// The connection within the train broke, which it cannot.
    pub fn drive(&mut self, plan: DrivePlan) -> Result<Arrival, LinkTrouble> {
        must(self.apply(&Stimulus::MaintenanceKey { on: false }));
        must(self.apply(&Stimulus::Wayside(WaysideCondition::Good)));
        // The next run is prepared from the beginning: ATP leaves and sets Automatic again.
        must(self.apply(&Stimulus::ModeSwitch(ModeSwitch::Manual)));
        self.wait(CLOSED)?;
        let section = plan.section.section;
        let mut drive = Drive::new(DrivePlan {
            tester: false,
            ..plan
        });
        let outcome = loop {
            self.scan()?;
            let now = self.train.now();
            if let Some(outcome) = drive.step(now, &mut self.train.rig) {
                break outcome;
            }
        };
        let doors = self.serve_station()?;
        Ok(Arrival {
            section,
            outcome,
            doors,
        })
    }

    fn serve_station(&mut self) -> Result<Doors, LinkTrouble> {
        self.wait(CLOSED)?;
        let sample = self.rig().sample();
        let on = |signal| sample.get(signal) == Some(1.0);
        let enabled = [on(Signal::DoorEnableLeft), on(Signal::DoorEnableRight)];
        if enabled == [false; 2] {
            return Ok(Doors::NotEnabled);
        }
        for (left, _) in [true, false].into_iter().zip(enabled).filter(|(_, on)| *on) {
            let state = DoorState::Open;
            must(self.apply(&Stimulus::SideDoors { left, state }));
        }
        self.wait(OPEN)?;
        must(self.apply(&Stimulus::Doors { closed: true }));
        self.wait(CLOSED)?;
        Ok(Doors::Opened)
    }

    /// Brings the train to rest and leaves it as one stands in a depot, in virtual time; the driver acknowledges a
    /// brake of the unit.
    ///
    /// # Errors
    /// The connection within the train broke, which it cannot.
    pub fn return_to_depot(&mut self) -> Result<(), LinkTrouble> {
        must(self.apply(&Stimulus::TrainDriven { on: false }));
        let until = self.now() + STANDS_WITHIN;
        while self.now() < until && self.rig().truth().speed_mps != 0.0 {
            self.scan()?;
        }
        IN_DEPOT
            .iter()
            .for_each(|stimulus| must(self.apply(stimulus)));
        self.wait(SETTLES)?;
        must(self.apply(&Stimulus::Acknowledge));
        self.wait(SETTLES)
    }

    fn wait(&mut self, time: Duration) -> Result<(), LinkTrouble> {
        let until = self.now() + time;
        while self.now() + SCAN <= until {
            self.scan()?;
        }
        Ok(())
    }
}
