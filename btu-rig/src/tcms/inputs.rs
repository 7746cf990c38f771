//! Inputs of TCMS in a scan: cabs, train lines, the unit's contacts, the equipment's reports.

use protocol::message::{ModeSwitch, Outputs};

use crate::train::{CarSet, Equipment};

use super::controller::ControllerInputs;

/// One cab as wired to TCMS.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CabInputs {
    /// Head control relay energised.
    pub hcr: bool,
    /// Reverser: 1, 0 or −1.
    pub reverser: i8,
    /// Position of the mode switch.
    pub mode_switch: ModeSwitch,
    /// Contacts and potentiometer of the master controller.
    pub controller: ControllerInputs,
    /// The dead man is held.
    pub dead_man: bool,
    /// Emergency push button pressed.
    pub emergency_button: bool,
    /// Button for release by force pressed.
    pub forced_release: bool,
}

/// Inputs of TCMS in one scan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TcmsInputs<'a> {
    /// Both cabs; the unit is in the first.
    pub cabs: [CabInputs; 2],
    pub doors_closed: bool,
    /// Pressure switch of the main reservoir.
    pub main_reservoir_low: bool,
    /// The emergency brake is cut out.
    pub eb_cut_out: bool,
    /// Security brake applied: hard-wired; TCMS takes electric effort to 0, cuts powering and lights the lamp (S3, S4).
    pub security_brake: bool,
    /// Parking brake applied, by springs: TCMS cuts powering and lights the lamp (S4).
    pub parking_brake: bool,
    /// Driverless initialisation or turn-back.
    pub turn_back: bool,
    pub brakes_cut_out: CarSet,
    pub inverters_cut_out: CarSet,
    /// The unit's contacts; `None` = not heard. Its relay in the emergency brake line counts as open
    /// then, so that the train brakes, and powering is cut; the contacts for full service and holding
    /// brake are not read.
    pub contacts: Option<Outputs>,
    /// Passengers as the brake control units weigh them, kg.
    pub load_kg: f64,
    /// State of the equipment; `None` = generators turn the wheels, and the equipment counts as
    /// sound.
    pub equipment: Option<&'a Equipment>,
    /// Speed of the wheels while generators turn them, m/s, never negative.
    pub speed_mps: f64,
    /// Frames of the unit that were refused so far.
    pub frames_refused: u32,
}

impl TcmsInputs<'_> {
    /// The cab whose head control relay is energised, the only one whose commands count; none when
    /// both are.
    pub fn active_cab(&self) -> Option<&CabInputs> {
        let [first, other] = &self.cabs;
        match (first.hcr, other.hcr) {
            (true, false) => Some(first),
            (false, true) => Some(other),
            _ => None,
        }
    }

    /// Whether a contact of the unit is closed. Contacts that are not heard count as open.
    pub(super) fn contact(&self, output: Outputs) -> bool {
        self.contacts.is_some_and(|on| on.contains(output))
    }

    /// ATO asks for the holding brake by its contact, or by message as `by_message` says.
    pub(super) fn holding_asked(&self, by_message: bool) -> bool {
        by_message || self.contact(Outputs::HOLDING_BRAKE)
    }
}
