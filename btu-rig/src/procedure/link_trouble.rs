//! Why nothing that is heard of a unit can be judged, as data: told in English here and in other languages by whoever
//! shows it.

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
    /// The unit goes by the clock, or is not there.
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
    /// An instrument of the bench does not do its part.
    #[error("instrument {instrument} of the bench: {fault}")]
    Instrument {
        /// Name of the instrument in the bench file.
        instrument: String,
        fault: Box<InstrumentFault>,
    },
    /// Another tester has the unit.
    #[error("the unit is taken by another tester, {by}, for {:.0} s{}", .held.as_secs(), silent_for(*.silent))]
    Taken {
        /// Where that tester is.
        by: SocketAddr,
        /// Time for which the other tester has had the unit.
        held: Duration,
        /// Time for which the other tester has been silent, if that is long.
        silent: Option<Duration>,
    },
    /// Not one byte came.
    #[error("unit silent: not one byte in {:.1} s — check the cable, the port and the unit's power", .within.as_secs())]
    NotOneByte {
        /// The time it had.
        within: Duration,
    },
    /// Frames came that another version of this program makes.
    #[error("{frames} frames of another version of the wire — unit and bench programs differ")]
    OtherVersion { frames: u64 },
    /// Bytes came, and no frame that can be taken.
    #[error("garbage: {bytes} bytes, no valid frame{} — {cause}", refused_for(*.refused))]
    Garbage {
        /// Number of bytes that came.
        bytes: u64,
        /// The most frequent reason for which frames were refused, and how many were for it.
        refused: Option<(u64, Reject)>,
        /// Probable cause.
        cause: GarbageCause,
    },
    /// The unit was heard before, and is not any more.
    #[error("unit silent for {:.1} s on the {} channel{}", .silence.as_secs(), channel_name(*.channel), meanwhile(*.refused))]
    Silent {
        /// Where it is silent.
        channel: Channel,
        silence: Duration,
        /// Refused frames in place of good ones.
        refused: Option<Refused>,
    },
    /// The line loses or damages more than one may.
    #[error(
        "the line between tester and unit is bad: within {:.0} s {from_unit} of {came} frames from the unit did not \
         come through, and the unit refused {to_unit} — check the cable, its plugs and whether another program uses \
         the port",
        .within.as_secs()
    )]
    BadLine {
        /// The time in which it did.
        within: Duration,
        /// Frames of the unit that did not come through.
        from_unit: u64,
        /// Frames of the unit, these included.
        came: u64,
        /// Frames that the unit refused.
        to_unit: u64,
    },
    /// The unit that answers differs from the one before.
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
    /// The unit answers, and does not give an entry that it says it has.
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
    /// An instrument of the bench failed: it tells nothing of the unit and of the line to it.
    pub const fn is_of_the_bench(&self) -> bool {
        matches!(self, Self::Instrument { .. })
    }
}

/// Fault of an instrument of the bench: never a fault of the unit. Texts are the instrument's or the system's own.
#[derive(Clone, Debug, PartialEq, Eq, Error, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InstrumentFault {
    /// Nobody answers there.
    #[error("not reached at {at}: {why}")]
    NotThere {
        /// Where it should be.
        at: String,
        /// The system's word.
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
        /// Part of the answer to `*IDN?` that its driver names.
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
    /// The line of the instrument is locked.
    #[error("another program of this computer uses it")]
    Taken,
    /// A carrier without a code was ordered.
    #[error("its driver has no commands for a carrier that is not modulated")]
    NoUnmodulated,
    /// Samples beyond what the sound card makes at most.
    #[error("the waveform is louder than it can play")]
    TooLoud,
    /// Samples pile up.
    #[error("the device takes no samples")]
    TakesNoSamples,
    /// No program of the system plays.
    #[error("no program carries sound here: neither {server} nor {alsa} is installed")]
    NoPlayer {
        /// Error of the sound server.
        server: String,
        /// Error of ALSA.
        alsa: String,
    },
    /// The card plays, and is not heard.
    #[error("nothing that it plays is heard at {0}")]
    NotHeard(String),
    /// The program ended without a word.
    #[error("the program that plays on it has ended")]
    PlayerEnded,
    /// The instrument reports an error after a command.
    #[error("it refused {command}: {error}")]
    Refused {
        /// Command as it was sent.
        command: String,
        /// The entry of its error queue, as it answered.
        error: String,
    },
    /// The instrument has more errors than its queue holds.
    #[error("its error queue is full: {0}")]
    QueueFull(String),
    /// A value beyond what its driver states.
    #[error("{value} is out of range for {what}, which takes {low} to {high}")]
    OutOfRange {
        /// The driver's name of the value.
        what: String,
        /// Value that the driver would have set.
        value: String,
        /// Least that the driver states.
        low: String,
        /// Greatest that the driver states.
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
    /// The contact that proves a relay says otherwise.
    #[error("the relay of {contact} is stuck: it was ordered {ordered} and is proved {}", 1 - .ordered)]
    Stuck {
        /// Stimulus of the bench file that the relay makes.
        contact: String,
        /// 1 = it was to close, 0 = to open.
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
    /// No check sequence fits.
    #[error("wrong baud rate?")]
    BaudRate,
    /// Frames come that this end has sent.
    #[error("the tester's own frames come back: is the unit on this port?")]
    Echo,
    /// Frames are whole, and of something else.
    #[error("check the cable and what is connected to this port")]
    OtherDevice,
}

/// Frames that were refused while a unit was silent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Refused {
    /// Number of frames that do not continue those before, as from a unit that starts again and
    /// again.
    OfStarts(u64),
    /// Number of frames refused for any reason.
    Frames(u64),
}

/// A property of a unit that is not what it was.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Changed {
    /// The property that differs.
    pub property: Property,
    /// Value that the unit told first.
    pub was: String,
    /// Value that the unit tells now.
    pub is: String,
}

/// Property of its identity by which a unit is seen to be another one.
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
