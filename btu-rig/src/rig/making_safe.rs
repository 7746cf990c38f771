//! Makes the bench safe: back to the quiescent state, as fast as the unit allows.

use protocol::Instant;

use super::Rig;
use super::train_side::DoorGear;
use crate::stimulus::{TachoCondition, WaysideCondition};
use crate::train::EquipmentFaults;

impl Rig {
    /// Goes back to the quiescent state: at once where possible; what a turning wheel needs (code, reverser,
    /// tachometers) only at standstill, so that the unit sees nothing implausible.
    pub fn make_safe(&mut self, now: Instant) {
        self.train_driven = false;
        self.wheel.stop();
        self.antenna.drift(0.0, 0.0);
        self.markers.clear();
        self.desk.set_doors(true);
        self.desk.line_said = Default::default();
        self.door_gear = DoorGear::default();
        self.tcms_port.reset();
        self.wayside.condition = WaysideCondition::Good;
        self.tester.make_safe(now);
        self.making_safe = true;
        self.finish_making_safe();
    }

    /// Quiescent: at standstill, tester listening, nothing under way.
    pub fn safe(&self) -> bool {
        !self.making_safe && !self.train_driven && self.wheel.standing() && self.tester.safe()
    }

    /// Once the wheels stand and the unit is disarmed, the rest of the bench rests, too. An armed unit that saw key,
    /// mode switch or code change would conclude that the train is no longer being tested, and brake.
    pub(super) fn finish_making_safe(&mut self) {
        if self.making_safe && self.wheel.standing() && self.tester.safe() {
            self.rest_quiescent();
        }
    }

    pub(super) fn rest_quiescent(&mut self) {
        self.making_safe = false;
        self.quiescent = true;
        self.tcms.rest();
        self.train.set_conditions(&self.conditions);
        self.made = EquipmentFaults::default();
        self.fail_equipment();
        self.antenna.off();
        self.codes_along = false;
        self.track = None;
        self.desk.reset(self.now);
        self.wayside.reset(&self.line.sections[0]);
        let distance_m = self.wheel.axle.distance_m;
        for tacho in &mut self.tachos {
            tacho.set_condition(TachoCondition::Good, distance_m);
        }
    }
}
