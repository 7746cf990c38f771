//! How far the bench can trust what it receives: whether the unit's log is read, whether frames arrive as
//! they were sent, and what the unit's self-test reports.
//!
//! A verdict on the unit needs a good line between unit and bench. One byte stream carries all channels, so a
//! bad line looks like faults of several parts at once: channels lose frames, partners fall silent. Two
//! facts distinguish them. A failed part affects its own channel only: no part of a unit damages frames of
//! the tester or of the I/O rack. And the unit counts frames that fail their checks on arrival, which only
//! the line can have damaged: a modem loses frames after those checks.

use protocol::Duration;
use protocol::event::Event;
use protocol::message::{AtoFailure, SelfTest};

/// Progress of reading the unit's log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LogState {
    /// Every entry that the unit says it has logged is read.
    #[default]
    Read,
    /// Some entries are on their way.
    Behind,
    /// Some entries were asked for more than once, and nothing came.
    Unanswered,
}

impl LogState {
    /// Whether a wait of this length for entries of the log is over: after `least` once all is read, after `most` anyhow.
    pub(super) fn has_waited(self, waited: Duration, least: Duration, most: Duration) -> bool {
        waited >= most || waited >= least && self == Self::Read
    }
}

/// Frames between tester and unit that did not get through as they were sent, either way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineState {
    /// Since the bench began.
    pub lost_or_damaged: u64,
    pub lost_or_damaged_lately: u64,
    /// Nothing comes now: the line is lost, or the unit starts again.
    pub silent: bool,
    /// Time by which the last frames came later than others: the state of the unit that they show is as old.
    pub late: Duration,
}

/// Lower bounds, ms on the unit's clock, of the time of a change that a scan is the first to show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitTimeBounds {
    /// Of a change that the unit tells in the scan of the change.
    pub scan_ms: u32,
    /// Of a change that the unit tells in its next state frame.
    pub frame_ms: u32,
    /// Of a change that the unit tells in its next `Status`.
    pub cycle_ms: u32,
}

/// Time, on the unit's clock, at which the unit was as the sample of this scan shows: without a harness frames come at
/// no fixed time, and only their stamps date what they show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitTime {
    /// Stamp of the latest state: what is new in it happened by then, ms.
    pub stamp_ms: u32,
    pub after: UnitTimeBounds,
    /// Stamp of the latest answer to a request, ms; the request acts from the scan of this stamp on.
    pub answered_ms: Option<u32>,
}

/// Evidence by which a driver can trust the data that it receives; by default everything is received and read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Evidence {
    /// The unit's log.
    pub log: LogState,
    /// Entries of the unit's log beyond what a log can hold: counted and not handed on.
    pub not_kept: u64,
    /// The line to the unit.
    pub line: LineState,
    /// Excess of the unit's clock over the bench's, thousandths, if the unit's clock is wrong.
    pub clock_wrong_by_permille: Option<i32>,
    /// Self-test items that failed, as the unit says.
    pub self_test: SelfTest,
    /// Clock by which the unit's reactions are timed; `None` = the bench's clock.
    pub unit_time: Option<UnitTime>,
}

impl Evidence {
    /// Whether frames that did not get through may be why the unit or TCMS logged this event.
    pub fn explains(&self, event: Option<Event>, parameter: i32) -> bool {
        self.line.lost_or_damaged_lately > 0 && of_lost_frames(event, parameter)
    }

    /// Whether only later frames show if the unit or the line caused this event.
    pub fn leaves_open(&self, event: Option<Event>, parameter: i32) -> bool {
        self.line.silent && of_lost_frames(event, parameter)
    }
}

/// Whether the unit or TCMS logs this event when frames do not come.
fn of_lost_frames(event: Option<Event>, parameter: i32) -> bool {
    event.is_some_and(|event| match event {
        Event::InputsLost
        | Event::FramesRejected
        | Event::TwcLost
        | Event::TcmsLost
        | Event::AtcSilent
        | Event::AtcFramesRefused
        | Event::AtoInputAbsurd => true,
        Event::AtoFailed => parameter == i32::from(AtoFailure::Inputs.code()),
        _ => false,
    })
}
