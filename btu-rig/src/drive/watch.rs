//! Observations of a drive in each scan: the link, and what the unit says of mode and brakes.

use protocol::message::{EbCause, Mode};
use protocol::signal::{Sample, Signal};
use protocol::{CYCLE, Instant};

use crate::rig::{LinkTrouble, Rig};

/// Why the unit cannot be reached any more. Silence counts as trouble only after many cycles, so that one look a cycle
/// is enough.
pub(super) fn link_error(now: Instant, rig: &Rig) -> Option<LinkTrouble> {
    let cycle = now.as_us().is_multiple_of(CYCLE.as_us());
    cycle.then(|| rig.link_error())?
}

/// The unit's mode, if it is known.
pub(super) fn mode(sample: &Sample) -> Option<Mode> {
    sample
        .get(Signal::Mode)
        .map(|code| Mode::from_code(code as u8))
}

/// Why the emergency brake is applied, if the unit says so.
pub(super) fn eb_cause(sample: &Sample) -> Option<EbCause> {
    let cause = sample
        .get(Signal::EbCause)
        .map(|code| EbCause::from_code(code as u8));
    cause.filter(|cause| *cause != EbCause::None)
}
