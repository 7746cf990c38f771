//! Driving-control module of the standard EMU (S4 §3.1): from the master controller or ATO to the
//! powering and braking value for inverters and brake control units.

use super::controller::{FULL_BRAKE, FULL_POWER};
use super::mode::Driver;

/// Inputs, by the paper's names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DrivingInputs {
    /// DRXEMOD: emergency mode.
    pub drxemod: bool,
    /// DRXYMOD: yard mode.
    pub drxymod: bool,
    /// DRXMMOD: manual mode.
    pub drxmmod: bool,
    /// DRXAMOD: automatic mode.
    pub drxamod: bool,
    /// DRXDMOD: driverless mode.
    pub drxdmod: bool,
    /// DRXMCRV: value of the master controller, −1024..1023, from its voltage.
    pub drxmcrv: i16,
    /// DRXP: powering contact of the master controller.
    pub drxp: bool,
    /// DRXB: braking contact.
    pub drxb: bool,
    /// DRXCOA: neutral contact.
    pub drxcoa: bool,
    /// DRXPCUT: powering cut.
    pub drxpcut: bool,
    /// DRXTEBE: value of ATO, −1024..1023.
    pub drxtebe: i16,
    /// DRXAOP: ATO orders powering.
    pub drxaop: bool,
    /// DRXAOB: ATO orders braking.
    pub drxaob: bool,
}

/// Outputs, by the paper's names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DrivingOutputs {
    /// DRYINB7: the master controller is at B7.
    pub dryinb7: bool,
    /// DRYINP: powering.
    pub dryinp: bool,
    /// DRYINB: braking.
    pub dryinb: bool,
    /// DRYINCOA: coasting.
    pub dryincoa: bool,
    /// DRYTEBE: the value, −1024..1023.
    pub drytebe: i16,
}

/// One cycle of the module: outputs depend on the present inputs alone.
///
/// Automatic and driverless: P, B and value of ATO. Manual, yard and emergency: contacts and value of
/// the master controller. P and B both: B, and the value is taken as B's.
///
/// The paper is silent on the rest, and the safe side is taken. The neutral contact takes P away, not
/// B. Powering with powering cut is coasting. A value against its contact, or without one, brakes if it
/// can: with P, a value that brakes brakes; without P, a value that powers counts as 0. A value beyond
/// −1024..1023 is a full brake, and so is no mode, or more than one.
pub fn driving_control(inputs: &DrivingInputs) -> DrivingOutputs {
    let driver = Driver::of(
        [inputs.drxemod, inputs.drxymod, inputs.drxmmod],
        [inputs.drxamod, inputs.drxdmod],
    );
    let (power, brake, value) = match driver {
        Some(Driver::Hand) => (inputs.drxp && !inputs.drxcoa, inputs.drxb, inputs.drxmcrv),
        Some(Driver::Ato) => (inputs.drxaop, inputs.drxaob, inputs.drxtebe),
        None => (false, true, FULL_BRAKE),
    };
    let drytebe = if !(FULL_BRAKE..=FULL_POWER).contains(&value) {
        FULL_BRAKE
    } else if brake {
        -value.abs()
    } else if power && !inputs.drxpcut {
        value
    } else {
        value.min(0)
    };
    DrivingOutputs {
        dryinb7: driver == Some(Driver::Hand) && drytebe == FULL_BRAKE,
        dryinp: drytebe > 0,
        dryinb: drytebe < 0,
        dryincoa: drytebe == 0,
        drytebe,
    }
}
