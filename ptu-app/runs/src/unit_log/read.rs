//! Reads a unit's log to its end, or until the link fails.

use btu_rig::procedure::UnitEvent;
use btu_rig::rig::{LogSession, StoredData, TimeOfDay, UnitLink};
use protocol::message::{Identity, Mode, StatusBits, StoredClock, StoredRow};
use protocol::{Duration, Instant, SCAN};

use super::date::{ClockPair, StoredClocks, dates};
use crate::clock::NOT_KNOWN_MS;
use crate::failure::BrokenOff;
use crate::link::Pace;
use crate::stop::Stop;

/// Time that a log may take, beside the time for stored entries: a full log takes a tenth of this.
const READ_WITHIN: Duration = Duration::from_ms(60_000);
/// Time that a stored entry may take, µs: twice the time that it takes.
const PER_STORED_US: u64 = 34_000;

/// An entry with its date.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    pub event: UnitEvent,
    /// When the unit made the entry, µs UTC; none where the unit's clock does not tell.
    pub at_us: Option<i64>,
    /// The date is right within a known uncertainty: what is dated so may be left out by its date.
    pub is_sure: bool,
    /// Where the entry is stored; none in a unit without stored memory.
    pub stored: Option<StoredPlace>,
}

/// The place of an entry in the unit's stored memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StoredPlace {
    /// Power-up in which the entry was made.
    pub power_up: u32,
    /// Sequence number of the entry in the store, over all power-ups.
    pub sequence: u32,
    /// The entry was made at this time at the latest, µs UTC: the date of the next entry that has one.
    pub not_after_us: Option<i64>,
    /// Greatest error of the entry's date, µs; none = unknown.
    pub uncertainty_us: Option<i64>,
}

/// Result of reading the unit's stored memory.
#[derive(Clone, Debug, Default)]
pub struct StoredRead {
    pub power_up: u32,
    /// Rows of the run record, if they were asked for.
    pub rows: Vec<StoredRow>,
    /// Clocks that date entries and rows.
    pub clocks: StoredClocks,
    /// Entries that are damaged in the unit.
    pub damaged: u64,
    /// Notes for a reader: times that contradict each other, a power-up count that falls, a memory that
    /// failed.
    pub notes: Vec<String>,
}

#[derive(Clone, Debug)]
pub struct LogRead {
    pub identity: Identity,
    /// Entries of the log, in order.
    pub entries: Vec<Entry>,
    /// Entries the unit had overwritten or cleared before.
    pub overwritten: u64,
    /// Entries beyond what a log can hold: counted, and not among the entries.
    pub not_kept: u64,
    /// Times the unit was started again meanwhile.
    pub restarts: u32,
    /// States of the unit at the end.
    pub status: StatusBits,
    /// Operating mode at the end.
    pub mode: Option<Mode>,
    /// Why reading ended before the log did.
    pub broken_off: Option<BrokenOff>,
    /// Result of reading the stored memory; none for an older unit, whose log covers the present
    /// power-up alone.
    pub stored: Option<StoredRead>,
}

/// Reads the log of the unit on `link`, over all power-ups if it stores it; with `rows`, its stored run record, too.
/// Times of the link begin after `from`; `clock` gives this computer's time, µs UTC, which the unit is sent with its
/// uncertainty.
///
/// # Errors
/// The unit did not say who it is: why.
pub fn read_log<L: UnitLink>(
    link: &mut L,
    from: Instant,
    rows: bool,
    pace: &mut Pace,
    stop: &Stop,
    (clock, uncertainty_ms): (&dyn Fn() -> i64, u16),
) -> Result<LogRead, BrokenOff> {
    let mut session = LogSession::new(rows);
    session.tell_time(TimeOfDay {
        at: from,
        utc_us: clock(),
        uncertainty_ms,
    });
    let mut entries = Vec::new();
    let mut since_power_up: Vec<UnitEvent> = Vec::new();
    let mut pair: Option<ClockPair> = None;
    let (mut to_unit, mut from_unit) = (Vec::new(), Vec::new());
    let mut restarts = 0;
    let mut within = READ_WITHIN;
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
            // Entries read before are of the unit's clock before it started again.
            restarts = session.restarts();
            entries.extend(dated(&mut since_power_up, pair.take(), uncertainty_ms));
        }
        if let Some((told_at, uptime_ms)) = session.uptime_ms()
            && told_at == now
        {
            let at_us = clock();
            pair = Some(ClockPair { uptime_ms, at_us });
        }
        since_power_up.extend(session.take_events());
        if let Err(broken) = exchanged {
            break Some(session.turned_away().unwrap_or(broken).into());
        }
        if session.is_complete() {
            break None;
        }
        if let Some(error) = session.link_error(now) {
            break Some(error.into());
        }
        if stop.presses() > 0 {
            break Some(BrokenOff::Stopped);
        }
        let longer = Duration::from_us(u64::from(session.left()) * PER_STORED_US);
        within = within.max(now.since(from) + longer);
        // By the clock: a unit that sends more than can be read in a scan holds the scans up.
        if now.since(from) + pace.behind() > within {
            break Some(BrokenOff::TooLong(within));
        }
    };
    entries.extend(dated(&mut since_power_up, pair, uncertainty_ms));
    let Some(identity) = session.identity().copied() else {
        return Err(broken_off.unwrap_or(BrokenOff::Stopped));
    };
    let stored = session.stored().map(|(events, rows)| {
        // A unit that started again while its log was read does not say beside which power-up this computer's clock
        // stands; the times that the unit was sent and has stored do.
        let (dated, read) =
            from_store(events, rows, pair.filter(|_| restarts == 0), uncertainty_ms);
        entries = dated;
        read
    });
    Ok(LogRead {
        identity,
        entries,
        overwritten: session.overwritten()
            + session.stored().map_or(0, |(events, _)| events.overwritten),
        not_kept: session.not_kept(),
        restarts,
        status: session.status.unwrap_or(StatusBits::empty()),
        mode: session.mode,
        broken_off,
        stored,
    })
}

fn dated(events: &mut Vec<UnitEvent>, clock: Option<ClockPair>, uncertainty_ms: u16) -> Vec<Entry> {
    let dates = dates(events, clock);
    let events = events.drain(..).zip(dates);
    events
        .map(|(event, at_us)| Entry {
            event,
            at_us,
            is_sure: uncertainty_ms != NOT_KNOWN_MS,
            stored: None,
        })
        .collect()
}

/// Entries of the store with their dates; `pair` is the unit's clock beside this computer's, now.
fn from_store(
    events: &StoredData,
    rows: Option<&StoredData>,
    pair: Option<ClockPair>,
    uncertainty_ms: u16,
) -> (Vec<Entry>, StoredRead) {
    let ours = pair.map(|pair| StoredClock {
        sequence: u32::MAX,
        power_up: events.power_up,
        at_ms: pair.uptime_ms,
        utc_ms: u64::try_from(pair.at_us / 1000).unwrap_or(0),
        uncertainty_ms,
    });
    let clocks = StoredClocks::new(&events.clocks, ours);
    let mut not_after_us = None;
    let backwards = events.entries.iter().rev().map(|entry| {
        let date = clocks.date(entry.power_up, entry.at_ms);
        let at_us = date.map(|date| date.at_us);
        let place = StoredPlace {
            power_up: entry.power_up,
            sequence: entry.sequence,
            not_after_us,
            uncertainty_us: date.and_then(|date| date.uncertainty_us),
        };
        not_after_us = at_us.or(not_after_us);
        Entry {
            event: UnitEvent::of_log(&entry.log_entry()),
            at_us,
            is_sure: place.uncertainty_us.is_some(),
            stored: Some(place),
        }
    });
    let mut entries: Vec<_> = backwards.collect();
    entries.reverse();
    let mut notes = clocks.contradictions.clone();
    let falls = events
        .entries
        .windows(2)
        .find(|pair| pair[1].power_up < pair[0].power_up);
    notes.extend(falls.map(|pair| {
        format!(
            "the count of power-ups falls from {} to {}: the unit's memory was exchanged or erased",
            pair[0].power_up, pair[1].power_up
        )
    }));
    let damaged = events.damaged + rows.map_or(0, |rows| rows.damaged);
    if damaged > 0 {
        notes.push(format!(
            "{damaged} stored entries are damaged in the unit and could not be read; all others were"
        ));
    }
    if events.failed {
        notes.push(
            "the unit's stored memory failed: what it held is lost, and it stores nothing"
                .to_owned(),
        );
    }
    let read = StoredRead {
        power_up: events.power_up,
        rows: rows.map(|rows| rows.rows.clone()).unwrap_or_default(),
        clocks,
        damaged,
        notes,
    };
    (entries, read)
}

#[cfg(test)]
pub(super) mod tests;
