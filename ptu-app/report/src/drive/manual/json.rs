//! A run by hand as one JSON object.

use serde_json::{Map, Value, json};

use super::figures::FIGURES;
use super::steps::{StepResult, step_results};
use ptu_bench::drive::manual::ManualRun;

/// All of it.
pub fn json(run: &ManualRun) -> Value {
    let (case, outcome) = (&run.case, &run.outcome);
    let plan = &case.plan;
    let settings: Vec<_> = case
        .bench
        .settings
        .iter()
        .map(ToString::to_string)
        .collect();
    let mut object = Map::new();
    let mut put = |key: &str, value: Value| object.insert(key.to_owned(), value);
    put("sequence", case.name.as_str().into());
    put("title", plan.sequence.title.as_str().into());
    put("line", case.bench.line.content.name.as_str().into());
    put("section", plan.section.section.into());
    put("train", plan.train.name.as_str().into());
    put(
        "unit_config",
        case.bench.config.content.name.as_str().into(),
    );
    put("settings", settings.into());
    put("code", plan.code.as_str().into());
    put("load_kg", plan.load_kg.into());
    put(
        "conditions",
        super::super::json::conditions_json(&plan.conditions),
    );
    put("seed", case.seed.into());
    put("ending", outcome.ending.to_string().into());
    put("passed", run.passed().into());
    for figure in &FIGURES {
        put(figure.key, (figure.of)(&outcome.figures).into());
    }
    put("steps", step_results(run).iter().map(step).collect());
    let event = |l: &btu_rig::drive::Landmark| json!({"t_s": l.t_s, "x_m": l.x_m, "what": l.what});
    put("events", outcome.landmarks.iter().map(event).collect());
    object.into()
}

fn step(result: &StepResult<'_>) -> Value {
    let pair = result.pair.map(|pair| {
        json!({
            "te_n": pair.traction_n,
            "electric_n": pair.electric_n,
            "air_t_n": pair.air_t_n,
            "air_m_n": pair.air_m_n,
            "brake_n": pair.brake_n(),
        })
    });
    json!({
        "t_s": result.done.t_s,
        "x_m": result.done.x_m,
        "speed_kmh": result.done.speed_kmh,
        "what": result.done.what(),
        "brake_settled_s": result.settled.map(|settled| settled.after_s),
        "brake_worst_share": result.settled.map(|settled| settled.worst),
        "pair1_later": pair,
    })
}
