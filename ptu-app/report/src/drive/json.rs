//! Runs as JSON: one object for one run, `{"runs": [...]}` where several were asked for; with Monte
//! Carlo one object for one case, `{"cases": [...]}` where several were.

use btu_rig::conditions::{Conditions, Disturbance};
use serde_json::{Map, Value, json};

use super::figures::FIGURES;
use super::{Outcomes, Results};
use ptu_bench::drive::monte_carlo::{MonteCarlo, Trial, percentile};
use ptu_bench::drive::{Case, Driven};

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

/// All of it.
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

fn run_json(run: &Driven) -> Value {
    let outcome = &run.outcome;
    let mut object = case_json(&run.case);
    object.insert("ending".into(), outcome.ending.to_string().into());
    object.insert("aligned".into(), run.aligned().into());
    object.insert("stop_error_m".into(), outcome.stop_error_m.into());
    for figure in &FIGURES {
        object.insert(
            figure.key.into(),
            outcome.metrics.as_ref().map(figure.of).into(),
        );
    }
    object.insert("load_kg".into(), run.case.plan.load_kg.into());
    object.insert(
        "conditions".into(),
        conditions_json(&run.case.plan.conditions),
    );
    object.insert("seed".into(), run.case.seed.into());
    let event = |l: &btu_rig::drive::Landmark| json!({"t_s": l.t_s, "x_m": l.x_m, "what": l.what});
    let events: Vec<_> = outcome.landmarks.iter().map(event).collect();
    object.insert("events".into(), events.into());
    object.into()
}

/// What a case is, whatever is drawn.
fn case_json(case: &Case) -> Map<String, Value> {
    let bench = &case.bench;
    let settings: Vec<_> = bench
        .settings
        .iter()
        .map(|s| Value::from(s.to_string()))
        .collect();
    [
        ("line", Value::from(bench.line.content.name.as_str())),
        ("section", case.plan.section.section.into()),
        ("controller", case.controller.name().into()),
        ("train", case.plan.train.name().into()),
        ("unit_config", bench.config.content.name.as_str().into()),
        ("settings", settings.into()),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into_iter()
    .collect()
}

/// Train and day.
pub fn conditions_json(conditions: &Conditions) -> Value {
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
    let mut object = Map::new();
    object.insert("runs".into(), many.trials.len().into());
    object.insert("asked".into(), many.asked.into());
    object.extend(case_json(&many.case));
    object.insert("stop_error_m".into(), percentiles(&many.stop_errors_m()));
    object.insert("within_10cm".into(), many.within(0.1).into());
    object.insert("within_30cm".into(), many.within(0.3).into());
    object.insert("past_1m".into(), many.past_1m().into());
    object.insert("passed".into(), many.passed().into());
    object.insert("failures".into(), many.failures().map(trial_json).collect());
    for figure in &FIGURES {
        object.insert(figure.key.into(), percentiles(&many.figures(figure.of)));
    }
    object.insert(
        "worst".into(),
        many.worst().into_iter().map(trial_json).collect(),
    );
    object.into()
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
