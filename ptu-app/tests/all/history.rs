//! The history: what runs and faults left behind is listed, shown, counted, kept and carried along.

use std::sync::OnceLock;

use crate::common::{Place, has_shape, list, number, record_bad_unit, text};

/// A good and a bad unit tested one after the other, for tests that only look.
fn history() -> &'static Place {
    static HISTORY: OnceLock<Place> = OnceLock::new();
    HISTORY.get_or_init(|| {
        let place = Place::new();
        place.ptu("run --serial-no GOOD-1").exits(0);
        record_bad_unit(&place);
        place
    })
}

/// Goal: the drift of a measurement from unit to unit shows: the slow relay adds its 400 ms.
#[test]
fn a_measurement_is_shown_over_time() {
    let place = history();
    let mean = |unit: &str| {
        let trend = place.json(&format!(
            "faults trend eb_reaction --serial-no {unit} --json"
        ));
        let overspeed: Vec<_> = list(&trend["points"])
            .iter()
            .filter(|p| (450.0..600.0).contains(&number(&p["high"])))
            .collect();
        for point in &overspeed {
            has_shape(
                point,
                &[
                    ("at", "text"),
                    ("run_id", "text"),
                    ("unit_serial", "text"),
                    ("value", "number"),
                    ("unit", "text"),
                    ("verdict", "text"),
                ],
            );
        }
        let sum: f64 = overspeed.iter().map(|point| number(&point["value"])).sum();
        sum / overspeed.len() as f64
    };
    let slower = mean("BAD-1") - mean("GOOD-1");
    assert!((350.0..=450.0).contains(&slower), "{slower} ms slower");
    place.ptu("faults trend eb_reaction").exits(0);
}

#[test]
fn a_trace_is_shown_and_exported() {
    let place = history();
    let trace = place.json("trace show latest --json");
    let two = place.json("trace show latest --signal speed,eb --json");
    let names: Vec<_> = list(&two["signals"])
        .iter()
        .map(|c| text(&c["name"]))
        .collect();
    assert_eq!(names, ["speed", "eb"]);
    let plot = place.ptu("trace show latest").exits(0).out;
    assert!(
        plot.contains("before the trigger") && plot.contains('▼'),
        "{plot}"
    );

    place.ptu("trace export latest --out trace.csv").exits(0);
    let csv = place.read("trace.csv");
    let mut lines = csv.lines();
    let headings: Vec<_> = lines.next().expect("headings").split(',').collect();
    assert_eq!(headings[0], "\u{feff}time_s");
    assert_eq!(headings.len(), list(&trace["signals"]).len() + 1);
    assert!(headings.contains(&"limit_kmh"), "{headings:?}");
    let times: Vec<f64> = lines
        .map(|line| {
            line.split(',')
                .next()
                .and_then(|t| t.parse().ok())
                .expect("a time")
        })
        .collect();
    assert_eq!(times.len() as f64, number(&trace["rows"]));
    assert_eq!(times[number(&trace["trigger_row"]) as usize], 0.0);
    place
        .ptu("trace show latest --signal speeed")
        .exits(2)
        .explains(&["speeed"]);
}
