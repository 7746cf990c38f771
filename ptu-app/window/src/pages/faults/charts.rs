//! Counts for the charts: over time, by unit, by code.

use std::collections::BTreeMap;

use fault_db::DailyCount;

use crate::parts::look_back::DAY_US;

/// As many bars as a chart over time has at most.
const MOST_BARS: i64 = 60;
/// As many bars as a chart by name has.
const MOST_NAMES: usize = 6;

/// Counts over time: `days` to a bar, the first bar beginning at `from_us`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CountsOverTime {
    /// Beginning of the first bar.
    pub from_us: i64,
    /// Days to a bar.
    pub days: i64,
    /// Counts, oldest first.
    pub bars: Vec<u64>,
}

/// Counts of what `counts` has, as long bars as it takes to show all of it.
pub fn over_time(counts: &[&DailyCount]) -> Option<CountsOverTime> {
    let first = counts.iter().map(|count| count.day_us).min()?;
    let last = counts.iter().map(|count| count.day_us).max()?;
    let all_days = (last - first) / DAY_US + 1;
    let days = (all_days + MOST_BARS - 1) / MOST_BARS;
    let mut bars = vec![0; usize::try_from((all_days + days - 1) / days).unwrap_or(1)];
    for count in counts {
        let bar = (count.day_us - first) / DAY_US / days;
        if let Some(bar) = usize::try_from(bar).ok().and_then(|bar| bars.get_mut(bar)) {
            *bar += count.count;
        }
    }
    Some(CountsOverTime {
        from_us: first,
        days,
        bars,
    })
}

/// The names seen most often with their counts, and how many times all others were.
pub fn by_name<'a, N: Ord>(
    counts: &[&'a DailyCount],
    name: impl Fn(&'a DailyCount) -> N,
) -> (Vec<(N, u64)>, u64) {
    let mut sums = BTreeMap::new();
    for count in counts {
        *sums.entry(name(count)).or_insert(0) += count.count;
    }
    let mut sums: Vec<_> = sums.into_iter().collect();
    sums.sort_by(|(a, of_a), (b, of_b)| of_b.cmp(of_a).then_with(|| a.cmp(b)));
    let others = sums.iter().skip(MOST_NAMES).map(|(_, count)| count).sum();
    sums.truncate(MOST_NAMES);
    (sums, others)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(day: i64, unit: &str, count: u64) -> DailyCount {
        DailyCount {
            day_us: day * DAY_US,
            unit_serial: unit.into(),
            code: 600,
            code_name: "eb_relay_slow".into(),
            lru: "eb_relay".into(),
            count,
        }
    }

    #[test]
    fn every_occurrence_is_in_one_bar_whatever_the_span() {
        for last in [0, 1, 59, 60, 61, 400, 4000] {
            let counts = [seen(0, "A", 2), seen(last, "B", 3), seen(last / 2, "A", 1)];
            let counts: Vec<_> = counts.iter().collect();
            let chart = over_time(&counts).expect("chart");
            assert_eq!(chart.bars.iter().sum::<u64>(), 6, "{last} days");
            assert!(chart.bars.len() <= MOST_BARS as usize, "{last} days");
        }
        assert_eq!(over_time(&[]), None);
    }

    #[test]
    fn the_most_frequent_bars_come_first_and_the_rest_are_summed() {
        let units: Vec<String> = (0..9).map(|unit| format!("U{unit}")).collect();
        let counts: Vec<_> = units
            .iter()
            .zip(1..)
            .map(|(unit, n)| seen(0, unit, n))
            .collect();
        let counts: Vec<_> = counts.iter().collect();
        let (names, others) = by_name(&counts, |count| count.unit_serial.as_str());
        assert_eq!(names[0], ("U8", 9));
        assert_eq!(others, 1 + 2 + 3);
    }
}
