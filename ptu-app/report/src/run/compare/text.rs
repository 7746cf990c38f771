//! Two runs beside each other as text and as data.

use fault_db::{MeasurementRecord, StepRecord};
use serde_json::{Value, json};

use super::table::{allowed, change, name_of, value};
use super::{Compared, Differs, RunComparison};
use crate::json::{run_summary_json, value_json};
use crate::words::{Language, Words};
use ptu_runs::table::Table;

pub fn comparison_text(of: &RunComparison, words: &Words) -> String {
    let report = &words.report;
    let mut text = String::new();
    for (name, run) in [(report.run_a, &of.a), (report.run_b, &of.b)] {
        text += &format!("{name}  {}\n", RunComparison::told(&run.run, words));
    }
    text += &format!("\n{}\n", of.headline(words));
    for warning in of.warnings(words) {
        text += &format!("⚠ {warning}\n");
    }
    let headings = [
        report.step_or_measurement,
        report.run_a,
        report.run_b,
        report.change,
        report.allowed,
    ];
    let headings = headings.map(str::to_uppercase);
    let mut table = Table::new(&headings.each_ref().map(String::as_str))
        .verdicts(1)
        .verdicts(2)
        .limits([4]);
    let mut is_empty = true;
    for pair in of.steps() {
        if !of.all && pair.passed_in_both() {
            continue;
        }
        is_empty = false;
        table.row(row(&pair.step, words));
        for one in &pair.measurements {
            table.row(row(one, words));
        }
    }
    if !is_empty {
        text += &format!("\n{}\n", table.render());
    }
    if let Some(rest) = of.rest(words) {
        text += &format!("\n{rest}\n");
    }
    text.trim_end().to_owned()
}

fn row(one: &Compared<'_>, words: &Words) -> [String; 5] {
    let dash = || "–".to_owned();
    let verdict = |step: Option<&StepRecord>| {
        step.map_or_else(dash, |step| {
            words.common.stored_verdict(step.verdict).into()
        })
    };
    let measured = |of: Option<&MeasurementRecord>| of.map_or_else(dash, |of| value(of, words));
    let (name, [a, b]) = match (one.measured(), one.step()) {
        (Some(of), _) => (
            format!("  {}", words.measurement(&of.name)),
            [one.before, one.after].map(measured),
        ),
        (None, step) => (
            step.map_or_else(String::new, |step| {
                format!("{}: {}", step.procedure, name_of(step, words))
            }),
            [one.step_before, one.step_after].map(verdict),
        ),
    };
    let change = change(one).unwrap_or_default();
    [name, a, b, change, allowed(one, words)]
}

/// The comparison as data, with every step.
pub fn comparison_json(of: &RunComparison) -> Value {
    let words = Language::English.words();
    let tally = of.tally();
    let differs = of.differs();
    let warnings = differs.iter().zip(of.warnings(words));
    let steps = of.steps().into_iter().map(|pair| {
        let one = pair.step;
        let [a, b] = [one.step_before, one.step_after].map(|step| Some(step?.verdict.as_str()));
        json!({
            "procedure": one.step().map(|step| &step.procedure),
            "name": one.step().map(|step| &step.name),
            "verdict_a": a, "verdict_b": b,
            "measurements": pair.measurements.iter().map(measurement).collect::<Vec<_>>(),
        })
    });
    json!({
        "run_a": run_summary_json(&of.a.run), "run_b": run_summary_json(&of.b.run),
        "headline": of.headline(words),
        "pass_now": tally.pass_now, "passed_before": tally.passed_before,
        "pass_in_neither": tally.in_neither, "only_a": tally.only_a, "only_b": tally.only_b,
        "differs": warnings.map(|(differs, said)| json!({ "what": what(differs), "said": said }))
            .collect::<Vec<_>>(),
        "steps": steps.collect::<Vec<_>>(),
    })
}

fn measurement(one: &Compared<'_>) -> Value {
    json!({
        "name": one.measured().map(|of| &of.name), "unit": one.measured().map(|of| &of.unit),
        "a": one.before.map(value_json), "b": one.after.map(value_json), "change": one.change(),
    })
}

fn what(differs: &Differs) -> &'static str {
    match differs {
        Differs::Unit(..) => "unit",
        Differs::Configuration(..) => "unit_config",
        Differs::Line(..) => "line",
        Differs::Scripts(_) => "scripts",
        Differs::Unfinished(_) => "unfinished",
        Differs::Order => "order",
    }
}
