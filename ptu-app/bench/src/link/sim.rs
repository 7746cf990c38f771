//! Links to the embedded unit through the same frames as on a cable.

use ato_under_test::{Setup, Unit};
use btu_rig::rig::{LinkFailure, UnitLink};
use protocol::Instant;

/// Serial number of the embedded unit when none is asked for.
pub const SIM_SERIAL: &str = "SIM-0001";

/// A unit that is powered up at a chosen time.
pub struct SimLink {
    setup: Option<Setup>,
    power_at: Instant,
    unit: Option<Unit>,
}

impl SimLink {
    /// A unit made from `setup`, powered at `power_at`.
    pub fn new(setup: Setup, power_at: Instant) -> Self {
        Self {
            setup: Some(setup),
            power_at,
            unit: None,
        }
    }
}

impl UnitLink for SimLink {
    fn exchange(
        &mut self,
        now: Instant,
        to_unit: &[u8],
        from_unit: &mut Vec<u8>,
    ) -> Result<(), LinkFailure> {
        if now >= self.power_at
            && let Some(setup) = self.setup.take()
        {
            self.unit = Some(Unit::new(setup));
        }
        if let Some(unit) = &mut self.unit {
            unit.receive(to_unit);
            unit.step(Instant::ZERO + now.since(self.power_at), from_unit);
        }
        Ok(())
    }
}
