//! Signals that each frame of the unit carries, and how the frame tells each of them.

use protocol::Speed;
use protocol::message::{
    AtcToTcms, AtcToTcmsBits, IoOutput, Outputs, Status, StatusBits, TcmsToAtcBits, TrainState,
    TwcReport, TwcTrain,
};
use protocol::signal::{Sample, Signal};

use crate::procedure::plan::Connection;

/// Frames of the unit that carry signals.
#[derive(Clone, Copy, Debug)]
pub enum Source {
    IoOutput,
    AtcToTcms,
    Status,
    TwcTrain,
    TwcReport,
    TrainState,
}

/// A frame of the unit that carries signals.
pub trait Carries {
    const SOURCE: Source;
    /// Signals of the frame; they become unknown when the frame no longer comes.
    const SIGNALS: &'static [Signal];

    /// Sets the signals of the frame.
    fn record(&self, sample: &mut Sample);
}

/// Declares the signals of a frame, each with its value.
macro_rules! carries {
    ($frame:ident as $it:ident { $($signal:ident = $value:expr;)+ }) => {
        impl Carries for $frame {
            const SOURCE: Source = Source::$frame;
            const SIGNALS: &'static [Signal] = &[$(Signal::$signal),+];

            fn record(&self, sample: &mut Sample) {
                let $it = self;
                $(sample.set(Signal::$signal, f64::from($value));)+
            }
        }
    };
}

carries! { IoOutput as io {
    Eb = !io.outputs.contains(Outputs::EB_RELAY);
    Fsb = io.outputs.contains(Outputs::FSB);
    PowerCut = io.outputs.contains(Outputs::POWER_CUT);
    Alarm = io.outputs.contains(Outputs::ALARM);
    HoldingBrake = io.outputs.contains(Outputs::HOLDING_BRAKE);
    DoorEnableLeft = io.outputs.contains(Outputs::DOOR_ENABLE_LEFT);
    DoorEnableRight = io.outputs.contains(Outputs::DOOR_ENABLE_RIGHT);
    DoorOrderLeft = io.outputs.contains(Outputs::OPEN_LEFT);
    DoorOrderRight = io.outputs.contains(Outputs::OPEN_RIGHT);
    DoorOrderClose = io.outputs.contains(Outputs::CLOSE_DOORS);
    CodeValid = io.outputs.contains(Outputs::CODE_VALID);
    Standstill = io.outputs.contains(Outputs::STANDSTILL);
    Healthy = io.outputs.contains(Outputs::HEALTHY);
    Limit = kmh(io.limit_cms);
    Speed = kmh(io.speed_cms);
    Marker = io.marker;
    MarkerCount = io.marker_count;
} }

// Mode and target come in `AtcToTcms` and in `Status`, so that they stay known when one of the two fails: `LatestSample`
// takes them.
carries! { AtcToTcms as tcms {
    Effort = tcms.effort;
    Power = tcms.bits.contains(AtcToTcmsBits::POWER);
    Brake = tcms.bits.contains(AtcToTcmsBits::BRAKE);
} }

carries! { Status as status {
    Refusals = status.refusals.bits();
    CodeIndex = status.code_index;
    EbCause = status.eb_cause.code();
    FsbCause = status.fsb_cause.code();
    Speed1 = kmh(status.speed1_cms);
    Speed2 = kmh(status.speed2_cms);
    Position = f64::from(status.position_cm) / 100.0;
    Armed = status.bits.contains(StatusBits::ARMED);
    TwcOk = status.bits.contains(StatusBits::TWC_OK);
    TcmsOk = status.bits.contains(StatusBits::TCMS_OK);
    StationValid = status.bits.contains(StatusBits::STATION_VALID);
    Aligned = status.bits.contains(StatusBits::ALIGNED);
    TraOk = status.bits.contains(StatusBits::TRA_OK);
    AtoReady = status.bits.contains(StatusBits::ATO_READY);
    AtoState = status.ato_state.code();
    WheelCorrection = f64::from(status.wheel_correction_10ppm) / 1000.0;
    Started = status.bits.contains(StatusBits::STARTED);
    Events = status.events;
    RejectedFrames = status.rejected_frames;
    TwcReceived = status.twc_received;
    SelfTest = status.self_test.bits();
    TestCarrier = status.test_carrier_hz;
    TestCodeRate = f64::from(status.test_code_rate_chz) / 100.0;
    TestLevel = status.test_level_mv;
    TestSpeed = kmh(status.test_speed_cms);
} }

carries! { TwcTrain as answer {
    TwcAnswerStation = answer.station;
    TwcAnswerTrain = answer.train_number;
} }

carries! { TwcReport as report {
    OwnTrain = report.train_number;
    NumberState = report.number_state.code();
    Destination = report.destination;
    OrderState = report.order_state.code();
    TwcHeard = report.received;
    TwcRefused = report.refused;
    TwcOthers = report.others;
} }

// What only the unit itself can tell. Without a harness `TrainState` also tells the signals of `IoOutput` and `AtcToTcms`,
// and `LINE_SIGNALS`.
carries! { TrainState as state {
    TestPulses = state.test_pulses;
    TestMarkers = state.test_markers;
    TestAnswers = state.test_answers;
    TestAnswerStation = state.test_answer_station;
    TestAnswerTrain = state.test_answer_train;
    AskedEb = !state.asked.contains(Outputs::EB_RELAY);
    AskedFsb = state.asked.contains(Outputs::FSB);
    AskedPowerCut = state.asked.contains(Outputs::POWER_CUT);
    AskedAlarm = state.asked.contains(Outputs::ALARM);
    AskedDoorLeft = state.asked.contains(Outputs::DOOR_ENABLE_LEFT);
    AskedDoorRight = state.asked.contains(Outputs::DOOR_ENABLE_RIGHT);
    AskedDoorClose = state.asked.contains(Outputs::CLOSE_DOORS);
    AskedPower = state.asked_effort > 0;
    AskedEffort = state.asked_effort;
    AskedMode = state.asked_mode.code();
    TrainMode = state.mode.code();
    TrainSpeed1 = kmh(state.train_speed1_cms);
    TrainSpeed2 = kmh(state.train_speed2_cms);
    MarkerAt = f64::from(state.marker_at_ms) / 1000.0;
    TcmsBraking = state.tcms_bits.contains(TcmsToAtcBits::SERVICE_BRAKE_APPLIED);
    TcmsLineOpen = state.tcms_bits.contains(TcmsToAtcBits::EMERGENCY_BRAKE_APPLIED);
    TcmsGiven = state.tcms_effort;
    TcmsLoad = f64::from(state.load_100kg) / 10.0;
    TcmsTellsLines = state.tcms_bits.contains(TcmsToAtcBits::TELLS_LINES);
    TcmsDoors = state.tcms_bits.contains(TcmsToAtcBits::DOORS_CLOSED);
    TcmsHcr = state.tcms_bits.contains(TcmsToAtcBits::CAB_MANNED);
    TwcStation = state.twc_station;
    TwcSection = state.twc_section;
    TwcLoop = state.twc_loop;
    TwcTrain = state.twc_train_number;
    TwcSent = state.twc_answers;
} }

/// Signals of each kind of frame.
pub const CARRIED: [(Source, &[Signal]); 6] = [
    (Source::IoOutput, IoOutput::SIGNALS),
    (Source::AtcToTcms, AtcToTcms::SIGNALS),
    (Source::Status, Status::SIGNALS),
    (Source::TwcTrain, TwcTrain::SIGNALS),
    (Source::TwcReport, TwcReport::SIGNALS),
    (Source::TrainState, TrainState::SIGNALS),
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

/// A speed of the wire, cm/s, in km/h.
pub fn kmh(cms: u16) -> f64 {
    Speed::from_cms(cms).kmh()
}

/// Signals that on this connection only `TrainState` tells.
pub fn told_by_train_state(connection: Connection) -> Vec<Signal> {
    let on_train = [IoOutput::SIGNALS, &LINE_SIGNALS, AtcToTcms::SIGNALS].concat();
    match connection {
        Connection::Btu => TrainState::SIGNALS.to_vec(),
        Connection::Ptu => [TrainState::SIGNALS, &on_train].concat(),
    }
}
