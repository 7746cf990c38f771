//! Choices and bits per stretch of pixels: one value long enough to be seen, or many changes in between.

/// Shortest stretch that is shown as a value, pixels.
const SHORTEST: f64 = 1.5;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpanKind {
    Value(f64),
    /// Values that change faster than can be seen.
    Busy,
}

/// A stretch of pixels; between stretches nothing is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Left edge, pixels from the left edge of the window.
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
