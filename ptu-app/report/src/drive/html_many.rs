//! A Monte Carlo as part of a page: percentiles, how stop errors lie, and what they go with.

use btu_rig::drive::ScatterDraw;
use maud::{Markup, html};

use super::figures::{FIGURES, conditions, off, stop, title};
use super::html::facts;
use super::text::PERCENTILES;
use crate::plot::{Place, Plot, Series, Style};
use ptu_bench::drive::monte_carlo::{MonteCarlo, percentile};

/// Bars of the histogram.
const BARS: usize = 60;
/// Dots of a scatter plot at most: more hide each other.
const MOST_DOTS: usize = 2_000;

/// One case.
pub fn section(many: &MonteCarlo) -> Markup {
    let passed = many.passed();
    html! {
        section {
            h2 { (title(&many.case)) ", " (many.trials.len()) " of " (many.asked) " runs" }
            p.verdict.good[passed].bad[!passed] {
                (format!("within ±10 cm {:.2} %, within ±30 cm {:.2} %", many.within(0.1) * 100.0, many.within(0.3) * 100.0))
                ", more than 1 m past " (many.past_1m()) ", did not stop " (many.failures().count())
            }
            div.tables { (figures(many)) (facts(&many.case)) }
            (histogram(many).svg())
            @for (name, of) in DRAWN.into_iter().filter(|(_, of)| differs(many, *of)) {
                (against(many, name, of).svg())
            }
            (worst(many))
        }
    }
}

fn figures(many: &MonteCarlo) -> Markup {
    let cells = |values: &[f64], of: &dyn Fn(f64) -> String| -> Vec<String> {
        let shown = |percent| percentile(values, percent).map_or("–".into(), of);
        PERCENTILES
            .iter()
            .copied()
            .chain([0.0, 100.0])
            .map(shown)
            .collect()
    };
    html! {
        table {
            tr { th {} @for percent in PERCENTILES { th.number { (percent) " %" } } th.number { "least" } th.number { "most" } }
            tr {
                th { "Stop error" }
                @for cell in cells(&many.stop_errors_m(), &off) { td.number { (cell) } }
            }
            @for figure in &FIGURES {
                tr {
                    th { (figure.name) ", " (figure.unit) }
                    @for cell in cells(&many.figures(figure.of), &|value| figure.told(value)) { td.number { (cell) } }
                }
            }
        }
    }
}

fn histogram(many: &MonteCarlo) -> Plot {
    let errors = many.stop_errors_m();
    let (low, high) = (
        errors.first().copied().unwrap_or(0.0),
        errors.last().copied().unwrap_or(0.0),
    );
    let width = ((high - low) / BARS as f64).max(1e-4);
    let mut counts = vec![0.0; BARS + 1];
    for error in &errors {
        counts[(((error - low) / width) as usize).min(BARS)] += 1.0;
    }
    let bar = |(i, count): (usize, f64)| ((low + (i as f64 + 0.5) * width) * 100.0, count);
    let tolerance_cm = many.case.tolerance_m() * 100.0;
    Plot {
        title: "Stop errors".into(),
        x_label: "Past the stop point, cm".into(),
        y_label: "runs".into(),
        y_reach: Some((0.0, 1.0)),
        series: vec![Series {
            name: String::new(),
            colour: 0,
            style: Style::Bars,
            points: counts.into_iter().enumerate().map(bar).collect(),
        }],
        places: [-tolerance_cm, tolerance_cm]
            .map(|x| Place {
                x,
                name: format!("{x:+.0} cm"),
            })
            .into(),
        ..Plot::default()
    }
}

/// A number of what is drawn.
type Of = fn(&ScatterDraw) -> f64;

/// What is drawn, against which stop errors are shown.
const DRAWN: [(&str, Of); 7] = [
    ("passengers, t", |d| d.load_kg / 1000.0),
    ("gradients added, ‰", |d| {
        d.conditions.gradient_offset_permille
    }),
    ("adhesion", |d| d.conditions.adhesion),
    ("delays, of nominal", |d| d.conditions.delay_factor),
    ("brakes, of nominal", |d| d.conditions.brake_factor),
    ("wheel diameter, of configured", |d| {
        d.conditions.wheel_factor
    }),
    ("PSM4 off by, cm", |d| {
        d.conditions.marker_offsets_m[3] * 100.0
    }),
];

/// Whether it was drawn at all: what is held fixed, or does not act on the train, was not.
fn differs(many: &MonteCarlo, of: Of) -> bool {
    many.trials
        .windows(2)
        .any(|pair| of(&pair[0].drawn) != of(&pair[1].drawn))
}

fn against(many: &MonteCarlo, name: &str, of: Of) -> Plot {
    let trials = many.trials.iter();
    let points = trials.filter_map(|trial| Some((of(&trial.drawn), trial.stop_error_m? * 100.0)));
    Plot {
        title: format!("Stop error by {name}"),
        x_label: name.into(),
        y_label: "cm".into(),
        series: vec![Series {
            name: String::new(),
            colour: 0,
            style: Style::Dots,
            points: points.take(MOST_DOTS).collect(),
        }],
        ..Plot::default()
    }
}

fn worst(many: &MonteCarlo) -> Markup {
    html! {
        h3 { "Worst runs" }
        p { "Repeat one with " code { "--scattered --seed SEED" } " in place of " code { "--monte-carlo" } "." }
        table {
            tr { th.number { "Seed" } th { "Stop" } th { "Train and day" } }
            @for trial in many.worst() {
                tr {
                    td.number { (trial.seed) }
                    td { (stop(trial)) }
                    td { (day(many, &trial.drawn)) }
                }
            }
        }
    }
}

fn day(many: &MonteCarlo, drawn: &ScatterDraw) -> String {
    let mut case = many.case.clone();
    (case.plan.load_kg, case.plan.conditions) = (drawn.load_kg, drawn.conditions);
    let facts = conditions(&case).into_iter().skip(1);
    facts
        .map(|(name, value)| format!("{} {value}", name))
        .collect::<Vec<_>>()
        .join("; ")
}
