//! Resamples signals of a file at the times of a stored trace's rows.

use std::collections::BTreeSet;
use std::ops::Range;

use fault_db::TraceData;

use super::series::Import;
use ptu_runs::failure::{Asked, Failure};

/// Greatest rounding of a sample's time to before or after its row, µs.
const ROUNDING_US: i64 = 1;

/// A file's signals at a trace's rows, and the trace, whose samples are unknown where the file has none.
#[derive(Clone, Debug, PartialEq)]
pub struct Aligned {
    pub trace: TraceData,
    /// The file's signals, at the same rows.
    pub imported: TraceData,
    /// Names of the file's signals that the trace does not have: they are left out.
    pub unknown: Vec<String>,
    /// Rows of the trace for which the file has samples.
    pub rows: Range<usize>,
    /// Seconds from the trigger to the first and the last of these rows.
    pub window_s: (f64, f64),
    /// Whether the file's samples came at the trace's own rows.
    pub is_row_by_row: bool,
    /// Whether the file is of another time, so that its beginning was laid at the beginning of the trace.
    pub laid_at_begin: bool,
}

/// Aligns a file's signals with the rows of `trace`, `shift_us` later than they say: at each row stands the last
/// sample that came until then. A file with dates of another time begins with the trace.
///
/// # Errors
/// File and trace have no time in common, or one signal comes twice.
pub fn align(import: Import, mut trace: TraceData, shift_us: i64) -> Result<Aligned, Failure> {
    let trigger = i64::from(trace.trigger_row.unwrap_or(0));
    let period_us = trace.period_us.max(1);
    // From the file's clock to that of the rows.
    let zero_us = if import.is_utc {
        trace
            .t0_us
            .saturating_add(trigger.saturating_mul(period_us))
    } else {
        0
    };
    let row_us = |row: usize| (row as i64 - trigger).saturating_mul(period_us);
    let rows = trace.rows();
    let (begins_us, ends_us) = (row_us(0), row_us(rows.saturating_sub(1)));
    let span_us = span_us(&import);
    let mut later_us = shift_us.saturating_sub(zero_us);
    let at_us = |time_us: i64| time_us.saturating_add(later_us);
    // Recorded at another time, or by a clock that is wrong: no dates say how the two belong together.
    let is_elsewhere = at_us(span_us.1) < begins_us || at_us(span_us.0) > ends_us;
    let laid_at_begin = import.is_utc && shift_us == 0 && is_elsewhere;
    if laid_at_begin {
        later_us = begins_us.saturating_sub(span_us.0);
    }
    let mut imported = TraceData {
        t0_bench_us: trace.t0_bench_us,
        t0_us: trace.t0_us,
        period_us: trace.period_us,
        trigger_row: trace.trigger_row,
        gaps: true,
        ..TraceData::default()
    };
    let (mut first, mut end, mut is_row_by_row) = (rows, 0, true);
    let known: BTreeSet<&str> = trace.channels.iter().map(|c| c.name.as_str()).collect();
    let (mut names, mut unknown) = (BTreeSet::new(), Vec::new());
    for table in import.tables {
        let held = RowAlignment::new(&table.times_us, later_us, rows, row_us);
        first = first.min(held.rows.start);
        end = end.max(held.rows.end);
        is_row_by_row &= held.is_row_by_row;
        // Each column is freed as soon as it is aligned: a large file is in memory once.
        for (channel, column) in table.channels.into_iter().zip(table.columns) {
            let is_first = names.insert(channel.name.clone());
            if known.contains(channel.name.as_str()) {
                if !is_first {
                    return Err(Failure::usage(Asked::ComesTwice(channel.name)));
                }
                imported.channels.push(channel);
                imported.columns.push(held.column(&column));
            } else if is_first {
                unknown.push(channel.name);
            }
        }
    }
    if first >= end {
        return Err(no_time_in_common(span_us, later_us, (begins_us, ends_us)));
    }
    for column in &mut trace.columns {
        column[..first].fill(f64::NAN);
        column[end..].fill(f64::NAN);
    }
    let at_s = |row: usize| row_us(row) as f64 / 1e6;
    Ok(Aligned {
        trace,
        imported,
        unknown,
        rows: first..end,
        window_s: (at_s(first), at_s(end - 1)),
        is_row_by_row,
        laid_at_begin,
    })
}

/// For each row of a trace, the row of the file's table whose samples count there.
struct RowAlignment {
    places: Vec<Option<usize>>,
    /// Rows of the trace from the first to the last with a row of the table.
    rows: Range<usize>,
    is_row_by_row: bool,
}

impl RowAlignment {
    fn new(times: &[i64], later_us: i64, rows: usize, row_us: impl Fn(usize) -> i64) -> Self {
        let at = |place: usize| times[place].saturating_add(later_us);
        // The last sample stands as long as the one before did.
        let last_for_us = match *times {
            [.., before, last] => last.saturating_sub(before),
            _ => 0,
        };
        let mut places = Vec::with_capacity(rows);
        let mut is_row_by_row = true;
        let mut next = 0;
        for row in 0..rows {
            let now_us = row_us(row).saturating_add(ROUNDING_US);
            while next < times.len() && at(next) <= now_us {
                next += 1;
            }
            let last = next.checked_sub(1);
            let is_over = next == times.len()
                && last.is_some_and(|last| {
                    at(last).saturating_add(last_for_us) <= now_us
                        && at(last) < row_us(row) - ROUNDING_US
                });
            let place = last.filter(|_| !is_over);
            if let Some(place) = place {
                is_row_by_row &= (at(place) - row_us(row)).abs() <= ROUNDING_US;
            }
            places.push(place);
        }
        let first = places.iter().position(Option::is_some).unwrap_or(rows);
        let end = places
            .iter()
            .rposition(Option::is_some)
            .map_or(0, |last| last + 1);
        // Nor do more rows have a sample than there are samples.
        is_row_by_row &= end.saturating_sub(first) <= times.len();
        Self {
            places,
            rows: first..end,
            is_row_by_row,
        }
    }

    fn column(&self, samples: &[f64]) -> Vec<f64> {
        let held = |place: &Option<usize>| place.map_or(f64::NAN, |place| samples[place]);
        self.places.iter().map(held).collect()
    }
}

/// First and last time in the file.
fn span_us(import: &Import) -> (i64, i64) {
    let times = || import.tables.iter().flat_map(|table| table.times_us.iter());
    let (first, last) = (times().min(), times().max());
    (first.copied().unwrap_or(0), last.copied().unwrap_or(0))
}

fn no_time_in_common(file_us: (i64, i64), later_us: i64, trace_us: (i64, i64)) -> Failure {
    let s = |time_us: i64| format!("{:.3}", time_us as f64 / 1e6);
    let at_s = |time_us: i64| s(time_us.saturating_add(later_us));
    Failure::usage(Asked::FileOutsideTrace(
        at_s(file_us.0),
        at_s(file_us.1),
        s(trace_us.0),
        s(trace_us.1),
    ))
}

#[cfg(test)]
mod tests {
    use super::super::series::{Table, plain};
    use super::*;

    fn trace(samples: &[f64]) -> TraceData {
        TraceData {
            t0_us: 1_000_000,
            period_us: 50_000,
            trigger_row: Some(2),
            channels: vec![plain("a")],
            columns: vec![samples.to_vec()],
            ..TraceData::default()
        }
    }

    fn file(times_us: &[i64], samples: &[f64], is_utc: bool) -> Import {
        Import {
            tables: vec![Table {
                times_us: times_us.to_vec(),
                channels: vec![plain("a")],
                columns: vec![samples.to_vec()],
            }],
            is_utc,
            about: None,
        }
    }

    /// Unknown samples as -1, to be compared.
    fn aligned(import: &Import, shift_us: i64) -> (Vec<f64>, Vec<f64>) {
        let aligned = align(import.clone(), trace(&[1.0; 6]), shift_us).expect("aligned");
        let told = |columns: &[Vec<f64>]| -> Vec<f64> {
            columns[0]
                .iter()
                .map(|s| if s.is_nan() { -1.0 } else { *s })
                .collect()
        };
        (
            told(&aligned.trace.columns),
            told(&aligned.imported.columns),
        )
    }

    /// Rows are at -100, -50, 0, 50, 100 and 150 ms.
    #[test]
    fn a_row_has_the_last_sample_before_it() {
        let slow = file(&[-50_000, 50_000], &[3.0, 4.0], false);
        let (ours, theirs) = aligned(&slow, 0);
        assert_eq!(theirs, [-1.0, 3.0, 3.0, 4.0, 4.0, -1.0]);
        assert_eq!(ours, [-1.0, 1.0, 1.0, 1.0, 1.0, -1.0]);
        let fast = file(
            &[-10_000, 0, 1, 49_999, 60_000],
            &[1.0, 2.0, 3.0, 4.0, 5.0],
            false,
        );
        let (_, theirs) = aligned(&fast, 0);
        assert_eq!(theirs, [-1.0, -1.0, 3.0, 4.0, -1.0, -1.0]);
        let (_, theirs) = aligned(&slow, 50_000);
        assert_eq!(theirs, [-1.0, -1.0, 3.0, 3.0, 4.0, 4.0]);
    }

    #[test]
    fn times_of_day_are_aligned_with_those_of_the_trace() {
        let rows: Vec<i64> = (0..6).map(|row| 1_000_000 + row * 50_000).collect();
        let import = file(&rows, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], true);
        let aligned = align(import.clone(), trace(&[1.0; 6]), 0).expect("aligned");
        assert_eq!(aligned.imported.columns, import.tables[0].columns);
        assert!(aligned.is_row_by_row);
        assert_eq!(aligned.window_s, (-0.1, 0.15));
    }

    #[test]
    fn files_without_common_time_are_reported_with_both_spans() {
        let import = file(&[9_000_000, 9_050_000], &[1.0, 2.0], false);
        let told = align(import, trace(&[1.0; 6]), 0)
            .expect_err("apart")
            .to_string();
        for word in ["9.000 to 9.050 s", "-0.100 to 0.150 s", "--shift"] {
            assert!(told.contains(word), "{told}");
        }
    }
}
