//! Dates the entries of a unit's log from the unit's own clock, as far as it is known.

use btu_rig::procedure::UnitEvent;
use protocol::event::Event;

/// An entry may be so much younger than the uptime it is dated by, ms: it was logged while the log was
/// read.
const YOUNGER_MS: u64 = 60_000;

/// The unit's clock beside ours.
#[derive(Clone, Copy, Debug)]
pub struct ClockPair {
    /// Time since power-up as the unit told it, ms.
    pub uptime_ms: u32,
    /// Our own time when it did, µs UTC.
    pub at_us: i64,
}

/// Dates of `entries`, which are in order, µs UTC; none for what the clock cannot date: what stands
/// before the entry of the last power-up, or before a time that falls, is of another clock.
pub fn dates(entries: &[UnitEvent], clock: Option<ClockPair>) -> Vec<Option<i64>> {
    let Some(clock) = clock else {
        return vec![None; entries.len()];
    };
    let mut latest_ms = Some(u64::from(clock.uptime_ms) + YOUNGER_MS);
    let backwards = entries.iter().rev().map(|entry| {
        let at_ms = u64::from(entry.at_ms);
        latest_ms = latest_ms.filter(|latest_ms| at_ms <= *latest_ms);
        let date = latest_ms.map(|_| {
            let age_ms = i64::from(clock.uptime_ms) - i64::from(entry.at_ms);
            clock.at_us - age_ms * 1000
        });
        let first = entry.code == Event::PowerUp.definition().code;
        latest_ms = latest_ms.filter(|_| !first).map(|_| at_ms);
        date
    });
    let mut dates: Vec<_> = backwards.collect();
    dates.reverse();
    dates
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::read::tests::event;

    const NOW_US: i64 = 1_000_000_000_000;

    fn dated(entries: &[(Event, u32)], uptime_ms: u32) -> Vec<Option<i64>> {
        let entries: Vec<_> = (0..)
            .zip(entries)
            .map(|(index, (code, at_ms))| event(index, *code, *at_ms))
            .collect();
        let clock = ClockPair {
            uptime_ms,
            at_us: NOW_US,
        };
        dates(&entries, Some(clock))
    }

    #[test]
    fn an_entry_is_dated_by_the_age_that_the_units_clock_gives() {
        let entries = [(Event::PowerUp, 0), (Event::TachoDead1, 4_000)];
        let seconds = |s: i64| Some(NOW_US - s * 1_000_000);
        assert_eq!(dated(&entries, 10_000), [seconds(10), seconds(6)]);
        // Logged half a second after the unit told its uptime.
        assert_eq!(
            dated(&[(Event::TwcLost, 10_500)], 10_000),
            [Some(NOW_US + 500_000)]
        );
    }

    /// Goal: no confident wrong date. Method: entries that the present power-up cannot have made.
    #[test]
    fn an_entry_of_an_earlier_power_up_has_no_date() {
        let restarted = [
            (Event::TachoDead1, 4_000),
            (Event::PowerUp, 5_000),
            (Event::TwcLost, 6_000),
        ];
        assert_eq!(dated(&restarted, 7_000)[0], None);
        assert!(dated(&restarted, 7_000)[1..].iter().all(Option::is_some));
        let overwritten = [(Event::TachoDead1, 900_000), (Event::TwcLost, 6_000)];
        assert_eq!(dated(&overwritten, 7_000)[0], None);
        assert_eq!(dated(&[(Event::TwcLost, 900_000)], 7_000), [None]);
        assert_eq!(dates(&[event(0, Event::TwcLost, 1)], None), [None]);
    }
}
