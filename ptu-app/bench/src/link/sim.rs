//! Links to the embedded unit through the same frames as on a cable.

use ato_under_test::{Port, Setup, Unit};
use btu_rig::rig::{LinkFailure, UnitLink};
use protocol::Instant;

/// Serial number of the embedded unit when none is asked for.
pub const SIM_SERIAL: &str = "SIM-0001";

/// A unit that is powered up at a chosen time, reached at its harness.
pub struct SimLink {
    setup: Setup,
    /// When the supply is switched on; `None` = it stays off.
    power_at: Option<Instant>,
    unit: Option<Unit>,
}

impl SimLink {
    /// A unit made from `setup`, powered at `power_at`.
    pub fn new(setup: Setup, power_at: Instant) -> Self {
        Self {
            setup,
            power_at: Some(power_at),
            unit: None,
        }
    }

    /// Switches the supply off, or on at `now` if it was off: the unit is powered up anew then.
    pub(crate) fn set_power(&mut self, now: Instant, on: bool) {
        if !on {
            self.power_at = None;
            self.unit = None;
        } else if self.power_at.is_none() {
            self.power_at = Some(now);
        }
    }

    /// The supply is on.
    pub(crate) fn powered(&self) -> bool {
        self.unit.is_some()
    }

    /// Hands over what came at the maintenance port; without supply nothing is heard.
    pub(crate) fn receive_maintenance(&mut self, bytes: &[u8]) {
        if let Some(unit) = &mut self.unit {
            unit.receive_at(Port::Maintenance, bytes);
        }
    }

    /// Appends what the last scan sent there.
    pub(crate) fn take_maintenance(&mut self, out: &mut Vec<u8>) {
        if let Some(unit) = &mut self.unit {
            unit.take_maintenance(out);
        }
    }

    /// Another tester is connected there from now on.
    pub(crate) fn reset_maintenance(&mut self) {
        if let Some(unit) = &mut self.unit {
            unit.reset_connection(Port::Maintenance);
        }
    }

    /// Frames accepted there since power-up.
    pub(crate) fn maintenance_accepted(&self) -> u64 {
        let unit = self.unit.as_ref();
        unit.map_or(0, |unit| unit.frames_accepted(Port::Maintenance))
    }
}

impl UnitLink for SimLink {
    fn exchange(
        &mut self,
        now: Instant,
        to_unit: &[u8],
        from_unit: &mut Vec<u8>,
    ) -> Result<(), LinkFailure> {
        let Some(power_at) = self.power_at.filter(|at| now >= *at) else {
            return Ok(());
        };
        let setup = &self.setup;
        let unit = self.unit.get_or_insert_with(|| Unit::new(setup.clone()));
        unit.receive(to_unit);
        unit.step(Instant::ZERO + now.since(power_at), from_unit);
        Ok(())
    }
}
