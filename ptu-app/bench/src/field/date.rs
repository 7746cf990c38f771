//! Dates the entries of a unit's log from the unit's own clock, as far as it is known.

use std::collections::BTreeMap;

use btu_rig::procedure::UnitEvent;
use protocol::event::Event;
use protocol::message::StoredClock;

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

/// Two oscillators may go apart by so much: 100 ppm.
const DRIFT: i64 = 10_000;

/// What a store of the unit says of the times it was told.
#[derive(Clone, Debug, Default)]
pub struct StoredClocks {
    clocks: Vec<StoredClock>,
}

/// The date of a stored entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StoredDate {
    /// µs UTC.
    pub at_us: i64,
    /// It may be wrong by so much, µs.
    pub uncertainty_us: i64,
}

impl StoredClocks {
    /// Clocks that the unit was told, and ours beside the present power-up's.
    pub fn new(told: &[StoredClock], ours: Option<StoredClock>) -> Self {
        Self {
            clocks: told.iter().copied().chain(ours).collect(),
        }
    }

    /// The date of an entry, by the clock of its power-up that says it best; none where nobody told the time.
    pub fn date(&self, power_up: u32, at_ms: u32) -> Option<StoredDate> {
        let of_power_up = self
            .clocks
            .iter()
            .filter(|clock| clock.power_up == power_up);
        let dates = of_power_up.map(|clock| {
            let later_us = (i64::from(at_ms) - i64::from(clock.at_ms)) * 1000;
            StoredDate {
                at_us: utc_us(clock).saturating_add(later_us),
                uncertainty_us: i64::from(clock.uncertainty_ms) * 1000 + later_us.abs() / DRIFT,
            }
        });
        // Of equals the one told last.
        dates.reduce(
            |best, date| match date.uncertainty_us <= best.uncertainty_us {
                true => date,
                false => best,
            },
        )
    }

    /// What does not go together: times of one power-up further apart than their uncertainties, and a power-up that
    /// begins before the one that came before it.
    pub fn contradictions(&self) -> Vec<String> {
        let mut found: BTreeMap<u32, String> = BTreeMap::new();
        for pair in self.clocks.windows(2) {
            let (before, clock) = (&pair[0], &pair[1]);
            let told_later_us = utc_us(clock) - utc_us(before);
            if before.power_up == clock.power_up {
                let passed_us = (i64::from(clock.at_ms) - i64::from(before.at_ms)) * 1000;
                let allowed_ms = i64::from(clock.uncertainty_ms) + i64::from(before.uncertainty_ms);
                let apart_us = told_later_us - passed_us;
                if apart_us.abs() > allowed_ms * 1000 + passed_us.abs() / DRIFT {
                    found.entry(clock.power_up).or_insert(format!(
                        "in power-up {} the unit was told times that are {:.1} s apart: its entries are dated by \
                         the one with the least uncertainty",
                        clock.power_up,
                        apart_us as f64 / 1e6
                    ));
                }
            } else if told_later_us < 0 {
                found.entry(clock.power_up).or_insert(format!(
                    "the time told in power-up {} is {:.1} s before that of power-up {}: a tester's clock was set \
                     back or was wrong",
                    clock.power_up,
                    -told_later_us as f64 / 1e6,
                    before.power_up
                ));
            }
        }
        found.into_values().collect()
    }
}

fn utc_us(clock: &StoredClock) -> i64 {
    i64::try_from(clock.utc_ms).map_or(i64::MAX, |ms| ms.saturating_mul(1000))
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

    fn told(power_up: u32, at_ms: u32, utc_s: u64, uncertainty_ms: u16) -> StoredClock {
        StoredClock {
            sequence: 0,
            power_up,
            at_ms,
            utc_ms: utc_s * 1000,
            uncertainty_ms,
        }
    }

    /// Goal: each entry is dated by its own power-up, as well as it can be. Method: power-ups with two clocks,
    /// with one, and with none.
    #[test]
    fn stored_entries_are_dated_by_the_clock_of_their_power_up() {
        let clocks = [
            told(1, 5_000, 1_000, 500),
            told(1, 60_000, 1_055, 50),
            told(3, 0, 9_000, 500),
        ];
        let clocks = StoredClocks::new(&clocks, Some(told(4, 1_000, 20_000, 500)));
        let at_s = |power_up, at_ms| {
            clocks
                .date(power_up, at_ms)
                .map(|date| date.at_us / 1_000_000)
        };
        assert_eq!(at_s(1, 0), Some(995));
        assert_eq!(
            clocks.date(1, 0).map(|date| date.uncertainty_us),
            Some(56_000)
        );
        assert_eq!(
            (at_s(2, 0), at_s(3, 7_000), at_s(4, 0)),
            (None, Some(9_007), Some(19_999))
        );
        assert!(clocks.contradictions().is_empty());
    }

    #[test]
    fn times_that_do_not_go_together_are_told() {
        let back = StoredClocks::new(&[told(1, 0, 9_000, 50), told(2, 0, 8_000, 50)], None);
        let [why] = &back.contradictions()[..] else {
            panic!("one");
        };
        assert!(why.contains("1000.0 s before that of power-up 1"), "{why}");
        let apart = StoredClocks::new(&[told(1, 0, 9_000, 50), told(1, 10_000, 9_020, 50)], None);
        let [why] = &apart.contradictions()[..] else {
            panic!("one");
        };
        assert!(why.contains("10.0 s apart"), "{why}");
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
