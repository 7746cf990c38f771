//! Links to the embedded unit through the same frames as on a cable.

use ato_under_test::flash::BlockDevice;
use ato_under_test::{Port, Setup, Unit};
use btu_rig::rig::{LinkTrouble, UnitLink};
use protocol::{Duration, Instant};

/// Serial number of the embedded unit when none is asked for.
pub const SIM_SERIAL: &str = "SIM-0001";

/// Shortest time without supply: the unit's capacitors empty, relays fall, and the train notices that the unit is
/// silent and hears it again afterwards [default].
const LEAST_OFF: Duration = Duration::from_ms(1_500);

/// A unit that is powered up at a chosen time, reached at its harness.
pub struct SimLink {
    setup: Setup,
    /// When the supply is switched on; `None` = it stays off.
    power_at: Option<Instant>,
    /// Earliest time at which the supply comes back.
    may_power_at: Instant,
    unit: Option<Unit>,
    /// Flash of the unit while the unit is without supply; `None` = a new one.
    flash: Option<Box<dyn BlockDevice>>,
    /// Seed of the arm challenges; `None` = the link's seed.
    challenges: Option<u64>,
}

impl SimLink {
    /// A unit made from `setup`, powered at `power_at`.
    pub fn new(setup: Setup, power_at: Instant) -> Self {
        Self {
            setup,
            power_at: Some(power_at),
            may_power_at: Instant::ZERO,
            unit: None,
            flash: None,
            challenges: None,
        }
    }

    /// Sets the flash that the unit had before; the unit must not be powered up yet.
    pub(crate) fn set_flash(&mut self, flash: Box<dyn BlockDevice>) {
        debug_assert!(self.unit.is_none(), "powered up");
        self.flash = Some(flash);
    }

    /// Draws arm challenges from another seed, which nobody outside knows.
    pub(crate) fn draw_challenges(&mut self, seed: u64) {
        self.challenges = Some(seed);
    }

    /// Switches the supply off, or on if it was off: the unit is powered up again then.
    pub fn set_power(&mut self, now: Instant, on: bool) {
        match (on, self.power_at) {
            (false, Some(_)) => {
                self.power_at = None;
                self.may_power_at = now + LEAST_OFF;
                self.flash = self.unit.take().map(Unit::power_off).or(self.flash.take());
            }
            (true, None) => self.power_at = Some(now.max(self.may_power_at)),
            _ => {}
        }
    }

    pub(crate) fn powered(&self) -> bool {
        self.unit.is_some()
    }

    /// Hands over what came at the maintenance port; without supply nothing is heard.
    pub(crate) fn receive_maintenance(&mut self, bytes: &[u8]) {
        if let Some(unit) = &mut self.unit {
            unit.receive_at(Port::Maintenance, bytes);
        }
    }

    /// Appends what the unit sent at the maintenance port in the last scan.
    pub(crate) fn take_maintenance(&mut self, out: &mut Vec<u8>) {
        if let Some(unit) = &mut self.unit {
            unit.take_maintenance(out);
        }
    }

    /// Another tester is connected at the maintenance port from now on.
    pub(crate) fn reset_maintenance(&mut self) {
        if let Some(unit) = &mut self.unit {
            unit.reset_connection(Port::Maintenance);
        }
    }

    /// Frames accepted at the maintenance port since power-up.
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
    ) -> Result<(), LinkTrouble> {
        let Some(power_at) = self.power_at.filter(|at| now >= *at) else {
            return Ok(());
        };
        let unit = self.unit.get_or_insert_with(|| {
            let setup = self.setup.clone();
            let mut unit = match self.flash.take() {
                Some(flash) => Unit::with_flash(setup, flash),
                None => Unit::new(setup),
            };
            if let Some(seed) = self.challenges {
                // Other challenges at each power-up.
                unit.draw_challenges(seed ^ power_at.as_us());
            }
            unit
        });
        unit.receive(to_unit);
        unit.step(Instant::ZERO + now.since(power_at), from_unit);
        Ok(())
    }
}
