//! States of the contacts, and frames to TCMS: as the functions ask, but while a tester is armed never more than lets a
//! train stand.

use protocol::Instant;
use protocol::message::{Mode, Outputs};

use super::Unit;
use super::functions::Functions;

const DOORS: Outputs = Outputs::DOOR_ENABLE_LEFT.union(Outputs::DOOR_ENABLE_RIGHT);
/// Outputs that are set if either of two instances asks for them.
const EITHER: Outputs = Outputs::FSB
    .union(Outputs::POWER_CUT)
    .union(Outputs::ALARM)
    .union(Outputs::HOLDING_BRAKE);
/// Outputs that both instances must set: they release the train, or say that the unit is well.
const BOTH: Outputs = Outputs::EB_RELAY
    .union(Outputs::STANDSTILL)
    .union(Outputs::HEALTHY);

impl Unit {
    /// The instance of the functions that a tester sees: under test while armed.
    pub(super) fn tested(&self) -> &Functions {
        self.test_mode
            .as_ref()
            .map_or(&self.functions, |mode| &mode.functions)
    }

    /// Outputs of the functions that a tester sees.
    pub(super) fn asked(&self) -> Outputs {
        self.outputs_of(self.tested())
    }

    /// Outputs that the contacts should have.
    pub(super) fn wanted(&self, now: Instant) -> Outputs {
        let train = self.outputs_of(&self.functions);
        if !self.maintenance.holds_brake(now) {
            return train;
        }
        let tested = self.asked();
        let mut wanted = (train | tested) & EITHER | train & tested & BOTH;
        wanted |= tested & Outputs::CODE_VALID;
        if !self.guards.door_bar {
            wanted |= tested & DOORS;
        }
        if self.guards.brake_hold {
            wanted |= Outputs::FSB | Outputs::POWER_CUT;
            wanted.set(
                Outputs::EB_RELAY,
                wanted.contains(Outputs::EB_RELAY) && self.tcms.full_service_brake_applied(),
            );
        }
        wanted
    }

    /// Effort for TCMS, −1024..1023, and the mode that is sent to it.
    pub(super) fn commands(&self, now: Instant) -> (i16, Mode) {
        let of = |functions: &Functions| {
            let mode = functions.atp.sequence().mode();
            (functions.ato_outputs.effort, mode)
        };
        let (effort, mode) = of(&self.functions);
        if !self.maintenance.holds_brake(now) {
            return (effort, mode);
        }
        let (tested_effort, tested_mode) = of(self.tested());
        let effort = match self.guards.traction_bar {
            true => effort.min(0),
            false => tested_effort,
        };
        let mode = match self.guards.start_bar {
            true => mode,
            false => tested_mode,
        };
        (effort, mode)
    }

    fn outputs_of(&self, functions: &Functions) -> Outputs {
        let healthy =
            self.self_tester.vital_passed() && functions.inputs.alive && self.relay_watch.sound();
        let mut outputs = functions.atp.outputs(healthy);
        outputs.set(Outputs::HOLDING_BRAKE, functions.holds());
        // ATP drops an order to open one scan after it was taken back: both orders are never given at once.
        let opens = outputs.intersects(Outputs::OPEN_LEFT | Outputs::OPEN_RIGHT);
        let closes = functions.station.closes() && functions.atp.lets_close();
        outputs.set(Outputs::CLOSE_DOORS, closes && !opens);
        outputs
    }
}
