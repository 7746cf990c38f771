//! Choices and bits per stretch of pixels: one value long enough to be seen, or many changes in between.

use super::Window;

/// Shortest stretch that is shown as a value, pixels.
const SHORTEST: f64 = 1.5;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpanKind {
    Value(f64),
    /// Values that change faster than can be seen.
    Busy,
}

/// A stretch of pixels; where none is, nothing is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Left edge, pixels from the window's.
    pub from: f32,
    /// Right edge.
    pub to: f32,
    pub shown: SpanKind,
}

/// Adds a stretch of one value, in order from the left; edges in pixels.
pub fn add(spans: &mut Vec<Span>, (from, to): (f64, f64), value: f64) {
    if value.is_nan() {
        return;
    }
    let (left, right) = (from as f32, to as f32);
    let last = spans.last_mut().filter(|last| left - last.to < 1.0);
    if to - from >= SHORTEST {
        if let Some(last) = last
            && last.shown == SpanKind::Value(value)
        {
            last.to = right;
            return;
        }
        spans.push(Span {
            from: left,
            to: right,
            shown: SpanKind::Value(value),
        });
        return;
    }
    match last {
        Some(last) if last.shown == SpanKind::Value(value) => last.to = last.to.max(right),
        _ => add_busy(spans, (from, to)),
    }
}

/// Adds a stretch of values that change faster than can be seen; edges in pixels.
pub fn add_busy(spans: &mut Vec<Span>, (from, to): (f64, f64)) {
    let (left, right) = (from as f32, to as f32);
    match spans.last_mut() {
        Some(last) if last.shown == SpanKind::Busy && left - last.to < 1.0 => {
            last.to = last.to.max(right);
        }
        _ => spans.push(Span {
            from: left,
            to: right.max(left + 1.0),
            shown: SpanKind::Busy,
        }),
    }
}

/// Stretches of samples in order of time, each of which holds until the next: for plots of a few thousand
/// rows that move. `spans` is filled again.
pub fn of_samples(
    samples: impl Iterator<Item = (f64, f64)>,
    window: Window,
    pixels: usize,
    spans: &mut Vec<Span>,
) {
    spans.clear();
    let pixel = |x: f64| (window.share(x) * pixels as f64).clamp(0.0, pixels as f64);
    let mut run: Option<(f64, f64)> = None;
    let mut last = f64::NAN;
    let mut end = |(from, value): (f64, f64), to: f64| {
        let (from, to) = (pixel(from), pixel(to));
        if to > from {
            add(spans, (from, to), value);
        }
    };
    for (x, value) in samples {
        last = x;
        match run {
            Some((_, held)) if held == value => {}
            Some(before) => {
                end(before, x);
                run = Some((x, value));
            }
            None => run = Some((x, value)),
        }
    }
    if let Some(before) = run {
        end(before, last);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: Window = Window {
        from: 0.0,
        to: 10.0,
    };

    fn shown(samples: &[(f64, f64)]) -> Vec<(f32, f32, SpanKind)> {
        let mut spans = Vec::new();
        of_samples(samples.iter().copied(), WINDOW, 100, &mut spans);
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
