//! Signals that each frame of the unit carries.

use protocol::signal::Signal;

use crate::procedure::plan::Connection;

/// Frames of the unit that carry signals.
#[derive(Clone, Copy, Debug)]
pub enum Source {
    Io,
    Tcms,
    Status,
    Twc,
    Report,
    TrainState,
}

/// Signals each kind of frame carries, forgotten with it. Mode and target come by two ways, so
/// that they stay known when one of them fails.
pub const CARRIED: [(Source, &[Signal]); 6] = [
    (Source::Io, &IO_SIGNALS),
    (
        Source::Tcms,
        &[Signal::Effort, Signal::Power, Signal::Brake],
    ),
    (Source::Status, &STATUS_SIGNALS),
    (
        Source::Twc,
        &[Signal::TwcAnswerStation, Signal::TwcAnswerTrain],
    ),
    (Source::Report, &REPORT_SIGNALS),
    (Source::TrainState, &TRAIN_STATE_SIGNALS),
];

const REPORT_SIGNALS: [Signal; 7] = [
    Signal::OwnTrain,
    Signal::NumberState,
    Signal::Destination,
    Signal::OrderState,
    Signal::TwcHeard,
    Signal::TwcRefused,
    Signal::TwcOthers,
];

const IO_SIGNALS: [Signal; 17] = [
    Signal::Eb,
    Signal::Fsb,
    Signal::PowerCut,
    Signal::Alarm,
    Signal::HoldingBrake,
    Signal::DoorEnableLeft,
    Signal::DoorEnableRight,
    Signal::DoorOrderLeft,
    Signal::DoorOrderRight,
    Signal::DoorOrderClose,
    Signal::CodeValid,
    Signal::Standstill,
    Signal::Healthy,
    Signal::Limit,
    Signal::Speed,
    Signal::Marker,
    Signal::MarkerCount,
];

/// What only the unit itself can tell. Without a harness it tells [`IO_SIGNALS`], what it sends to TCMS and
/// [`LINE_SIGNALS`] with them.
const TRAIN_STATE_SIGNALS: [Signal; 31] = [
    Signal::TestPulses,
    Signal::TestMarkers,
    Signal::TestAnswers,
    Signal::TestAnswerStation,
    Signal::TestAnswerTrain,
    Signal::AskedEb,
    Signal::AskedFsb,
    Signal::AskedPowerCut,
    Signal::AskedAlarm,
    Signal::AskedDoorLeft,
    Signal::AskedDoorRight,
    Signal::AskedDoorClose,
    Signal::AskedPower,
    Signal::AskedEffort,
    Signal::AskedMode,
    Signal::TrainMode,
    Signal::TrainSpeed1,
    Signal::TrainSpeed2,
    Signal::MarkerAt,
    Signal::TcmsBraking,
    Signal::TcmsLineOpen,
    Signal::TcmsGiven,
    Signal::TcmsLoad,
    Signal::TcmsTellsLines,
    Signal::TcmsDoors,
    Signal::TcmsHcr,
    Signal::TwcStation,
    Signal::TwcSection,
    Signal::TwcLoop,
    Signal::TwcTrain,
    Signal::TwcSent,
];

/// What a harness sets and a unit on a train reads.
pub const LINE_SIGNALS: [Signal; 8] = [
    Signal::Doors,
    Signal::DoorsLeft,
    Signal::DoorsRight,
    Signal::Hcr,
    Signal::MaintenanceKey,
    Signal::EbLoop,
    Signal::ModeSwitch,
    Signal::Controller,
];

const STATUS_SIGNALS: [Signal; 25] = [
    Signal::Refusals,
    Signal::CodeIndex,
    Signal::EbCause,
    Signal::FsbCause,
    Signal::Speed1,
    Signal::Speed2,
    Signal::Position,
    Signal::Armed,
    Signal::TwcOk,
    Signal::TcmsOk,
    Signal::StationValid,
    Signal::Aligned,
    Signal::TraOk,
    Signal::AtoReady,
    Signal::AtoState,
    Signal::WheelCorrection,
    Signal::Started,
    Signal::Events,
    Signal::RejectedFrames,
    Signal::TwcReceived,
    Signal::SelfTest,
    Signal::TestCarrier,
    Signal::TestCodeRate,
    Signal::TestLevel,
    Signal::TestSpeed,
];

/// Signals that nothing but `TrainState` tells on a connection.
pub fn told_by_train_state(connection: Connection) -> Vec<Signal> {
    let mut told = TRAIN_STATE_SIGNALS.to_vec();
    if connection == Connection::Ptu {
        told.extend(IO_SIGNALS);
        told.extend(LINE_SIGNALS);
        told.extend([Signal::Effort, Signal::Power, Signal::Brake]);
    }
    told
}
