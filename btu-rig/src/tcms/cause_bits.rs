//! Bit sets of causes and lamps, with a name for each bit as signals show it.

macro_rules! causes {
    ($(#[doc = $doc:literal])* $name:ident { $( $(#[doc = $each:literal])* $bit:ident = $at:literal $label:literal, )* }) => {
        $(#[doc = $doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct $name(u16);

        impl $name {
            $( $(#[doc = $each])* pub const $bit: Self = Self(1 << $at); )*
            /// All of them with their names.
            pub const ALL: &'static [(Self, &'static str)] = &[$( (Self::$bit, $label) ),*];

            /// Puts one in if it holds.
            pub fn set(&mut self, one: Self, on: bool) {
                self.0 = if on { self.0 | one.0 } else { self.0 & !one.0 };
            }

            /// Whether the set has this cause.
            pub fn contains(self, one: Self) -> bool {
                self.0 & one.0 == one.0
            }

            /// Whether no cause holds.
            pub fn is_empty(self) -> bool {
                self.0 == 0
            }

            /// Number of the set in the signal.
            pub fn bits(self) -> u16 {
                self.0
            }
        }
    };
}

causes! {
    /// Reasons for cutting powering (S3, S4). Scripts can make every one on the bench but two: `not_released`
    /// takes an injected fault of a brake, `atc_silent` a unit that falls silent.
    PowerCuts {
        /// Doors not proved closed.
        DOORS = 0 "doors",
        /// No head control relay energised, or both.
        HCR = 1 "hcr",
        /// Reverser in neutral.
        REVERSER = 2 "reverser",
        /// Emergency brake train line de-energised.
        EMERGENCY = 3 "emergency",
        /// Full service brake by TCMS, or the controller at B7 (BCYPCUT).
        FULL_SERVICE = 4 "full_service",
        /// ATC's powering cut contact.
        ATC = 5 "atc",
        /// The unit's contacts are not heard.
        ATC_SILENT = 6 "atc_silent",
        /// ATO asks for the holding brake.
        HOLDING = 7 "holding",
        /// Security brake.
        SECURITY = 8 "security",
        /// Parking brake.
        PARKING = 9 "parking",
        /// A brake is not released.
        NOT_RELEASED = 10 "not_released",
        /// Main reservoir pressure low.
        MAIN_RESERVOIR = 11 "main_reservoir",
        /// No mode, or more than one.
        MODE = 12 "mode",
        /// Driverless initialisation or turn-back.
        TURN_BACK = 13 "turn_back",
    }
}

causes! {
    /// Causes that open the emergency brake train line (S4).
    EbSources {
        /// Master controller of the active cab.
        CONTROLLER = 0 "controller",
        /// Push button in the first cab.
        BUTTON_1 = 1 "button_1",
        /// Push button in the other cab.
        BUTTON_2 = 2 "button_2",
        /// ATC's relay.
        ATC = 3 "atc",
        /// Pressure switch of the main reservoir.
        MAIN_RESERVOIR = 4 "main_reservoir",
        /// No head control relay energised, or both.
        HCR = 5 "hcr",
    }
}

causes! {
    /// Lamps in the cabs (S4).
    Lamps {
        /// Emergency brake, in both cabs.
        EMERGENCY = 0 "emergency",
        /// Emergency brake cut out, in both cabs.
        EB_CUT_OUT = 1 "eb_cut_out",
        /// Security brake, until it is released.
        SECURITY = 2 "security",
        /// Parking brake, until it is released.
        PARKING = 3 "parking",
        /// Brakes released by force.
        FORCED_RELEASE = 4 "forced_release",
        /// A brake is not released (monitor).
        NOT_RELEASED = 5 "not_released",
        /// A part has failed (monitor).
        FAILURE = 6 "failure",
    }
}
