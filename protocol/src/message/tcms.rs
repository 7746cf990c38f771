//! TCMS channel: RS-485 between the unit and the train control and monitoring system, once per
//! 50 ms cycle each way [S0, S4].

use super::enums::Mode;
use super::layout::{layout, wire_bits};

wire_bits! {
    /// States TCMS reports to the unit.
    TcmsToAtcBits {
        /// ATO operation is permitted by TCMS.
        ATO_ENABLE = 0,
        /// A brake is not released: the train cannot run.
        BRAKE_NOT_RELEASED = 1,
        /// The train brakes, by the service brake or any other.
        SERVICE_BRAKE_APPLIED = 2,
        /// The emergency brake is applied: its train line is open and not cut out.
        EMERGENCY_BRAKE_APPLIED = 3,
        /// The holding brake is ordered.
        HOLDING_BRAKE_APPLIED = 4,
        /// TCMS cuts powering, for whatever cause.
        POWERING_CUT = 5,
        /// TCMS orders the full service brake, for whatever cause.
        FULL_SERVICE_BRAKE = 6,
        /// The bits below show the train lines as TCMS reads them; without this bit they say nothing.
        TELLS_LINES = 7,
        /// TCMS reads the door line as proved closed.
        DOORS_CLOSED = 8,
        /// TCMS reads the head control relay of the unit's cab as picked up.
        CAB_MANNED = 9,
        /// `speed_cms` shows the speed of the axles that TCMS measures; without this bit the field says nothing.
        TELLS_SPEED = 10,
    }
}

wire_bits! {
    /// Commands and states the unit sends to TCMS.
    AtcToTcmsBits {
        /// Powering (P) command.
        POWER = 0,
        /// Braking (B) command.
        BRAKE = 1,
        /// Holding brake request.
        HOLDING_BRAKE = 2,
        /// ATO is ready.
        ATO_READY = 3,
        /// ATO has failed.
        ATO_FAILED = 4,
        /// Powering drives the train backward: a jog back to the stop point.
        BACKWARD = 5,
        /// Change of cabs asked for: this cab gives the train up, the other takes it [S4].
        CHANGE_OF_CABS = 6,
        /// The train is put away.
        PUT_AWAY = 7,
    }
}

layout! {
    /// State of the train as TCMS has it.
    TcmsToAtc, Tcms, 0x01 {
        /// States.
        bits: TcmsToAtcBits,
        /// Passenger load, units of 100 kg.
        load_100kg: u16,
        /// Alive counter, one up each cycle, wrapping; a counter that stands still is stale.
        alive: u8,
        /// Effort the train gives: -1024 full brake .. 1023 full power, of what is available at this
        /// speed.
        effort: i16,
        /// Mean speed of the motor cars' axles, those that slip or slide left out (S3), cm/s: a second, coarse opinion on the
        /// tachometers. Only with `TELLS_SPEED`.
        speed_cms: u16,
    }
}

layout! {
    /// Orders and state of the unit for TCMS.
    AtcToTcms, Tcms, 0x81 {
        /// Commands and states.
        bits: AtcToTcmsBits,
        /// Operating mode.
        mode: Mode,
        /// Effort: -1024 full brake .. 1023 full power, of what is available at this speed (S4).
        effort: i16,
        /// ATO target speed, cm/s.
        target_cms: u16,
        /// Measured speed, cm/s.
        speed_cms: u16,
    }
}
