//! What one scan gives to everything that watches.

use protocol::Instant;
use protocol::signal::Sample;

use super::UnitTime;
use super::condition::Captured;

/// What one scan gives to everything that watches.
#[derive(Clone, Copy)]
pub(super) struct Scan<'a> {
    pub now: Instant,
    pub sample: &'a Sample,
    pub captured: &'a Captured,
    /// Clock by which reactions of the unit are timed; `None` = `now`.
    pub unit_time: Option<UnitTime>,
}
