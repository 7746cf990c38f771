//! Runs as text for people.

use btu_rig::drive::Metrics;

use super::facts::{Fact, conditions, ending, off, title};
use super::{Outcomes, Results, tables};
use crate::words::Language;
use ptu_runs::drive::Driven;
use ptu_runs::drive::monte_carlo::MonteCarlo;
use ptu_runs::table::Table;

pub fn text(results: &Results) -> String {
    match &results.outcomes {
        Outcomes::Single(runs) => match runs.as_slice() {
            [] => "stopped before anything was driven".into(),
            [run] => one(run),
            runs => several(runs),
        },
        Outcomes::Many(many) => {
            let blocks: Vec<_> = many.iter().map(monte_carlo).collect();
            blocks.join("\n\n")
        }
    }
}

/// Name and ending, and what was run on.
fn heading(name: &str, ending: &str, facts: Vec<Fact>) -> String {
    let named = facts.into_iter();
    let named: Vec<_> = named
        .map(|(name, value)| format!("{}: {value}", name.to_lowercase()))
        .collect();
    format!("{name}: {ending}\n{}", named.join("; "))
}

fn one(run: &Driven) -> String {
    let mut blocks = vec![heading(
        &title(&run.case),
        &ending(run),
        conditions(&run.case),
    )];
    if run.outcome.metrics.is_some() {
        blocks.push(tables::of_runs(std::slice::from_ref(run)).text());
    }
    blocks.push(tables::events(&run.outcome.landmarks, Language::English.words()).text());
    blocks.join("\n\n")
}

fn several(runs: &[Driven]) -> String {
    let mut table = Table::new(&[
        "SECTION",
        "CONTROLLER",
        "STOP",
        "TIME s",
        "km/h/s +",
        "−",
        "JERK m/s³",
        "RMS",
        "ROUGH %",
        "ERROR km/h",
        "kWh",
        "ENDED",
    ]);
    for run in runs {
        let (case, outcome) = (&run.case, &run.outcome);
        let figures = Metrics::ALL
            .iter()
            .filter(|figure| figure.key != "peak_speed_kmh");
        let shown = figures.map(|figure| {
            let value = outcome.metrics.as_ref().map(figure.of);
            value.map_or("-".into(), |value| figure.shown(value))
        });
        let first = [
            case.plan.section.section.to_string(),
            case.controller.name().into(),
            outcome.stop_error_m.map_or("-".into(), off),
        ];
        let ended = [outcome.ending.to_string()];
        table.row(first.into_iter().chain(shown).chain(ended));
    }
    let tolerance_cm = runs
        .first()
        .map_or(0.0, |run| run.case.tolerance_m() * 100.0);
    let aligned = runs.iter().filter(|run| run.aligned()).count();
    format!(
        "{}\n\n{aligned} of {} within ±{tolerance_cm:.0} cm",
        table.render(),
        runs.len()
    )
}

fn monte_carlo(many: &MonteCarlo) -> String {
    let (done, asked) = (many.trials.len(), many.asked);
    let within = format!(
        "\nwithin ±10 cm: {:.2} %   within ±30 cm: {:.2} %   more than 1 m past: {}   did not stop: {}",
        many.within(0.1) * 100.0,
        many.within(0.3) * 100.0,
        many.past_1m(),
        many.failures().count()
    );
    [
        format!("{}: {done} of {asked} runs", title(&many.case)),
        tables::of_many(many).text(),
        within,
        tables::worst(many).text(),
        "repeat one of them with --scattered --seed SEED".into(),
    ]
    .join("\n")
}
