//! What stimuli and signals need of a bench.

use btu_rig::stimulus::{DoorLine, Stimulus};
use protocol::signal::Signal;

use super::points::UnitInput;

/// Signals that the bench's own train derives from contacts of the unit, with the contacts that the bench has to read.
pub(super) const FOLLOWS: [(Signal, &[Signal]); 4] = [
    (Signal::EbLoop, &[Signal::Eb]),
    (Signal::TcmsFsb, &[Signal::Fsb]),
    (Signal::TcmsMsb, &[Signal::Fsb]),
    (Signal::PowerCutCauses, &[Signal::Fsb, Signal::PowerCut]),
];
/// Contacts that a train follows while it drives.
pub(super) const DRIVES: [Signal; 4] = [
    Signal::Eb,
    Signal::Fsb,
    Signal::PowerCut,
    Signal::HoldingBrake,
];

/// Inputs of the unit that the bench must be able to set for a stimulus.
pub(super) fn needs(stimulus: &Stimulus) -> &'static [UnitInput] {
    use UnitInput as U;
    match stimulus {
        Stimulus::Code(_) | Stimulus::CodeDrift { .. } | Stimulus::CodesAlong { on: true } => {
            &[U::Code]
        }
        Stimulus::Crosstalk(signal) if signal.level_mv > 0.0 => &[U::Crosstalk],
        Stimulus::Speed { .. }
        | Stimulus::Travel { .. }
        | Stimulus::Direction { .. }
        | Stimulus::TrainDriven { on: true } => &[U::Tacho1, U::Tacho2],
        Stimulus::Tacho { channel: 1, .. } => &[U::Tacho1],
        Stimulus::Tacho { .. } => &[U::Tacho2],
        Stimulus::Marker { .. }
        | Stimulus::MarkerMoved { .. }
        | Stimulus::MarkersAlong { section: Some(_) } => &[U::Marker],
        Stimulus::Station(_) | Stimulus::Orders(Some(_)) | Stimulus::Wayside(_) => &[U::Twc],
        Stimulus::Doors { .. } | Stimulus::DoorsFollow { .. } => &[
            U::DoorsClosed,
            U::LeftClosed,
            U::LeftLocked,
            U::RightClosed,
            U::RightLocked,
        ],
        Stimulus::SideDoors { left: true, .. } | Stimulus::DoorObstacle { left: true, .. } => {
            &[U::DoorsBySide, U::LeftClosed, U::LeftLocked]
        }
        Stimulus::SideDoors { .. } | Stimulus::DoorObstacle { .. } => {
            &[U::DoorsBySide, U::RightClosed, U::RightLocked]
        }
        Stimulus::DoorLine { on: Some(_), line } => match line {
            DoorLine::All => &[U::DoorsClosed],
            DoorLine::LeftClosed => &[U::LeftClosed],
            DoorLine::LeftLocked => &[U::LeftLocked],
            DoorLine::RightClosed => &[U::RightClosed],
            DoorLine::RightLocked => &[U::RightLocked],
            DoorLine::BySide => &[U::DoorsBySide],
        },
        Stimulus::Hcr { .. } => &[U::Hcr],
        Stimulus::MaintenanceKey { .. } => &[U::MaintenanceKey],
        Stimulus::TrainNumber { number: 1.. } => &[U::Entries],
        Stimulus::WheelDiameter { diameter_mm } if *diameter_mm > 0.0 => &[U::Entries],
        Stimulus::ModeSwitch(_) => &[U::ModeSwitch],
        Stimulus::Controller { .. }
        | Stimulus::ControllerVolts { volts: Some(_) }
        | Stimulus::ControllerContacts { contacts: Some(_) } => &[U::Controller],
        Stimulus::Reverser { .. } => &[U::Forward, U::Backward],
        Stimulus::Acknowledge => &[U::Acknowledge],
        Stimulus::Start => &[U::Start],
        Stimulus::Crosstalk { .. }
        | Stimulus::CodeOff
        | Stimulus::CodesAlong { on: false }
        | Stimulus::TrainDriven { on: false }
        | Stimulus::Adhesion { .. }
        | Stimulus::MarkersAlong { section: None }
        | Stimulus::Orders(None)
        | Stimulus::DoorLine { on: None, .. }
        | Stimulus::TrainNumber { number: 0 }
        | Stimulus::WheelDiameter { .. }
        | Stimulus::ControllerVolts { volts: None }
        | Stimulus::ControllerContacts { contacts: None }
        | Stimulus::Switch { .. }
        | Stimulus::CutOut { .. }
        | Stimulus::Failure { .. }
        | Stimulus::Gradient { .. }
        | Stimulus::Tcms(_)
        | Stimulus::AtoEnable { .. }
        | Stimulus::Load { .. }
        | Stimulus::PtuArm
        | Stimulus::PtuAskToArm
        | Stimulus::PtuDisarm
        | Stimulus::PtuSilent { .. }
        | Stimulus::PtuCode { .. }
        | Stimulus::PtuSpeed { .. }
        | Stimulus::PtuMarker { .. }
        | Stimulus::PtuTwc(_)
        | Stimulus::PtuRelease
        | Stimulus::PtuSelfTest
        | Stimulus::PtuClearLog => &[],
    }
}
