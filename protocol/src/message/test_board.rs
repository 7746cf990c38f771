//! PTU channel: signals of the TEST board, which only an armed unit makes.

use super::enums::{DoorSide, RunningMode};
use super::layout::{layout, wire_bits};

wire_bits! {
    /// Signals the TEST board makes.
    TestSignals {
        /// Speed code into the ATP test coil.
        CODE = 0,
        /// Speed on tachometer input 1.
        SPEED_1 = 1,
        /// Speed on tachometer input 2.
        SPEED_2 = 2,
        /// Station data from the TEST modem into the TWC antenna.
        TWC = 3,
    }
}

layout! {
    /// Speed code into the ATP test coil; answered.
    TestCode, Ptu, 0x10 {
        /// Session number.
        session: u32,
        /// Carrier, Hz.
        carrier_hz: u16,
        /// Code rate, 0.01 Hz; 0 = unmodulated.
        code_rate_chz: u16,
        /// Level, mV, at most 3000.
        level_mv: u16,
    }
}
layout! {
    /// Speed signal in place of the tachometers; answered.
    TestSpeed, Ptu, 0x11 {
        /// Session number.
        session: u32,
        /// Inputs driven: bit 0 = tachometer 1, bit 1 = tachometer 2; not 0.
        channels: u8,
        /// 1 = backward, 0 = forward.
        backward: u8,
        /// Speed to reach, cm/s, at most 3000.
        speed_cms: u16,
        /// Rate of the change, mm/s²; 0 = the board's own 3000.
        accel_mms2: u16,
    }
}
layout! {
    /// One pulse of the test marker; answered.
    TestMarker, Ptu, 0x12 {
        /// Session number.
        session: u32,
        /// Marker 1 to 4.
        marker: u8,
    }
}
layout! {
    /// Station data from the TEST modem into the TWC antenna, every 250 ms; answered.
    TestTwc, Ptu, 0x13 {
        /// Session number.
        session: u32,
        /// Route number.
        route: u16,
        /// Section number.
        section: u16,
        /// This station's number.
        station: u16,
        /// The next station's number.
        next_station: u16,
        /// Loop number.
        loop_id: u16,
        /// Fixed speed, km/h; 255 = none.
        fixed_speed_kmh: u8,
        /// Running mode.
        running_mode: RunningMode,
        /// Door side.
        door_side: DoorSide,
        /// Departure: 1 = given, 0 = held.
        departure: u8,
        /// Train number.
        train_number: u16,
    }
}
layout! {
    /// Takes test signals away; answered.
    TestRelease, Ptu, 0x14 {
        /// Session number.
        session: u32,
        /// Signals to take away; either speed bit takes away both.
        signals: TestSignals,
    }
}
