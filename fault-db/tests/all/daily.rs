//! How often faults were seen a day: a day is one of the clock on the wall.

use crate::common::{T0_US, end, fault, open, run_record};
use fault_db::{RunWriter, Verdict};

const HOUR_US: i64 = 3_600_000_000;
const DAY_US: i64 = 24 * HOUR_US;

/// Goal: what is seen on either side of local midnight is of two days, of UTC's midnight of one.
/// Method: a fault at 14:59 and 15:01 UTC, which is 23:59 and 00:01 in Korea (+9 h), and at 01:00 UTC
/// of the next day.
#[test]
fn a_day_begins_at_midnight_of_the_clock_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = open(&folder.path().join("history.db"));
    let mut writer = RunWriter::begin(&store, &run_record("U-1")).expect("a run");
    let minute_us = HOUR_US / 60;
    for at_us in [
        15 * HOUR_US - minute_us,
        15 * HOUR_US + minute_us,
        25 * HOUR_US,
    ] {
        writer.fault(&fault(600, T0_US + at_us)).expect("a fault");
    }
    writer.finish(&end(Verdict::Failed)).expect("its end");
    let days = |since_us, offset_us| -> Vec<_> {
        let counts = store.daily_occurrences(since_us, offset_us);
        let counts = counts.expect("counts").into_iter();
        counts
            .map(|count| (count.day_us - T0_US, count.count))
            .collect()
    };
    assert_eq!(days(0, 0), [(0, 2), (DAY_US, 1)]);
    let korea = 9 * HOUR_US;
    assert_eq!(days(0, korea), [(-korea, 1), (DAY_US - korea, 2)]);
    // Three hours behind, all three are of the first day, which begins at 03:00 UTC.
    assert_eq!(days(0, -3 * HOUR_US), [(3 * HOUR_US, 3)]);
    let after = T0_US + 15 * HOUR_US;
    assert_eq!(days(after, korea), [(DAY_US - korea, 2)]);
}
