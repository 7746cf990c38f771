//! Waits for a unit to settle: after power-up, and between procedures.

use btu_rig::procedure::UnitEvent;
use btu_rig::rig::{Bench, UnitLink};
use protocol::Duration;
use protocol::event::Event;
use protocol::signal::{Sample, Signal};

use super::fault_watch::{self, FaultSeen};
use super::session::Session;

/// Time a unit may take from power-up, or from first contact, until it is ready.
pub(crate) const READY_WITHIN: Duration = Duration::from_ms(8_000);
/// Quiet time after a unit is ready, before anything is judged.
const SETTLE: Duration = Duration::from_ms(500);
/// Number of waits for a quiet unit on a computer that is held up.
const SETTLES: usize = 3;

/// Waits until the unit has settled. What the unit still logs because of the last procedure does not count against the
/// next, but the train's equipment may break at any time, and nothing else would report that.
pub(super) fn between_procedures<L: UnitLink>(session: &mut Session<L>) -> Vec<FaultSeen> {
    let mut found = Vec::new();
    let mut seen = |entry: &UnitEvent, at, sample: &Sample| {
        if Event::from_code(entry.code).is_some_and(Event::about_train)
            && fault_watch::is_fault(entry)
        {
            found.push(fault_watch::of_event(entry, at, sample));
        }
    };
    // A bench that was held up has made the unit brake, and it has to settle again.
    for _ in 0..SETTLES {
        session.make_up(&mut |_| {}, &mut seen);
        session.has_stalled();
        session.idle(READY_WITHIN, &mut seen, settled());
        if !session.has_stalled() {
            break;
        }
    }
    found
}

/// Whether the unit is ready and its log read, [`SETTLE`] after it first was; asked at each scan.
pub(crate) fn settled<L: UnitLink>() -> impl FnMut(&Bench<L>) -> bool {
    let mut quiet_since = None;
    move |bench| {
        if !started(bench) || !bench.rig.log_up_to_date() {
            return false;
        }
        let since = *quiet_since.get_or_insert(bench.now());
        bench.now().since(since) >= SETTLE
    }
}

/// The unit has started, and has said what can be known of it on this connection.
pub(super) fn started<L: UnitLink>(bench: &Bench<L>) -> bool {
    bench.rig.sample().get(Signal::Started) == Some(1.0) && bench.rig.knows_what_is_told()
}
