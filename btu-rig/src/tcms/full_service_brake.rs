//! Full-service-brake module of the standard EMU (S4 §3.2): the first brake to come on for an abnormal
//! vehicle.

use super::mode::Driver;

/// Inputs, by the paper's names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BrakeInputs {
    /// BCXEMOD: emergency mode.
    pub bcxemod: bool,
    /// BCXYMOD: yard mode.
    pub bcxymod: bool,
    /// BCXMMOD: manual mode.
    pub bcxmmod: bool,
    /// BCXAMOD: automatic mode.
    pub bcxamod: bool,
    /// BCXDMOD: driverless mode.
    pub bcxdmod: bool,
    /// BCXVVVFF: propulsion failed.
    pub bcxvvvff: bool,
    /// BCXECUF: brake control unit failed.
    pub bcxecuf: bool,
    /// BCXBCCSF: brake cylinder failed.
    pub bcxbccsf: bool,
    /// BCXNRB: brake not released.
    pub bcxnrb: bool,
    /// BCXATOF: ATO failed.
    pub bcxatof: bool,
    /// BCXDOREQ: door open.
    pub bcxdoreq: bool,
    /// BCXACFSB: ATC asks for the full service brake.
    pub bcxacfsb: bool,
    /// BCXDMFSB: dead man.
    pub bcxdmfsb: bool,
    /// BCXINB7: the master controller is at B7.
    pub bcxinb7: bool,
}

/// Outputs, by the paper's names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BrakeOutputs {
    /// BCYINFSB: full service brake applied.
    pub bcyinfsb: bool,
    /// BCYMSB: maximum service brake.
    pub bcymsb: bool,
    /// BCYPCUT: powering cut.
    pub bcypcut: bool,
}

/// One cycle of the module: outputs depend on the present inputs alone.
///
/// The dead man counts in manual, yard and emergency mode only, a failed ATO in automatic and
/// driverless mode only; with no mode, or more than one, both count. The controller at B7 is the
/// maximum service brake and cuts powering, but does not count as abnormal.
pub fn full_service_brake(inputs: &BrakeInputs) -> BrakeOutputs {
    let driver = Driver::of(
        [inputs.bcxemod, inputs.bcxymod, inputs.bcxmmod],
        [inputs.bcxamod, inputs.bcxdmod],
    );
    let bcyinfsb = inputs.bcxvvvff
        || inputs.bcxecuf
        || inputs.bcxbccsf
        || inputs.bcxnrb
        || inputs.bcxdoreq
        || inputs.bcxacfsb
        || inputs.bcxdmfsb && driver != Some(Driver::Ato)
        || inputs.bcxatof && driver != Some(Driver::Hand);
    let bcymsb = bcyinfsb || inputs.bcxinb7;
    BrakeOutputs {
        bcyinfsb,
        bcymsb,
        bcypcut: bcymsb,
    }
}
