//! Bit sets of causes and lamps. Signals and scripts call each bit by its name in small letters.

use bitflags::{Flags, bitflags};

/// Names of the bits that are set.
pub fn names_of<Set: Flags<Bits = u16>>(bits: u16) -> Vec<String> {
    let set = Set::from_bits_truncate(bits);
    set.iter_names()
        .map(|(name, _)| name.to_lowercase())
        .collect()
}

bitflags! {
    /// Reasons for cutting powering (S3, S4). Scripts can make every one on the bench but two: `not_released`
    /// takes an injected fault of a brake, `atc_silent` a unit that falls silent.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct PowerCuts: u16 {
        /// Doors not proved closed.
        const DOORS = 1 << 0;
        /// No head control relay energised, or both.
        const HCR = 1 << 1;
        /// Reverser in neutral.
        const REVERSER = 1 << 2;
        /// Emergency brake: its train line is open and not cut out.
        const EMERGENCY = 1 << 3;
        /// Full service brake by TCMS, or the controller at B7 (BCYPCUT).
        const FULL_SERVICE = 1 << 4;
        /// ATC's powering cut contact.
        const ATC = 1 << 5;
        /// The unit's contacts are not heard.
        const ATC_SILENT = 1 << 6;
        /// ATO asks for the holding brake.
        const HOLDING = 1 << 7;
        /// Security brake.
        const SECURITY = 1 << 8;
        /// Parking brake.
        const PARKING = 1 << 9;
        /// A brake is not released.
        const NOT_RELEASED = 1 << 10;
        /// Main reservoir pressure low.
        const MAIN_RESERVOIR = 1 << 11;
        /// No mode: no cab is active, or its mode switch is off.
        const MODE = 1 << 12;
        /// Driverless initialisation or turn-back.
        const TURN_BACK = 1 << 13;
    }
}

bitflags! {
    /// Causes that open the emergency brake train line (S4).
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct EbSources: u16 {
        /// Master controller of the active cab.
        const CONTROLLER = 1 << 0;
        /// Push button in the first cab.
        const BUTTON_1 = 1 << 1;
        /// Push button in the other cab.
        const BUTTON_2 = 1 << 2;
        /// ATC's relay.
        const ATC = 1 << 3;
        /// Pressure switch of the main reservoir.
        const MAIN_RESERVOIR = 1 << 4;
        /// No head control relay energised, or both.
        const HCR = 1 << 5;
    }
}

bitflags! {
    /// Lamps in the cabs (S4).
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct Lamps: u16 {
        /// Emergency brake, in both cabs.
        const EMERGENCY = 1 << 0;
        /// Emergency brake cut out, in both cabs.
        const EB_CUT_OUT = 1 << 1;
        /// Security brake, until it is released.
        const SECURITY = 1 << 2;
        /// Parking brake, until it is released.
        const PARKING = 1 << 3;
        /// Brakes released by force.
        const FORCED_RELEASE = 1 << 4;
        /// A brake is not released (monitor).
        const NOT_RELEASED = 1 << 5;
        /// A part has failed (monitor).
        const FAILURE = 1 << 6;
    }
}
