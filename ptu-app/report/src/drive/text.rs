//! Runs as text for people.

use super::figures::{FIGURES, conditions, ending, off, stop, title};
use super::{Outcomes, Results};
use ptu_bench::drive::Driven;
use ptu_bench::drive::monte_carlo::{MonteCarlo, percentile};
use ptu_bench::table::Table;

/// Percentiles that are shown.
pub const PERCENTILES: [f64; 5] = [0.1, 2.5, 50.0, 97.5, 99.9];

/// All of it.
pub fn text(results: &Results) -> String {
    let blocks: Vec<_> = match &results.outcomes {
        Outcomes::Single(runs) => match runs.as_slice() {
            [] => vec!["stopped before anything was driven".into()],
            [run] => vec![one(run)],
            runs => vec![several(runs)],
        },
        Outcomes::Many(many) => many.iter().map(monte_carlo).collect(),
    };
    blocks.join("\n\n")
}

fn one(run: &Driven) -> String {
    let mut lines = vec![format!("{}: {}", title(&run.case), ending(run))];
    let named = conditions(&run.case).into_iter();
    lines.push(
        named
            .map(|(name, value)| format!("{}: {value}", name.to_lowercase()))
            .collect::<Vec<_>>()
            .join("; "),
    );
    if let Some(metrics) = &run.outcome.metrics {
        let mut table = Table::new(&["FIGURE", "VALUE", ""]);
        if let Some(error) = run.outcome.stop_error_m {
            table.row(["Stop error".into(), off(error), String::new()]);
        }
        for figure in &FIGURES {
            table.row([
                figure.name.into(),
                figure.shown(metrics),
                figure.unit.into(),
            ]);
        }
        lines.push(format!("\n{}", table.render()));
    }
    let mut table = Table::new(&["TIME s", "PLACE m", "EVENT"]);
    for landmark in &run.outcome.landmarks {
        let (t, x) = (
            format!("{:.2}", landmark.t_s),
            format!("{:.2}", landmark.x_m),
        );
        table.row([t, x, landmark.what.clone()]);
    }
    lines.push(format!("\n{}", table.render()));
    lines.join("\n")
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
        let case = &run.case;
        let error = run.outcome.stop_error_m.map_or("-".into(), off);
        let figures = FIGURES
            .iter()
            .filter(|figure| figure.key != "peak_speed_kmh");
        let shown = |metrics| figures.map(|figure| figure.shown(metrics)).collect();
        let shown: Vec<String> = run
            .outcome
            .metrics
            .as_ref()
            .map_or(vec!["-".into(); 8], shown);
        let first = [
            case.plan.section.section.to_string(),
            case.controller.name().into(),
            error,
        ];
        let ended = [run.outcome.ending.to_string()];
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
    let done = many.trials.len();
    let mut lines = vec![format!(
        "{}: {done} of {} runs",
        title(&many.case),
        many.asked
    )];
    let mut table = Table::new(&[
        "FIGURE", "0.1 %", "2.5 %", "50 %", "97.5 %", "99.9 %", "LEAST", "MOST",
    ]);
    let mut row = |name: String, values: &[f64], of: &dyn Fn(f64) -> String| {
        let cell = |percent| percentile(values, percent).map_or("-".into(), of);
        let cells = PERCENTILES.iter().copied().chain([0.0, 100.0]).map(cell);
        table.row(std::iter::once(name).chain(cells));
    };
    row("Stop error".into(), &many.stop_errors_m(), &off);
    for figure in &FIGURES {
        let name = format!("{}, {}", figure.name, figure.unit);
        row(name, &many.figures(figure.of), &|value| figure.told(value));
    }
    lines.push(table.render());
    lines.push(format!(
        "\nwithin ±10 cm: {:.2} %   within ±30 cm: {:.2} %   more than 1 m past: {}   did not stop: {}",
        many.within(0.1) * 100.0,
        many.within(0.3) * 100.0,
        many.past_1m(),
        many.failures().count()
    ));
    let mut table = Table::new(&["WORST: SEED", "STOP", "TRAIN AND DAY"]);
    for trial in many.worst() {
        let mut case = many.case.clone();
        (case.plan.load_kg, case.plan.conditions) = (trial.drawn.load_kg, trial.drawn.conditions);
        let day = conditions(&case).into_iter().skip(1);
        let day: Vec<_> = day
            .map(|(name, value)| format!("{} {value}", name.to_lowercase()))
            .collect();
        table.row([trial.seed.to_string(), stop(trial), day.join("; ")]);
    }
    lines.push(table.render());
    lines.push("repeat one of them with --scattered --seed SEED".into());
    lines.join("\n")
}
