//! State of TCMS after a scan: for signals, lamps, the event log and the unit.

use protocol::event::Event;

use super::cab_change::CabOrder;
use super::cause_bits::{Lamps, PowerCuts};
use super::driving_control::DrivingOutputs;
use super::effort::Demands;
use super::emergency_line::Line;
use super::equipment_monitor::EquipmentFailures;
use super::full_service_brake::BrakeOutputs;
use super::mode::TcmsMode;

/// Result of one scan of TCMS.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TcmsView {
    /// Mode TCMS drives in.
    pub mode: TcmsMode,
    /// Outputs of the driving-control module; P and value masked while the emergency brake is applied.
    pub driving: DrivingOutputs,
    /// Outputs of the full-service-brake module.
    pub brake: BrakeOutputs,
    /// The holding brake is ordered.
    pub holding: bool,
    /// Emergency brake train line.
    pub line: Line,
    pub power_cuts: PowerCuts,
    /// Lamps that are lit.
    pub lamps: Lamps,
    pub found: EquipmentFailures,
    /// Voltage of the controller in the active cab, V.
    pub volts: f64,
    /// Speed as TCMS sees it, m/s.
    pub speed_mps: f64,
    /// Demands on the cars.
    pub demands: Demands,
    /// Effort the train gives, −1024..1023, for the unit.
    pub given: i16,
    /// Powering drives the train backward: by the reverser of the active cab, or by ATO.
    pub backward: bool,
    /// Order to a head control relay in this scan.
    pub cab_order: Option<CabOrder>,
}

/// An event TCMS logs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TcmsEvent {
    /// Entry of the event dictionary, 800 to 899.
    pub event: Event,
    /// Meaning as in the dictionary: for most events the car.
    pub parameter: i32,
}
