//! Data of one scan for whatever watches it: expectations, measurements, actions.

use protocol::Instant;
use protocol::signal::Sample;

use super::condition::Captured;
use super::{Evidence, UnitTime};

/// Data of one scan for whatever watches it.
#[derive(Clone, Copy)]
pub(super) struct Scan<'a> {
    pub now: Instant,
    pub sample: &'a Sample,
    pub captured: &'a Captured,
    /// Clock by which reactions of the unit are timed; `None` = `now`.
    pub unit_time: Option<UnitTime>,
}

impl<'a> Scan<'a> {
    pub(super) fn new(
        now: Instant,
        sample: &'a Sample,
        captured: &'a Captured,
        evidence: &Evidence,
    ) -> Self {
        Self {
            now,
            sample,
            captured,
            unit_time: evidence.unit_time,
        }
    }
}
