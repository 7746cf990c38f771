//! Choices and bits as runs of equal samples.

use std::collections::BTreeMap;
use std::ops::Range;

use super::Window;
use super::axis::{Axis, Edges};
use super::spans::{self, Span};

/// Runs of equal samples, in order; samples that are not known are runs of NaN.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Runs {
    /// First row and value of each run.
    runs: Vec<(u32, f64)>,
    rows: usize,
}

impl Runs {
    /// Runs of equal values in a column of samples.
    pub fn of(samples: &[f64]) -> Self {
        let mut runs: Vec<(u32, f64)> = Vec::new();
        for (row, value) in samples.iter().enumerate() {
            let same = |before: f64| before == *value || (before.is_nan() && value.is_nan());
            if runs.last().is_none_or(|(_, before)| !same(*before)) {
                runs.push((row as u32, *value));
            }
        }
        runs.shrink_to_fit();
        Self {
            runs,
            rows: samples.len(),
        }
    }

    /// First row of a run; after the last run, the end of the rows.
    fn start(&self, run: usize) -> usize {
        self.runs
            .get(run)
            .map_or(self.rows, |(row, _)| *row as usize)
    }

    /// The run a row belongs to.
    fn run_at(&self, row: usize) -> usize {
        let after = self
            .runs
            .partition_point(|(first, _)| *first as usize <= row);
        after.saturating_sub(1)
    }

    /// Changes from one known value to another after the first of these rows.
    pub fn changes(&self, rows: Range<usize>) -> usize {
        let first = self.run_at(rows.start);
        let known = |run: &(u32, f64)| !run.1.is_nan();
        let last = self.run_at(rows.end.saturating_sub(1));
        let within = self.runs.get(first..=last).unwrap_or_default();
        let known: Vec<_> = within.iter().filter(|run| known(run)).collect();
        known.windows(2).filter(|two| two[0].1 != two[1].1).count()
    }

    /// Number of these rows for each known value, by value.
    pub fn shares(&self, rows: Range<usize>) -> Vec<(f64, usize)> {
        let mut shares: BTreeMap<i64, usize> = BTreeMap::new();
        let mut run = self.run_at(rows.start);
        while let Some((first, value)) = self.runs.get(run) {
            let from = (*first as usize).max(rows.start);
            let to = self.start(run + 1).min(rows.end);
            if from >= rows.end {
                break;
            }
            if !value.is_nan() {
                *shares.entry(*value as i64).or_default() += to.saturating_sub(from);
            }
            run += 1;
        }
        let share = |(value, rows): (i64, usize)| (value as f64, rows);
        shares.into_iter().map(share).collect()
    }

    /// Stretches of one value along the columns of pixels between `edges`; changes within one pixel are skipped, however many
    /// there are.
    pub fn spans(&self, axis: &Axis, window: Window, edges: &Edges, spans: &mut Vec<Span>) {
        spans.clear();
        let pixels = edges.rows.len().saturating_sub(1);
        let end = axis.whole().to;
        let pixel = |row: usize| {
            let place = if row >= self.rows { end } else { axis.at(row) };
            (window.share(place) * pixels as f64).clamp(0.0, pixels as f64)
        };
        let Some(first) = edges.rows.first() else {
            return;
        };
        let mut run = self.run_at(first.saturating_sub(1));
        while let Some((row, value)) = self.runs.get(run) {
            let (from, to) = (pixel(*row as usize), pixel(self.start(run + 1)));
            if from >= pixels as f64 {
                break;
            }
            if to > from {
                spans::add(spans, (from, to), *value);
            }
            run += 1;
            let column = to as usize + 1;
            if to - from < 1.0
                && let Some(next) = edges.rows.get(column)
            {
                let next = self.run_at(next.saturating_sub(1));
                if next > run {
                    spans::add_busy(spans, (to, pixel(self.start(next))));
                    run = next;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::spans::SpanKind;
    use super::super::tests::trace;
    use super::*;

    const SAMPLES: [f64; 10] = [0.0, 0.0, 1.0, 1.0, 1.0, f64::NAN, 1.0, 0.0, 0.0, 0.0];

    #[test]
    fn changes_and_shares_are_those_of_the_rows_asked_for() {
        let runs = Runs::of(&SAMPLES);
        assert_eq!(runs.changes(0..10), 2);
        assert_eq!(runs.changes(2..7), 0);
        assert_eq!(runs.shares(0..10), [(0.0, 5), (1.0, 4)]);
        assert_eq!(runs.shares(1..3), [(0.0, 1), (1.0, 1)]);
        assert_eq!(Runs::of(&[]).shares(0..0), []);
        assert_eq!(Runs::of(&[]).changes(0..0), 0);
    }

    fn spans(samples: &[f64], window: Window) -> Vec<(f32, f32, SpanKind)> {
        let axis = Axis::time(&trace(&[("eb", samples)]), 0);
        let mut edges = Edges::default();
        axis.edges(window, 100, &mut edges);
        let mut spans = Vec::new();
        Runs::of(samples).spans(&axis, window, &edges, &mut spans);
        let rounded = |s: &Span| (s.from.round(), s.to.round(), s.shown);
        spans.iter().map(rounded).collect()
    }

    #[test]
    fn a_state_is_one_interval_while_it_holds_and_unknown_is_none() {
        let found = spans(&SAMPLES, Window { from: 0.0, to: 0.5 });
        let expected = [
            (0.0, 20.0, SpanKind::Value(0.0)),
            (20.0, 50.0, SpanKind::Value(1.0)),
            (60.0, 70.0, SpanKind::Value(1.0)),
            (70.0, 100.0, SpanKind::Value(0.0)),
        ];
        assert_eq!(found, expected);
        let part = spans(&SAMPLES, Window { from: 0.3, to: 0.4 });
        assert_eq!(part[0], (0.0, 50.0, SpanKind::Value(1.0)));
        assert_eq!(part[1], (50.0, 100.0, SpanKind::Value(0.0)));
    }

    #[test]
    fn many_changes_are_merged_and_later_intervals_stay_correct() {
        let mut samples: Vec<f64> = (0..60_000).map(|i| f64::from(i % 2)).collect();
        samples.extend([1.0; 40_000]);
        let found = spans(
            &samples,
            Window {
                from: 0.0,
                to: 5000.0,
            },
        );
        assert_eq!(found.len(), 2, "{found:?}");
        assert_eq!(found[0].2, SpanKind::Busy);
        assert!((found[0].1 - 60.0).abs() <= 1.0, "{found:?}");
        assert_eq!(found[1].2, SpanKind::Value(1.0));
        assert!((found[1].0 - 60.0).abs() <= 1.0 && found[1].1 == 100.0);
    }
}
