//! Dates the entries of a unit's log from the unit's own clock, as far as it is known.

use std::collections::{BTreeMap, BTreeSet};

use btu_rig::procedure::UnitEvent;
use protocol::event::Event;
use protocol::message::StoredClock;

use crate::clock::NOT_KNOWN_MS;

/// Time by which an entry may be younger than the uptime it is dated by, ms: it was logged while the log was read.
const YOUNGER_MS: u64 = 60_000;

/// The unit's clock beside this computer's, at one moment.
#[derive(Clone, Copy, Debug)]
pub struct ClockPair {
    /// Time since power-up as the unit reported it, ms.
    pub uptime_ms: u32,
    /// This computer's time at that moment, µs UTC.
    pub at_us: i64,
}

/// Drift between two oscillators, 100 ppm: 1 in this number.
const DRIFT: i64 = 10_000;

/// Times of day that the unit was sent and has stored, by which its entries are dated.
#[derive(Clone, Debug, Default)]
pub struct StoredClocks {
    /// Times that nothing disproves.
    clocks: Vec<StoredClock>,
    /// This computer's clock, if it is known to be right.
    ours: Option<StoredClock>,
    /// Power-ups whose times contradict others: which is right is unknown.
    doubtful: BTreeSet<u32>,
    /// Contradictions, as sentences: times of one power-up further apart than their uncertainties; a power-up that
    /// begins before the previous one.
    pub contradictions: Vec<String>,
}

/// The date of a stored entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StoredDate {
    /// µs UTC.
    pub at_us: i64,
    /// Greatest error of the date, µs; none = unknown, the day may be wrong.
    pub uncertainty_us: Option<i64>,
}

impl StoredClocks {
    /// Makes them of the clocks that the unit was `told`, and of `ours`, this computer's in the present power-up. A
    /// clock that ours disproves, if ours is known to be right, dates nothing.
    pub fn new(told: &[StoredClock], ours: Option<StoredClock>) -> Self {
        let known = ours.filter(|ours| ours.uncertainty_ms != NOT_KNOWN_MS);
        let all: Vec<_> = told.iter().copied().chain(ours).collect();
        let contradictions = contradictions(&all).into_values().collect();
        let is_disproved = |clock: &StoredClock| known.is_some_and(|ours| disproves(&ours, clock));
        let clocks: Vec<_> = all
            .into_iter()
            .filter(|clock| !is_disproved(clock))
            .collect();
        let doubtful = contradictions_of(&clocks).flat_map(|(a, b, _)| [a.power_up, b.power_up]);
        Self {
            doubtful: doubtful.collect(),
            clocks,
            ours: known,
            contradictions,
        }
    }

    /// The date of an entry, by the best clock of its power-up; `None` where no time was sent in it, and where the date
    /// of an earlier power-up lies after the beginning of the present one.
    pub fn date(&self, power_up: u32, at_ms: u32) -> Option<StoredDate> {
        let of_power_up = self
            .clocks
            .iter()
            .filter(|clock| clock.power_up == power_up);
        let is_doubtful = self.doubtful.contains(&power_up);
        let dates = of_power_up.map(|clock| {
            let later_us = (i64::from(at_ms) - i64::from(clock.at_ms)) * 1000;
            let uncertainty_us = uncertainty_us(clock).map(|us| us + later_us.abs() / DRIFT);
            let date = StoredDate {
                at_us: utc_us(clock).saturating_add(later_us),
                uncertainty_us: uncertainty_us.filter(|_| !is_doubtful),
            };
            (uncertainty_us.unwrap_or(i64::MAX), date)
        });
        // Of two equally good dates, the time sent last counts.
        let best = dates.reduce(|best, date| match date.0 <= best.0 {
            true => date,
            false => best,
        });
        let is_past = |date: &StoredDate| {
            let ours = self.ours.filter(|ours| power_up < ours.power_up);
            let allowed_us = date.uncertainty_us.unwrap_or(0);
            ours.is_none_or(|ours| date.at_us - allowed_us <= began_us(&ours))
        };
        best.map(|(_, date)| date).filter(is_past)
    }
}

/// Whether a clock that is right says that the other was wrong: at another time of the same power-up, or later than
/// the power-up of the right one began.
fn disproves(right: &StoredClock, other: &StoredClock) -> bool {
    match right.power_up == other.power_up {
        true => apart_us(other, right).is_some(),
        false => {
            let allowed_us = uncertainty_us(other).unwrap_or(0);
            other.power_up < right.power_up && utc_us(other) - allowed_us > began_us(right)
        }
    }
}

/// The latest time at which the power-up of this clock began.
fn began_us(clock: &StoredClock) -> i64 {
    let up_us = i64::from(clock.at_ms) * 1000;
    utc_us(clock) - up_us + i64::from(clock.uncertainty_ms) * 1000 + up_us / DRIFT
}

fn uncertainty_us(clock: &StoredClock) -> Option<i64> {
    let known = Some(clock.uncertainty_ms).filter(|ms| *ms != NOT_KNOWN_MS);
    known.map(|ms| i64::from(ms) * 1000)
}

/// Difference of two clocks, of which the second was sent later, µs, if it is more than permitted; negative if the
/// time fell.
fn apart_us(before: &StoredClock, clock: &StoredClock) -> Option<i64> {
    let told_later_us = utc_us(clock) - utc_us(before);
    let allowed_us = (i64::from(clock.uncertainty_ms) + i64::from(before.uncertainty_ms)) * 1000;
    if before.power_up != clock.power_up {
        return Some(told_later_us).filter(|later_us| *later_us < -allowed_us);
    }
    let passed_us = (i64::from(clock.at_ms) - i64::from(before.at_ms)) * 1000;
    let apart_us = told_later_us - passed_us;
    Some(apart_us).filter(|apart_us| apart_us.abs() > allowed_us + passed_us.abs() / DRIFT)
}

/// Clocks, one after the other, that do not go together, and how far they are apart.
fn contradictions_of(
    clocks: &[StoredClock],
) -> impl Iterator<Item = (&StoredClock, &StoredClock, i64)> {
    let pairs = clocks.windows(2).map(|pair| (&pair[0], &pair[1]));
    pairs.filter_map(|(before, clock)| {
        apart_us(before, clock).map(|apart_us| (before, clock, apart_us))
    })
}

fn contradictions(clocks: &[StoredClock]) -> BTreeMap<u32, String> {
    let mut found: BTreeMap<u32, String> = BTreeMap::new();
    for (before, clock, apart_us) in contradictions_of(clocks) {
        let told = match before.power_up == clock.power_up {
            true => format!(
                "in power-up {} the unit was told times that are {:.1} s apart: its entries are dated by \
                 the one with the least uncertainty, and none that another clock disproves",
                clock.power_up,
                apart_us as f64 / 1e6
            ),
            false => format!(
                "the time told in power-up {} is {:.1} s before that of power-up {}: a tester's clock was set \
                 back or was wrong",
                clock.power_up,
                -apart_us as f64 / 1e6,
                before.power_up
            ),
        };
        found.entry(clock.power_up).or_insert(told);
    }
    found
}

fn utc_us(clock: &StoredClock) -> i64 {
    i64::try_from(clock.utc_ms).map_or(i64::MAX, |ms| ms.saturating_mul(1000))
}

/// Dates of `entries`, which are in order, µs UTC; `None` for an entry of another clock: one that stands before the
/// entry of the last power-up, or before a time that falls.
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

    const NOW_US: i64 = 1_000_000_000_000;

    fn dated(entries: &[(Event, u32)], uptime_ms: u32) -> Vec<Option<i64>> {
        let entries: Vec<_> = (0..)
            .zip(entries)
            .map(|(index, (code, at_ms))| UnitEvent::at_stand(index, *code, *at_ms))
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
        // Logged half a second after the unit reported its uptime.
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
            Some(Some(56_000))
        );
        assert_eq!(
            (at_s(2, 0), at_s(3, 7_000), at_s(4, 0)),
            (None, Some(9_007), Some(19_999))
        );
        assert!(clocks.contradictions.is_empty());
    }

    #[test]
    fn times_that_do_not_go_together_are_told() {
        let back = StoredClocks::new(&[told(1, 0, 9_000, 50), told(2, 0, 8_000, 50)], None);
        let [why] = &back.contradictions[..] else {
            panic!("one");
        };
        assert!(why.contains("1000.0 s before that of power-up 1"), "{why}");
        let apart = StoredClocks::new(&[told(1, 0, 9_000, 50), told(1, 10_000, 9_020, 50)], None);
        let [why] = &apart.contradictions[..] else {
            panic!("one");
        };
        assert!(why.contains("10.0 s apart"), "{why}");
    }

    /// Goal: a laptop that read first, with a clock a year behind, dates nothing once a right one has read. Method:
    /// both in one power-up; the first knows that its clock is not set, or does not know it.
    #[test]
    fn the_better_date_replaces_the_worse() {
        const YEAR_S: u64 = 31_536_000;
        let right = |uncertainty_ms| told(1, 60_000, 2 * YEAR_S, uncertainty_ms);
        for of_wrong in [NOT_KNOWN_MS, 500] {
            let wrong = told(1, 5_000, YEAR_S, of_wrong);
            let clocks = StoredClocks::new(&[wrong], Some(right(500)));
            let date = clocks.date(1, 4_000).expect("a date");
            assert_eq!(date.at_us / 1_000_000, (2 * YEAR_S - 56) as i64);
            assert!(date.uncertainty_us.is_some());
            assert_eq!(clocks.contradictions.len(), 1);
            // Nobody knows which of two is right.
            let clocks = StoredClocks::new(&[wrong], Some(right(NOT_KNOWN_MS)));
            let date = clocks.date(1, 4_000).expect("a date");
            assert_eq!(date.uncertainty_us, None);
        }
    }

    #[test]
    fn a_date_that_the_units_uptime_disproves_is_none() {
        // Up for 100 s: what it logged in the power-up before is older.
        let ours = told(2, 100_000, 9_000, 500);
        let date = |before| StoredClocks::new(&[before], Some(ours)).date(1, 2_000);
        assert_eq!(date(told(1, 1_000, 9_500, 500)), None, "told in the future");
        assert_eq!(
            date(told(1, 1_000, 8_950, 500)),
            None,
            "told while it was up"
        );
        let good = date(told(1, 1_000, 8_800, 500)).expect("a date");
        assert_eq!(good.at_us, 8_801_000_000);
        let unsure = StoredClocks::new(
            &[told(1, 1_000, 9_500, 500)],
            Some(told(2, 100_000, 9_000, NOT_KNOWN_MS)),
        );
        assert_eq!(
            unsure.date(1, 2_000).map(|date| date.uncertainty_us),
            Some(None)
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
        assert_eq!(
            dates(&[UnitEvent::at_stand(0, Event::TwcLost, 1)], None),
            [None]
        );
    }
}
