//! Runs as JSON: one object for one run, `{"runs": [...]}` where several were asked for; with Monte
//! Carlo one object for one case, `{"cases": [...]}` where several were.

use btu_rig::conditions::{Conditions, Disturbance};
use btu_rig::drive::{Figure, Landmark, Metrics};
use protocol::line::Section;
use serde_json::{Value, json};

use super::{Outcomes, Results};
use ptu_runs::drive::monte_carlo::{MonteCarlo, Trial, percentile};
use ptu_runs::drive::{Case, DriveBench, Driven};

/// Percentiles and their keys.
const PERCENTILES: [(&str, f64); 7] = [
    ("p0_1", 0.1),
    ("p2_5", 2.5),
    ("p50", 50.0),
    ("p97_5", 97.5),
    ("p99_9", 99.9),
    ("max", 100.0),
    ("min", 0.0),
];

pub fn json(results: &Results) -> Value {
    match &results.outcomes {
        Outcomes::Single(runs) => match runs.as_slice() {
            [run] if !results.list => run_json(run),
            runs => json!({"runs": runs.iter().map(run_json).collect::<Vec<_>>()}),
        },
        Outcomes::Many(many) => match many.as_slice() {
            [one] if !results.list => many_json(one),
            many => json!({"cases": many.iter().map(many_json).collect::<Vec<_>>()}),
        },
    }
}

/// One object with the keys of all objects in `parts`, in order.
fn object(parts: impl IntoIterator<Item = Value>) -> Value {
    let maps = parts.into_iter().filter_map(|part| match part {
        Value::Object(map) => Some(map),
        _ => None,
    });
    Value::Object(maps.flatten().collect())
}

fn run_json(run: &Driven) -> Value {
    let (case, outcome) = (&run.case, &run.outcome);
    object([
        case_json(case),
        json!({
            "ending": outcome.ending.to_string(),
            "aligned": run.aligned(),
            "stop_error_m": outcome.stop_error_m,
        }),
        figures_json(outcome.metrics.as_ref()),
        day_json(case.plan.load_kg, &case.plan.conditions, case.seed),
        events_json(&outcome.landmarks),
    ])
}

fn figures_json(of: Option<&Metrics>) -> Value {
    let value = |figure: &Figure| (figure.key.to_owned(), of.map(figure.of).into());
    Value::Object(Metrics::ALL.iter().map(value).collect())
}

fn events_json(landmarks: &[Landmark]) -> Value {
    let event =
        |mark: &Landmark| json!({"t_s": mark.t_s, "x_m": mark.x_m, "what": mark.what.to_string()});
    json!({"events": landmarks.iter().map(event).collect::<Vec<_>>()})
}

/// JSON of a case, without drawn values.
fn case_json(case: &Case) -> Value {
    object([
        place_json(&case.bench, &case.plan.section),
        json!({"controller": case.controller.name()}),
        bench_json(&case.bench, case.plan.train.name()),
    ])
}

fn place_json(bench: &DriveBench, section: &Section) -> Value {
    json!({"line": bench.line.content.name, "section": section.section})
}

fn bench_json(bench: &DriveBench, train: &str) -> Value {
    let settings: Vec<_> = bench.settings.iter().map(ToString::to_string).collect();
    json!({"train": train, "unit_config": bench.config.content.name, "settings": settings})
}

/// Load, train and day.
fn day_json(load_kg: f64, conditions: &Conditions, seed: u64) -> Value {
    json!({"load_kg": load_kg, "conditions": conditions_json(conditions), "seed": seed})
}

/// Train and day.
fn conditions_json(conditions: &Conditions) -> Value {
    let disturbance = match conditions.disturbance {
        Disturbance::None => Value::Null,
        Disturbance::Sine {
            amplitude_n_s_per_m,
            hz,
        } => {
            json!({"amplitude_n_s_per_m": amplitude_n_s_per_m, "frequency_hz": hz})
        }
    };
    json!({
        "gradient_offset_permille": conditions.gradient_offset_permille,
        "adhesion": conditions.adhesion,
        "delay_factor": conditions.delay_factor,
        "brake_factor": conditions.brake_factor,
        "wheel_factor": conditions.wheel_factor,
        "marker_offsets_m": conditions.marker_offsets_m,
        "disturbance": disturbance,
    })
}

fn many_json(many: &MonteCarlo) -> Value {
    let figure = |figure: &Figure| {
        let spread = percentiles(&many.figures(figure.of));
        (figure.key.to_owned(), spread)
    };
    object([
        json!({"runs": many.trials.len(), "asked": many.asked}),
        case_json(&many.case),
        json!({
            "stop_error_m": percentiles(&many.stop_errors_m()),
            "within_10cm": many.within(0.1),
            "within_30cm": many.within(0.3),
            "past_1m": many.past_1m(),
            "passed": many.passed(),
            "failures": many.failures().map(trial_json).collect::<Vec<_>>(),
        }),
        Value::Object(Metrics::ALL.iter().map(figure).collect()),
        json!({"worst": many.worst().into_iter().map(trial_json).collect::<Vec<_>>()}),
    ])
}

fn trial_json(trial: &Trial) -> Value {
    json!({
        "seed": trial.seed,
        "ending": trial.ending.to_string(),
        "stop_error_m": trial.stop_error_m,
        "run_time_s": trial.metrics.map(|metrics| metrics.run_time_s),
        "load_kg": trial.drawn.load_kg,
        "conditions": conditions_json(&trial.drawn.conditions),
    })
}

fn percentiles(sorted: &[f64]) -> Value {
    let value = |(key, percent): (&str, f64)| (key.to_owned(), percentile(sorted, percent).into());
    Value::Object(PERCENTILES.map(value).into_iter().collect())
}
