//! Samples in order of time, each of which holds until the next, as columns and stretches of pixels: for plots of a few
//! thousand rows that move.

use super::{Axis, Column, Edges, MinMaxIndex, Runs, Span, Window};

/// A quantity as one interval per column of pixels; `columns` is filled again.
pub fn columns(
    samples: impl Iterator<Item = (f64, f64)>,
    window: Window,
    pixels: usize,
    columns: &mut Vec<Column>,
) {
    let (_, edges, values) = along(samples, window, pixels);
    MinMaxIndex::of(&values).columns(&values, &edges, columns);
}

/// A choice or a bit as stretches of one value; `spans` is filled again.
pub fn spans(
    samples: impl Iterator<Item = (f64, f64)>,
    window: Window,
    pixels: usize,
    spans: &mut Vec<Span>,
) {
    let (axis, edges, values) = along(samples, window, pixels);
    Runs::of(&values).spans(&axis, window, &edges, spans);
}

/// The samples on an axis of their own times, which need not be equally far apart.
fn along(
    samples: impl Iterator<Item = (f64, f64)>,
    window: Window,
    pixels: usize,
) -> (Axis, Edges, Vec<f64>) {
    let (times, values) = samples.unzip();
    let axis = Axis::places(times);
    let mut edges = Edges::default();
    axis.edges(window, pixels, &mut edges);
    (axis, edges, values)
}

#[cfg(test)]
mod tests {
    use super::super::SpanKind;
    use super::*;

    fn lows_and_highs(samples: &[(f64, f64)], window: Window) -> Vec<(f32, f32)> {
        let mut columns = Vec::new();
        super::columns(samples.iter().copied(), window, 4, &mut columns);
        columns.iter().map(|c| (c.low, c.high)).collect()
    }

    const WINDOW: Window = Window { from: 0.0, to: 4.0 };

    #[test]
    fn a_value_holds_until_the_next_and_a_short_peak_is_not_lost() {
        let samples = [(0.0, 1.0), (2.1, 9.0), (2.2, 2.0), (3.5, 2.0)];
        let found = lows_and_highs(&samples, WINDOW);
        assert_eq!(found, [(1.0, 1.0), (1.0, 1.0), (1.0, 9.0), (2.0, 2.0)]);
    }

    #[test]
    fn unknown_values_are_empty_cells() {
        let samples = [
            (0.0, 1.0),
            (1.0, f64::NAN),
            (2.0, f64::MAX),
            (3.0, 2.0),
            (9.0, 2.0),
        ];
        let found = lows_and_highs(&samples, WINDOW);
        assert!(found[2].0.is_nan() && found[2].1.is_nan());
        assert_eq!((found[0], found[3]), ((1.0, 1.0), (2.0, 2.0)));
    }

    #[test]
    fn samples_outside_and_none_at_all_are_no_trouble() {
        assert!(lows_and_highs(&[], WINDOW)[0].0.is_nan());
        let beside = [(-9.0, 1.0), (-3.0, 2.0)];
        assert!(lows_and_highs(&beside, WINDOW).iter().all(|c| c.0.is_nan()));
        let across = [(-9.0, 1.0), (9.0, 2.0)];
        assert_eq!(lows_and_highs(&across, WINDOW), [(1.0, 1.0); 4]);
    }

    fn shown(samples: &[(f64, f64)]) -> Vec<(f32, f32, SpanKind)> {
        let mut spans = Vec::new();
        let window = Window {
            from: 0.0,
            to: 10.0,
        };
        super::spans(samples.iter().copied(), window, 100, &mut spans);
        spans.iter().map(|s| (s.from, s.to, s.shown)).collect()
    }

    #[test]
    fn equal_samples_are_one_interval_and_unknown_ones_none() {
        let found = shown(&[
            (-1.0, 0.0),
            (2.0, 0.0),
            (4.0, 1.0),
            (6.0, f64::NAN),
            (8.0, 1.0),
            (12.0, 1.0),
        ]);
        let expected = [
            (0.0, 40.0, SpanKind::Value(0.0)),
            (40.0, 60.0, SpanKind::Value(1.0)),
            (80.0, 100.0, SpanKind::Value(1.0)),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn a_short_pulse_is_visible_and_many_are_one_busy_interval() {
        let pulse = shown(&[(0.0, 0.0), (5.0, 1.0), (5.05, 0.0), (10.0, 0.0)]);
        assert_eq!(pulse.len(), 3);
        assert_eq!(pulse[1], (50.0, 51.0, SpanKind::Busy));
        let busy: Vec<_> = (0..1000)
            .map(|i| (f64::from(i) / 100.0, f64::from(i % 2)))
            .collect();
        let found = shown(&busy);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].2, SpanKind::Busy);
        assert!(found[0].0 == 0.0 && found[0].1 > 99.0);
    }
}
