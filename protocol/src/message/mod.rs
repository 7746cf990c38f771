//! Typed messages of the four channels. `WIRE.md` describes them for people; a test holds the two
//! together.

mod enums;
mod io;
mod layout;
mod log;
mod ptu;
mod self_test;
mod stored;
mod tcms;
mod test_board;
mod train_state;
mod twc;

use alloc::string::String;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

pub use enums::{
    AbsurdInputs, Answer, ArmRefusal, AtoFailure, AtoState, Coil, DoorSide, EbCause, FsbCause,
    MeasureUnit, Mode, ModeSwitch, NumberState, OrderLacks, OrderState, Refusals, RunningMode,
    StoreKind, TrainOrder,
};
pub use io::{
    COIL_PART, COIL_PARTS, COIL_SAMPLE_HZ, COIL_SAMPLES, COIL_STEP_MV, CabEntries, CoilSamples,
    Crosstalk, IoInput, IoOutput, Outputs, Samples, TrainLines, WheelEntry,
};
pub use layout::{
    Cursor, DecodeError, DecodeErrorKind, Field, FieldSpec, Layout, MessageSpec, WordSpec,
};
pub use log::{ClearLog, LogEnd, LogEntry, ReadLog, ReadRun, RunEnd, RunRow};
pub use ptu::{
    ArmChallenge, ArmConfirm, ArmRequest, ArmState, Disarm, Identify, Identity, KeepAlive, Status,
    StatusBits, StimulusAnswer, Taken,
};
pub use self_test::{RunSelfTest, SelfTest, SelfTestEnd, SelfTestItem};
pub use stored::{ReadStored, SetClock, StoredClock, StoredEnd, StoredEntry, StoredRow};
pub use tcms::{AtcToTcms, AtcToTcmsBits, TcmsToAtc, TcmsToAtcBits};
pub use test_board::{TestCode, TestMarker, TestRelease, TestSignals, TestSpeed, TestTwc};
pub use train_state::{Subscribe, TrainState};
pub use twc::{TwcOrders, TwcReport, TwcTrain, TwcTrainBits, TwcWayside};

/// The four channels of the wire, in the order of their numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// Maintenance: arm, stimuli, status, event log, identity.
    Ptu,
    /// The bench harness: antenna, tachometers, marker coil, train lines; the unit's outputs.
    Io,
    /// RS-485 between ATC and TCMS.
    Tcms,
    /// Train to wayside communication through the loop.
    Twc,
}

impl Channel {
    /// All channels in the order of their numbers.
    pub const ALL: [Self; 4] = [Self::Ptu, Self::Io, Self::Tcms, Self::Twc];

    /// Number on the wire, 1 to 4.
    pub const fn code(self) -> u8 {
        self as u8 + 1
    }

    /// The channel of a wire number.
    pub const fn from_code(code: u8) -> Option<Self> {
        match code {
            1 => Some(Self::Ptu),
            2 => Some(Self::Io),
            3 => Some(Self::Tcms),
            4 => Some(Self::Twc),
            _ => None,
        }
    }
}

/// Source or destination of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Address {
    /// The maintenance program, PTU or BTU.
    Tester = 0x10,
    /// The unit under test.
    Unit = 0x20,
    /// The bench's input and output rack.
    IoRack = 0x30,
    /// The train control and monitoring system.
    Tcms = 0x40,
    /// The wayside TWC equipment.
    Wayside = 0x50,
}

impl Address {
    /// Number on the wire.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The address of a wire number.
    pub const fn from_code(code: u8) -> Option<Self> {
        match code {
            0x10 => Some(Self::Tester),
            0x20 => Some(Self::Unit),
            0x30 => Some(Self::IoRack),
            0x40 => Some(Self::Tcms),
            0x50 => Some(Self::Wayside),
            _ => None,
        }
    }

    /// The unit's partner on a channel.
    pub const fn partner(channel: Channel) -> Self {
        match channel {
            Channel::Ptu => Self::Tester,
            Channel::Io => Self::IoRack,
            Channel::Tcms => Self::Tcms,
            Channel::Twc => Self::Wayside,
        }
    }
}

macro_rules! messages {
    ($($name:ident),* $(,)?) => {
        /// Any message of any channel.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[allow(missing_docs)]
        pub enum Message { $($name($name)),* }

        impl Message {
            /// Reads a payload that came on `channel`.
            ///
            /// # Errors
            /// Names the message, field and offset that do not fit the declared layout.
            pub fn decode(channel: Channel, payload: &[u8]) -> Result<Self, DecodeError> {
                let Some(&code) = payload.first() else {
                    return Err(DecodeError {
                        message: "payload", field: "code", offset: 0,
                        kind: DecodeErrorKind::Truncated,
                    });
                };
                $( if $name::SPEC.channel as u8 == channel as u8 && $name::SPEC.code == code {
                    return $name::read(payload).map(Self::$name);
                } )*
                Err(DecodeError {
                    message: "payload", field: "code", offset: 0,
                    kind: DecodeErrorKind::UnknownMessage(code),
                })
            }

            /// Appends code and fields to `out`.
            pub fn encode(&self, out: &mut Vec<u8>) {
                match self { $( Self::$name(message) => message.write(out) ),* }
            }

            /// The channel this message belongs to.
            pub fn channel(&self) -> Channel {
                self.spec().channel
            }

            /// The message's name in `WIRE.md`.
            pub fn name(&self) -> &'static str {
                self.spec().name
            }

            /// Declared layout of the message.
            pub const fn spec(&self) -> &'static MessageSpec {
                match self { $( Self::$name(_) => &$name::SPEC ),* }
            }

            /// Each field with its value as text, for people and for tests.
            pub fn show(&self) -> Vec<(&'static FieldSpec, String)> {
                let values = match self { $( Self::$name(message) => message.show() ),* };
                self.spec().fields.iter().zip(values).collect()
            }
        }

        $( impl From<$name> for Message {
            fn from(message: $name) -> Self { Self::$name(message) }
        }

        impl TryFrom<Message> for $name {
            type Error = ();

            fn try_from(message: Message) -> Result<Self, ()> {
                match message {
                    Message::$name(message) => Ok(message),
                    _ => Err(()),
                }
            }
        } )*

        /// Every message.
        pub const CATALOGUE: &[MessageSpec] = &[$( $name::SPEC ),*];
    };
}

messages!(
    Identify,
    ArmRequest,
    ArmConfirm,
    Disarm,
    KeepAlive,
    Subscribe,
    TestCode,
    TestSpeed,
    TestMarker,
    TestTwc,
    TestRelease,
    RunSelfTest,
    ReadLog,
    ReadRun,
    ReadStored,
    SetClock,
    ClearLog,
    Identity,
    ArmChallenge,
    ArmState,
    StimulusAnswer,
    SelfTestItem,
    SelfTestEnd,
    Status,
    TrainState,
    LogEntry,
    LogEnd,
    RunRow,
    RunEnd,
    StoredEntry,
    StoredClock,
    StoredRow,
    StoredEnd,
    Taken,
    IoInput,
    CabEntries,
    Crosstalk,
    WheelEntry,
    CoilSamples,
    IoOutput,
    TcmsToAtc,
    AtcToTcms,
    TwcWayside,
    TwcOrders,
    TwcTrain,
    TwcReport,
);

/// Every enumeration that is a field's type.
pub const ENUMS: &[WordSpec] = &[
    Mode::SPEC,
    ModeSwitch::SPEC,
    Coil::SPEC,
    RunningMode::SPEC,
    TrainOrder::SPEC,
    OrderState::SPEC,
    NumberState::SPEC,
    DoorSide::SPEC,
    EbCause::SPEC,
    FsbCause::SPEC,
    Answer::SPEC,
    ArmRefusal::SPEC,
    StoreKind::SPEC,
    AtoState::SPEC,
    AtoFailure::SPEC,
    MeasureUnit::SPEC,
];

/// Every set of bits that is a field's type.
pub const BIT_SETS: &[WordSpec] = &[
    StatusBits::SPEC,
    Refusals::SPEC,
    SelfTest::SPEC,
    TestSignals::SPEC,
    TrainLines::SPEC,
    Outputs::SPEC,
    TcmsToAtcBits::SPEC,
    AtcToTcmsBits::SPEC,
    TwcTrainBits::SPEC,
    AbsurdInputs::SPEC,
    OrderLacks::SPEC,
];
