//! How the train is driven and braked in a scan: full service brake, holding brake, direction, driving control,
//! effort.

use protocol::Duration;
use protocol::message::Outputs;

use super::{LONGEST_STEP_S, STANDS_MPS, ScanContext, Tcms};
use crate::tcms::controller::{FULL_BRAKE, FULL_POWER};
use crate::tcms::driving_control::{DrivingInputs, DrivingOutputs, driving_control};
use crate::tcms::effort::{Demands, Order};
use crate::tcms::emergency_line::Line;
use crate::tcms::equipment_monitor::EquipmentFailures;
use crate::tcms::feedback;
use crate::tcms::full_service_brake::{BrakeInputs, BrakeOutputs, full_service_brake};
use crate::tcms::holding_brake::HoldingInputs;
use crate::tcms::mode::TcmsMode;

impl Tcms {
    /// The full-service-brake module. It learns one scan later that the controller is at B7.
    pub(super) fn full_service(
        &mut self,
        scan: &ScanContext<'_>,
        found: &EquipmentFailures,
    ) -> BrakeOutputs {
        // The dead man's time begins with the mode: a driver who takes over from ATO has to reach for the handle.
        let released = !scan.mode.by_ato() && scan.cab.is_some_and(|cab| !cab.dead_man);
        let limit = Duration::from_secs(self.data.dead_man_s);
        self.dead_man_acts = self.dead_man.update(scan.now, released, limit);
        let inputs = BrakeInputs {
            bcxemod: scan.mode == TcmsMode::Emergency,
            bcxymod: scan.mode == TcmsMode::Yard,
            bcxmmod: scan.mode == TcmsMode::Manual,
            bcxamod: scan.mode == TcmsMode::Automatic,
            bcxdmod: scan.mode == TcmsMode::Driverless,
            bcxvvvff: !found.inverters.is_empty(),
            bcxecuf: !found.brake_units.is_empty(),
            bcxbccsf: !found.cylinders.is_empty(),
            bcxnrb: found.not_released_brakes,
            bcxatof: scan.order.failed,
            bcxdoreq: !scan.inputs.doors_closed,
            bcxacfsb: scan.inputs.contact(Outputs::FSB),
            bcxdmfsb: self.dead_man_acts,
            bcxinb7: self.view.driving.dryinb7,
        };
        let brake = full_service_brake(&inputs);
        self.full_service_otherwise = if inputs.bcxnrb {
            let otherwise = BrakeInputs {
                bcxnrb: false,
                ..inputs
            };
            full_service_brake(&otherwise).bcymsb
        } else {
            brake.bcymsb
        };
        brake
    }

    pub(super) fn hold(&mut self, scan: &ScanContext<'_>, speed_mps: f64) -> bool {
        let ordered = self.view.driving.drytebe;
        self.holding.step(
            scan.now,
            &HoldingInputs {
                by_ato: scan.mode.by_ato(),
                driverless: scan.mode == TcmsMode::Driverless,
                requested: scan.inputs.holding_asked(scan.order.holding),
                braking: self.view.driving.dryinb,
                speed_mps,
                traction: feedback::traction(scan.inputs.equipment, self.effort.as_ref(), ordered),
                turn_back: scan.inputs.turn_back,
            },
        )
    }

    /// Takes ATO's direction of travel while the train stands; returns whether direction and order agree.
    pub(super) fn turn(&mut self, scan: &ScanContext<'_>, speed_mps: f64) -> bool {
        let ordered = scan.mode.by_ato() && scan.order.backward;
        if speed_mps < STANDS_MPS {
            self.backward = ordered;
        }
        self.backward == ordered
    }

    /// The driving-control module, and the mask of the emergency brake behind it.
    pub(super) fn drive(
        &self,
        scan: &ScanContext<'_>,
        volts: f64,
        cut: bool,
        line: &Line,
    ) -> DrivingOutputs {
        let (mode, order) = (scan.mode, &scan.order);
        let controller = scan.cab.map(|cab| cab.controller);
        let driving = driving_control(&DrivingInputs {
            drxemod: mode == TcmsMode::Emergency,
            drxymod: mode == TcmsMode::Yard,
            drxmmod: mode == TcmsMode::Manual,
            drxamod: mode == TcmsMode::Automatic,
            drxdmod: mode == TcmsMode::Driverless,
            drxmcrv: self.data.value(volts),
            drxp: controller.is_some_and(|c| c.power),
            drxb: controller.is_some_and(|c| c.brake),
            drxcoa: controller.is_some_and(|c| c.neutral),
            drxpcut: cut,
            drxtebe: order.value,
            drxaop: order.power,
            drxaob: order.brake,
        });
        if !line.applied {
            return driving;
        }
        DrivingOutputs {
            dryinp: false,
            drytebe: 0,
            ..driving
        }
    }

    pub(super) fn share_out(&mut self, scan: &ScanContext<'_>, order: &Order) -> Demands {
        let before = self.stepped.replace(scan.now).unwrap_or(scan.now);
        let dt_s = scan.now.since(before).as_secs().min(LONGEST_STEP_S);
        self.effort
            .as_mut()
            .map_or_else(Demands::default, |effort| {
                effort.step(dt_s, order, scan.inputs.equipment)
            })
    }

    /// Share of full effort, −1..1. The maximum service brake is an order of its own: no mask of the value
    /// takes it away.
    pub(super) fn share(driving: &DrivingOutputs, brake: &BrakeOutputs) -> f64 {
        if brake.bcymsb {
            return -1.0;
        }
        let value = f64::from(driving.drytebe);
        if value < 0.0 {
            value / -f64::from(FULL_BRAKE)
        } else {
            value / f64::from(FULL_POWER)
        }
    }
}
