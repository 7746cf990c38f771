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
    scene.camera.show(-0.5, 0.5);
    let rows = scene.rows_in_view();
    assert!(scene.set_axis(Kind::Distance));
    let again = scene.rows_in_view();
    assert!(again.start <= rows.start && again.end >= rows.end);
    assert!(again.len() < 40, "{again:?}");
}

#[test]
fn axes_are_as_long_as_the_trace_needs_or_what_is_in_view() {
    let mut scene = scene();
    scene.camera.show(-0.5, 0.5);
    let whole = scene.range(0);
    assert!(whole.0 < 0.0 && whole.1 > 99.0, "{whole:?}");
    scene.close = true;
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

/// Goal: curves that share an axis are of one unit. Method: two speeds, a way and a signal that is not there, each to be
/// drawn with the one above it; the wish stays in the list.
#[test]
fn only_quantities_of_one_unit_share_a_lane() {
    let column = [0.0, 1.0, 2.0];
    let mut data = trace(&[("speed", &column), ("limit", &column), ("way", &column)]);
    for (place, unit) in [(0, "km/h"), (1, "km/h"), (2, "m")] {
        data.channels[place].unit = unit.into();
    }
    let opened = OpenTrace {
        id: Id::from_bytes([1; 16]),
        run: None,
        view: TraceView::new(data),
        events: Vec::new(),
    };
    let signals = ["+speed", "+limit", "+way", "+nothing"].map(str::to_owned);
    let scene = TracePlot::new(Arc::new(opened), &signals);
    assert_eq!(scene.groups(), [0..2, 2..3, 3..4]);
    assert_eq!(scene.signals(), signals);
    assert_eq!(scene.lanes[1].signal, "limit");
}

#[test]
fn a_zoom_to_a_stretch_is_undone_step_by_step() {
    let mut scene = scene();
    let whole = scene.window();
    scene.zoom_to(1.0, -1.0);
    let first = scene.window();
    assert!((first.from + 1.0).abs() < 1e-9 && (first.to - 1.0).abs() < 1e-9);
    scene.zoom_to(0.0, 0.5);
    assert!(scene.zoom_back());
    assert_eq!(scene.window(), first);
    assert!(scene.zoom_back());
    assert_eq!(scene.window(), whole);
    assert!(!scene.zoom_back() && !scene.can_zoom_back());
}
