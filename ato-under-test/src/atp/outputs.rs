//! What the unit's other functions, and its contacts, take from ATP after a scan.

use protocol::Speed;
use protocol::message::{DoorSide, FsbCause, Outputs};

use super::door_order::enabled_sides;
use super::{Atp, Code, CodeDecoder, EmergencyBrake, ModeSequence, Tachometers};

impl Atp {
    /// States that the output contacts should have.
    pub fn outputs(&self, healthy: bool) -> Outputs {
        let mut outputs = self.doors.enable() | self.door_orders.passed;
        let code_valid = matches!(self.decoder.code, Code::Known(_));
        outputs.set(Outputs::EB_RELAY, !self.brake.applied());
        outputs.set(Outputs::FSB, self.fsb_cause != FsbCause::None);
        outputs.set(Outputs::POWER_CUT, self.power_cut());
        let alarm = self.overspeed.alarm || self.proceeds.warns;
        outputs.set(Outputs::ALARM, alarm);
        outputs.set(Outputs::CODE_VALID, code_valid);
        outputs.set(Outputs::STANDSTILL, self.tachometers.standstill());
        outputs.set(Outputs::HEALTHY, healthy);
        outputs
    }

    pub fn decoder(&self) -> &CodeDecoder {
        &self.decoder
    }

    /// All doors were proved closed in the last scan, and by side closed and locked.
    pub fn doors_closed(&self) -> bool {
        self.doors_closed
    }

    /// Sides on which doors were not proved closed and locked in the last scan.
    pub fn doors_open(&self) -> DoorSide {
        self.doors_open
    }

    /// The mode switch comes to rest at no position: no position counts.
    pub fn switch_chatters(&self) -> bool {
        self.switch.chatters()
    }

    /// Sets the way that a pulse stands for, m.
    pub fn set_pulse(&mut self, pulse_m: f64) {
        self.tachometers.set_pulse(pulse_m);
    }

    /// Doors are open on a side that is not enabled.
    pub fn forced(&self) -> bool {
        self.doors.hold()
    }

    pub fn tachometers(&self) -> &Tachometers {
        &self.tachometers
    }

    pub fn brake(&self) -> &EmergencyBrake {
        &self.brake
    }

    pub fn sequence(&self) -> &ModeSequence {
        &self.sequence
    }

    pub fn limit(&self) -> Speed {
        self.limit
    }

    pub fn enabled(&self) -> DoorSide {
        enabled_sides(self.doors.enable())
    }

    /// ATO may order doors to close. One contact closes all doors, so none may be open on a side that is not
    /// enabled.
    pub fn lets_close(&self) -> bool {
        let enabled = self.enabled();
        // Codes of sides are sets of bits.
        enabled != DoorSide::None && self.doors_open.code() & !enabled.code() == 0
    }

    /// Cause of the full service brake.
    pub fn fsb_cause(&self) -> FsbCause {
        self.fsb_cause
    }
}
