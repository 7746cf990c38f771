//! Cursors, axes and statistics of a plot.

use fault_db::Id;

use super::super::tests::trace;
use super::*;

fn scene() -> TracePlot {
    let ramp: Vec<f64> = (0..100).map(f64::from).collect();
    let way: Vec<f64> = (0..100).map(|row| f64::from(row) * 0.5).collect();
    let mut data = trace(&[("speed", &ramp), ("train_position", &way)]);
    data.trigger_row = Some(40);
    let opened = OpenTrace {
        id: Id::from_bytes([1; 16]),
        run: None,
        view: TraceView::new(data),
        events: Vec::new(),
    };
    let signals = ["speed", "nothing"].map(str::to_owned);
    TracePlot::new(Arc::new(opened), &signals)
}

#[test]
fn cursors_take_the_row_before_and_keep_it_over_distance() {
    let mut scene = scene();
    scene.put(Cursor::A, -0.51);
    scene.put(Cursor::B, 0.5);
    assert_eq!(scene.cursor(Cursor::A), Some(29));
    assert_eq!(scene.value(0, Cursor::A), Some(29.0));
    assert_eq!(scene.difference(0), Some(21.0));
    assert!(scene.set_axis(Kind::Distance));
    assert_eq!(scene.cursor(Cursor::B), Some(50));
    scene.step(Cursor::B, 1000);
    assert_eq!(scene.cursor(Cursor::B), Some(99));
    scene.clear_cursors();
    assert_eq!(scene.difference(0), None);
}

#[test]
fn the_same_rows_stay_in_view_over_distance() {
    let mut scene = scene();
    scene.camera().show(-0.5, 0.5);
    let rows = scene.rows_in_view();
    assert!(scene.set_axis(Kind::Distance));
    let again = scene.rows_in_view();
    assert!(again.start <= rows.start && again.end >= rows.end);
    assert!(again.len() < 40, "{again:?}");
}

#[test]
fn axes_are_as_long_as_the_trace_needs_or_what_is_in_view() {
    let mut scene = scene();
    scene.camera().show(-0.5, 0.5);
    let whole = scene.range(0);
    assert!(whole.0 < 0.0 && whole.1 > 99.0, "{whole:?}");
    *scene.close() = true;
    let close = scene.range(0);
    assert!(close.0 > 20.0 && close.1 < 60.0, "{close:?}");
}

#[test]
fn statistics_follow_cursors_or_view_and_a_missing_signal_has_none() {
    let mut scene = scene();
    assert_eq!(scene.stretch_rows(), (0..100, false));
    scene.put(Cursor::B, 0.0);
    scene.put(Cursor::A, 0.1);
    assert_eq!(scene.stretch_rows(), (40..43, true));
    let said = scene.statistics();
    assert!(matches!(
        said[0],
        Some(Statistics::Quantity {
            low: 40.0,
            high: 42.0,
            mean: 41.0,
            ..
        })
    ));
    assert_eq!(said[1], None);
}
