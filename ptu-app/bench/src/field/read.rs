//! Reads a unit's log to its end, or until the link fails.

use btu_rig::procedure::UnitEvent;
use btu_rig::rig::{LogSession, UnitLink};
use protocol::message::{Identity, StatusBits};
use protocol::{Duration, Instant, SCAN};

use super::date::{ClockPair, dates};
use crate::link::Pace;
use crate::stop::Stop;

/// Time a log may take: a full one takes a tenth of it.
const READ_WITHIN: Duration = Duration::from_ms(60_000);

/// An entry with its date.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// The entry.
    pub event: UnitEvent,
    /// When it was made, µs UTC; none where the unit's clock does not tell.
    pub at_us: Option<i64>,
}

/// A log as read.
#[derive(Clone, Debug)]
pub struct LogRead {
    /// Who the unit is.
    pub identity: Identity,
    /// Its entries, in order.
    pub entries: Vec<Entry>,
    /// Entries the unit had overwritten or cleared before.
    pub overwritten: u64,
    /// Entries beyond what a log can hold: counted, and not among the entries.
    pub not_kept: u64,
    /// Times the unit was started again meanwhile.
    pub restarts: u32,
    /// Its states at the end.
    pub status: StatusBits,
    /// Why reading ended before the log did.
    pub broken_off: Option<String>,
}

/// Reads the log of the unit on `link`; times of the link begin after `from`, and `clock` gives our
/// own, µs UTC.
///
/// # Errors
/// The unit did not say who it is: why.
pub fn read_log<L: UnitLink>(
    link: &mut L,
    from: Instant,
    pace: &mut Pace,
    stop: &Stop,
    clock: &dyn Fn() -> i64,
) -> Result<LogRead, String> {
    let mut session = LogSession::default();
    let mut entries = Vec::new();
    let mut since_power_up: Vec<UnitEvent> = Vec::new();
    let mut pair: Option<ClockPair> = None;
    let (mut to_unit, mut from_unit) = (Vec::new(), Vec::new());
    let mut restarts = 0;
    let mut now = from;
    let broken_off = loop {
        pace.wait();
        now += SCAN;
        to_unit.clear();
        from_unit.clear();
        session.step(now, &mut to_unit);
        let exchanged = link.exchange(now, &to_unit, &mut from_unit);
        session.receive(now, &from_unit);
        if session.restarts() != restarts {
            // What was read before is of the clock before.
            restarts = session.restarts();
            entries.extend(dated(&mut since_power_up, pair.take()));
        }
        if let Some((told_at, uptime_ms)) = session.uptime_ms()
            && told_at == now
        {
            let at_us = clock();
            pair = Some(ClockPair { uptime_ms, at_us });
        }
        since_power_up.extend(session.take_events());
        if let Err(failure) = exchanged {
            break Some(session.turned_away().unwrap_or(failure.to_string()));
        }
        if session.is_complete() {
            break None;
        }
        if let Some(error) = session.link_error(now) {
            break Some(error);
        }
        if stop.presses() > 0 {
            break Some("stopped by the operator".to_owned());
        }
        // By the clock: a unit that sends more than can be read in a scan holds the scans up.
        if now.since(from) + pace.behind() > READ_WITHIN {
            break Some(format!("the log does not end within {READ_WITHIN}"));
        }
    };
    entries.extend(dated(&mut since_power_up, pair));
    let Some(identity) = session.identity().copied() else {
        return Err(broken_off.unwrap_or_default());
    };
    Ok(LogRead {
        identity,
        entries,
        overwritten: session.overwritten(),
        not_kept: session.not_kept(),
        restarts,
        status: session.status().unwrap_or(StatusBits::empty()),
        broken_off,
    })
}

fn dated(events: &mut Vec<UnitEvent>, clock: Option<ClockPair>) -> Vec<Entry> {
    let dates = dates(events, clock);
    let events = events.drain(..).zip(dates);
    events
        .map(|(event, at_us)| Entry { event, at_us })
        .collect()
}

#[cfg(test)]
pub(super) mod tests;
