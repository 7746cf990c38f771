//! Reasons why nothing that is heard from a unit can be judged, as data: told in English here; other crates tell them
//! in other languages.

use std::net::SocketAddr;

use protocol::Duration;
use protocol::frame::Reject;
use protocol::message::Channel;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The connection to the unit broke.
#[derive(Clone, Debug, PartialEq, Eq, Error, Serialize, Deserialize)]
#[error("{link}: {why}")]
pub struct LinkFailure {
    /// Port of the link, as the user named it.
    pub link: String,
    pub why: PortFailure,
}

/// Failures of a port; the strings are the operating system's.
#[derive(Clone, Debug, PartialEq, Eq, Error, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PortFailure {
    /// The other end is gone.
    #[error("closed at the other end")]
    Closed,
    /// Nothing can be read.
    #[error("reading failed: {0}")]
    Reading(String),
    /// Nothing can be written.
    #[error("writing failed: {0}")]
    Writing(String),
    /// The unit runs by the clock instead of in lock step, or is not there.
    #[error("the unit does not answer in lock step ({0}); serve it with --pty --lock-step")]
    NotInLockStep(String),
}

/// Trouble of the connection, of the unit that answers, or of reading the unit's log.
#[derive(Clone, Debug, PartialEq, Eq, Error, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LinkTrouble {
    /// Nothing can be sent or received any more.
    #[error(transparent)]
    Broken(LinkFailure),
    /// An instrument of the bench failed.
    #[error("instrument {instrument} of the bench: {fault}")]
    Instrument {
        /// Name of the instrument in the bench file.
        instrument: String,
        fault: Box<InstrumentFault>,
    },
    /// Another tester has the unit.
    #[error("the unit is taken by another tester, {by}, for {:.0} s{}", .held.as_secs(), silent_for(*.silent))]
    Taken {
        /// Network address of the other tester.
        by: SocketAddr,
        /// Time for which the other tester has had the unit.
        held: Duration,
        /// Time for which the other tester has been silent, if that is long.
        silent: Option<Duration>,
    },
    /// The unit sent not one byte.
    #[error("unit silent: not one byte in {:.1} s — check the cable, the port and the unit's power", .within.as_secs())]
    NotOneByte {
        /// Time in which the unit was to send something.
        within: Duration,
    },
    /// Frames came that another version of this program makes.
    #[error("{frames} frames of another version of the wire — unit and bench programs differ")]
    OtherVersion { frames: u64 },
    /// Bytes came, but no valid frame.
    #[error("garbage: {bytes} bytes, no valid frame{} — {cause}", refused_for(*.refused))]
    Garbage {
        /// Number of bytes that came.
        bytes: u64,
        /// Number of frames refused for the most frequent reason, and that reason.
        refused: Option<(u64, Reject)>,
        /// Probable cause.
        cause: GarbageCause,
    },
    /// The unit, which was heard before, is silent.
    #[error("unit silent for {:.1} s on the {} channel{}", .silence.as_secs(), channel_name(*.channel), meanwhile(*.refused))]
    Silent {
        /// Channel on which the unit is silent.
        channel: Channel,
        silence: Duration,
        /// Frames that were refused during the silence.
        refused: Option<Refused>,
    },
    /// The line loses or damages more frames than permitted.
    #[error(
        "the line between tester and unit is bad: within {:.0} s {from_unit} of {came} frames from the unit did not \
         come through, and the unit refused {to_unit} — check the cable, its plugs and whether another program uses \
         the port",
        .within.as_secs()
    )]
    BadLine {
        /// Time in which these frames were counted.
        within: Duration,
        /// Frames of the unit that did not come through.
        from_unit: u64,
        /// All frames that the unit sent, those that did not come through included.
        came: u64,
        /// Frames that the unit refused.
        to_unit: u64,
    },
    /// The unit that answers is not the unit that answered before.
    #[error("another unit answers: {}", changes(.0))]
    OtherUnit(Vec<Changed>),
    /// The log grows faster than it can be read.
    #[error("the unit logs without end: {entries} entries came beyond what a log can hold")]
    LogWithoutEnd {
        /// Number of entries that are not kept.
        entries: u64,
    },
    /// The unit does not answer questions for its log.
    #[error("the unit's log could not be read: asked {times} times, no answer")]
    LogNotAnswered {
        /// Number of questions.
        times: u32,
    },
    /// The unit answers, but does not give a log entry that it says it has.
    #[error(
        "the unit's log could not be read: asked {times} times for entry {entry} of {of}, which never came"
    )]
    EntryNeverCame {
        /// Number of questions.
        times: u32,
        /// Index of the entry.
        entry: u32,
        /// Entries that the unit says it has logged.
        of: u32,
    },
    /// Entries were lost in the unit before they could be read.
    #[error("{entries} entries of the unit's log were overwritten before they could be read")]
    Overwritten {
        /// Number of entries lost.
        entries: u64,
    },
    /// The unit ceased to answer questions for its stored memory.
    #[error("the unit's stored memory could not be read: no answer any more")]
    MemoryNotAnswered,
    /// The unit says that it stores more than its memory can hold.
    #[error("the unit says that it stores {entries} entries, more than a unit can")]
    MemoryTooLarge {
        /// Number of entries the unit claims.
        entries: u32,
    },
    /// The stored memory has become shorter while it was read.
    #[error("the unit's stored memory was exchanged or failed while it was read")]
    MemoryExchanged,
}

impl LinkTrouble {
    /// An instrument of the bench failed, which tells nothing of the unit or of the line to the unit.
    pub const fn is_of_the_bench(&self) -> bool {
        matches!(self, Self::Instrument { .. })
    }
}

/// Fault of an instrument of the bench: never a fault of the unit. Texts are the instrument's or the system's own.
#[derive(Clone, Debug, PartialEq, Eq, Error, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InstrumentFault {
    /// The instrument cannot be reached.
    #[error("not reached at {at}: {why}")]
    NotThere {
        /// Address or port of the instrument.
        at: String,
        /// Error of the operating system.
        why: String,
    },
    /// The connection ended.
    #[error("disconnected: {0}")]
    Disconnected(String),
    /// The instrument ended the connection.
    #[error("it closed the connection")]
    Closed,
    /// The instrument took a question and does not answer.
    #[error("no answer within {:.2} s", .0.as_secs())]
    Silent(Duration),
    /// The instrument answers later than the bench file says.
    #[error("slow: it took {:.0} ms, and the bench file states {:.0} ms", ms(*.took), ms(*.stated))]
    Slow {
        /// Time that a command or a reading took.
        took: Duration,
        /// `uncertainty_ms` of the bench file.
        stated: Duration,
    },
    /// An instrument of another model answers.
    #[error("wrong model: {found} answers where {expected} is expected")]
    OtherModel {
        /// Answer to `*IDN?`.
        found: String,
        /// Part of the answer to `*IDN?` by which the driver knows the model.
        expected: String,
    },
    /// The right model with another serial number.
    #[error("another instrument: serial number {found} answers where {expected} is expected")]
    OtherSerial {
        /// Serial number in its answer to `*IDN?`.
        found: String,
        /// `serial` of the bench file.
        expected: String,
    },
    /// Another program of this computer has locked the instrument's line.
    #[error("another program of this computer uses it")]
    Taken,
    /// A carrier without a code was ordered, for which the driver has no commands.
    #[error("its driver has no commands for a carrier that is not modulated")]
    NoUnmodulated,
    /// The waveform has samples beyond the greatest that the sound card makes.
    #[error("the waveform is louder than it can play")]
    TooLoud,
    /// The sound device does not take samples as fast as they are made.
    #[error("the device takes no samples")]
    TakesNoSamples,
    /// Neither of the programs that could play sound is installed.
    #[error("no program carries sound here: neither {server} nor {alsa} is installed")]
    NoPlayer {
        /// Name of the sound server's program.
        server: String,
        /// Name of ALSA's program.
        alsa: String,
    },
    /// What the sound card plays is not heard at this input.
    #[error("nothing that it plays is heard at {0}")]
    NotHeard(String),
    /// The program that plays sound has ended without an error message.
    #[error("the program that plays on it has ended")]
    PlayerEnded,
    /// The instrument reports an error after a command.
    #[error("it refused {command}: {error}")]
    Refused {
        /// Command as it was sent.
        command: String,
        /// Entry of the instrument's error queue, as received.
        error: String,
    },
    /// The instrument has more errors than its queue holds.
    #[error("its error queue is full: {0}")]
    QueueFull(String),
    /// A value is outside the range that the driver states.
    #[error("{value} is out of range for {what}, which takes {low} to {high}")]
    OutOfRange {
        /// The driver's name of the value.
        what: String,
        /// Value that the driver would have set.
        value: String,
        /// Least value that the driver states.
        low: String,
        /// Greatest value that the driver states.
        high: String,
    },
    /// The instrument's answer cannot be read.
    #[error("{found} is no answer to {asked}")]
    NoAnswer {
        /// Command as it was sent, or number of bytes asked for.
        asked: String,
        /// Answer as it came.
        found: String,
    },
    /// The contact that proves a relay's position contradicts the order.
    #[error("the relay of {contact} is stuck: it was ordered {ordered} and is proved {}", 1 - .ordered)]
    Stuck {
        /// Stimulus of the bench file that the relay makes.
        contact: String,
        /// 1 = the relay was ordered to close, 0 = to open.
        ordered: u8,
    },
}

fn ms(duration: Duration) -> f64 {
    duration.as_secs() * 1000.0
}

/// Probable cause of bytes without a valid frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GarbageCause {
    /// No frame has a right check sequence.
    #[error("wrong baud rate?")]
    BaudRate,
    /// The tester receives the frames that it has sent.
    #[error("the tester's own frames come back: is the unit on this port?")]
    Echo,
    /// Frames are undamaged, but not from a unit.
    #[error("check the cable and what is connected to this port")]
    OtherDevice,
}

/// Frames that were refused while a unit was silent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Refused {
    /// Number of frames whose sequence number or time stamp does not continue the earlier ones, as from a unit that
    /// starts again and again.
    OfStarts(u64),
    /// Number of frames refused for any reason.
    Frames(u64),
}

/// A property of a unit that has changed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Changed {
    /// The property that differs.
    pub property: Property,
    /// Value that the unit told first.
    pub was: String,
    /// Value that the unit tells now.
    pub is: String,
}

/// Property of a unit's identity that shows when another unit answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Property {
    Serial,
    Configuration,
    ConfigurationChecksum,
    /// Checksum of its track database.
    TrackChecksum,
}

/// Name of a channel in a sentence.
pub const fn channel_name(channel: Channel) -> &'static str {
    match channel {
        Channel::Ptu => "PTU",
        Channel::Io => "I/O",
        Channel::Tcms => "TCMS",
        Channel::Twc => "TWC",
    }
}

fn silent_for(silent: Option<Duration>) -> String {
    silent.map_or_else(String::new, |silent| {
        format!(", which has been silent for {:.0} s", silent.as_secs())
    })
}

fn refused_for(refused: Option<(u64, Reject)>) -> String {
    refused.map_or_else(String::new, |(frames, reason)| {
        format!(", {frames} refused for {}", reason.label())
    })
}

fn meanwhile(refused: Option<Refused>) -> String {
    match refused {
        None => String::new(),
        Some(Refused::OfStarts(frames)) => format!(
            ", while {frames} frames did not continue those before them — the unit starts again and again: check its \
             supply"
        ),
        Some(Refused::Frames(frames)) => {
            format!(", while {frames} frames were refused — check the line between tester and unit")
        }
    }
}

fn changes(all: &[Changed]) -> String {
    let said = all.iter().map(|Changed { property, was, is }| {
        let what = match property {
            Property::Serial => "serial number",
            Property::Configuration => "unit configuration",
            Property::ConfigurationChecksum => "configuration's checksum",
            Property::TrackChecksum => "track database's checksum",
        };
        format!("its {what} was {was} and is {is}")
    });
    said.collect::<Vec<_>>().join(", ")
}
