//! A recorded run beside the run of a sound unit, as text and as JSON.

use serde_json::{Value, json};

use ptu_runs::record::{Compared, Parting};

pub fn json(compared: &Compared) -> Value {
    let comparison = &compared.comparison;
    let parting = |parting: &Parting| {
        json!({
            "signal": parting.signal, "against": parting.against, "at_s": parting.at_s, "at_m": parting.at_m,
            "came_kmh": parting.came_kmh, "expected_kmh": parting.expected_kmh, "most_kmh": parting.most_kmh,
        })
    };
    json!({
        "trace_id": compared.trace.to_string(),
        "unit_serial": compared.unit_serial,
        "line": compared.line,
        "unit_config": compared.unit_config,
        "section": comparison.section,
        "as_expected": comparison.is_as_expected(),
        "partings": comparison.partings.iter().map(parting).collect::<Vec<_>>(),
        "stop_error_m": comparison.stop.error_m,
        "twin_stop_error_m": comparison.stop.twin_error_m,
        "aligned_m": comparison.stop.aligned_m,
        "misaligned": comparison.is_misaligned(),
        "brake_m": comparison.brake_m,
        "twin_brake_m": comparison.twin_brake_m,
        "late_brake_m": comparison.late_m(),
        "run_time_s": comparison.run_time_s,
        "twin_run_time_s": comparison.twin_run_time_s,
        "markers_missed": comparison.markers_missed,
        "notes": comparison.notes,
    })
}

/// The comparison for a person.
pub fn text(compared: &Compared) -> String {
    let comparison = &compared.comparison;
    let beside = |what: &str, came: Option<f64>, twin: Option<f64>, unit: &str| {
        let shown = |value: Option<f64>| {
            value.map_or_else(
                || "not recorded".to_owned(),
                |value| format!("{value:.2} {unit}"),
            )
        };
        format!("{what}: {}; the sound unit's {}", shown(came), shown(twin))
    };
    let mut lines = vec![format!(
        "trace {} of unit {}, line {} section {}",
        compared.trace.short(),
        compared.unit_serial,
        compared.line,
        comparison.section
    )];
    if comparison.partings.is_empty() {
        lines.push("speed and target do not part from what was expected".to_owned());
    }
    lines.extend(comparison.partings.iter().map(Parting::to_string));
    let stop = comparison.stop;
    lines.push(beside("stop error", stop.error_m, stop.twin_error_m, "m"));
    if comparison.is_misaligned() {
        lines.push(format!(
            "the train stopped beyond ±{:.2} m, where doors may be opened",
            stop.aligned_m
        ));
    }
    lines.push(beside(
        "brake for the stop at",
        comparison.brake_m,
        comparison.twin_brake_m,
        "m",
    ));
    if let Some(late_m) = comparison.late_m() {
        lines.push(format!(
            "the brake began {late_m:.1} m later than the sound unit's"
        ));
    }
    let (came, twin) = (comparison.run_time_s, comparison.twin_run_time_s);
    lines.push(beside("departure to rest", came, twin, "s"));
    if !comparison.markers_missed.is_empty() {
        let missed: Vec<_> = comparison
            .markers_missed
            .iter()
            .map(|m| format!("PSM{m}"))
            .collect();
        lines.push(format!("markers not detected: {}", missed.join(", ")));
    }
    lines.extend(comparison.notes.iter().map(|note| format!("note: {note}")));
    lines.join("\n")
}
