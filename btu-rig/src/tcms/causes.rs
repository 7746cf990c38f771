//! Causes that cut powering, and the driver's lamps.

use protocol::message::Outputs;

use super::cause_bits::{Lamps, PowerCuts};
use super::emergency_line::Line;
use super::equipment_monitor::EquipmentFailures;
use super::full_service_brake::BrakeOutputs;
use super::inputs::TcmsInputs;
use super::mode::TcmsMode;

/// Every condition that cuts powering in this scan (S3, S4).
pub(super) fn power_cuts(
    inputs: &TcmsInputs<'_>,
    mode: TcmsMode,
    line: &Line,
    brake: &BrakeOutputs,
    found: &EquipmentFailures,
    holding_by_message: bool,
) -> PowerCuts {
    let cab = inputs.active_cab();
    let mut cuts = PowerCuts::default();
    for (cut, holds) in [
        (PowerCuts::DOORS, !inputs.doors_closed),
        (PowerCuts::HCR, cab.is_none()),
        (
            PowerCuts::REVERSER,
            cab.is_some_and(|cab| cab.reverser == 0),
        ),
        (PowerCuts::EMERGENCY, line.applied),
        (PowerCuts::FULL_SERVICE, brake.bcypcut),
        (PowerCuts::ATC, inputs.contact(Outputs::POWER_CUT)),
        (PowerCuts::ATC_SILENT, inputs.contacts.is_none()),
        (PowerCuts::HOLDING, inputs.holding_asked(holding_by_message)),
        (PowerCuts::SECURITY, inputs.security_brake),
        (PowerCuts::PARKING, inputs.parking_brake),
        (PowerCuts::NOT_RELEASED, !found.not_released.is_empty()),
        (PowerCuts::MAIN_RESERVOIR, inputs.main_reservoir_low),
        (PowerCuts::MODE, mode == TcmsMode::None),
        (PowerCuts::TURN_BACK, inputs.turn_back),
    ] {
        cuts.set(cut, holds);
    }
    cuts
}

/// Lamps of both cabs.
pub(super) fn lamps(inputs: &TcmsInputs<'_>, line: &Line, found: &EquipmentFailures) -> Lamps {
    let forced = inputs.active_cab().is_some_and(|cab| cab.forced_release);
    let failed = found
        .inverters
        .with(found.brake_units)
        .with(found.cylinders);
    let mut lamps = Lamps::default();
    for (lamp, lit) in [
        (Lamps::EMERGENCY, line.applied),
        (Lamps::EB_CUT_OUT, inputs.eb_cut_out),
        (Lamps::SECURITY, inputs.security_brake),
        (Lamps::PARKING, inputs.parking_brake),
        (Lamps::FORCED_RELEASE, forced),
        (Lamps::NOT_RELEASED, !found.not_released.is_empty()),
        (Lamps::FAILURE, !failed.is_empty()),
    ] {
        lamps.set(lamp, lit);
    }
    lamps
}
