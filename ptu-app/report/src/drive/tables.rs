//! The tables of a report, the same in text and on printed pages.

use btu_rig::drive::{Figure, Landmark, Metrics};

use super::facts::{conditions, off, stop};
use crate::run::block::{self, Align, Column};
use crate::words::Words;
use ptu_runs::drive::Driven;
use ptu_runs::drive::monte_carlo::{MonteCarlo, percentile};
use ptu_runs::table;

/// Percentiles that are shown.
const PERCENTILES: [f64; 5] = [0.1, 2.5, 50.0, 97.5, 99.9];
/// Least width of a printed column, in letters.
const SHORTEST: usize = 8;
/// Sign in place of an unknown value.
const UNKNOWN: &str = "–";

pub struct Table {
    /// Heading of each column, in text and on a page; a page on which all are empty has no line of headings.
    headings: Vec<(String, String)>,
    rows: Vec<Vec<String>>,
    /// Columns of words on a page; all others are numbers.
    words: Vec<usize>,
}

impl Table {
    fn new(headings: &[(&str, &str)], words: impl Into<Vec<usize>>) -> Self {
        let owned = |(text, page): &(&str, &str)| ((*text).into(), (*page).into());
        Self {
            headings: headings.iter().map(owned).collect(),
            rows: Vec::new(),
            words: words.into(),
        }
    }

    pub fn text(&self) -> String {
        let headings: Vec<_> = self
            .headings
            .iter()
            .map(|heading| heading.0.as_str())
            .collect();
        let mut table = table::Table::new(&headings);
        for row in &self.rows {
            table.row(row.iter().cloned());
        }
        table.render()
    }

    /// The table for printed pages, in one language.
    pub fn printed(&self, words: &Words) -> block::Table {
        let columns = self.headings.len();
        let said = |text: &String| words.content(text).into_owned();
        let rows: Vec<Vec<String>> = (self.rows.iter())
            .map(|row| row.iter().map(said).collect())
            .collect();
        let headings: Vec<_> = self.headings.iter().map(|head| said(&head.1)).collect();
        let longest = |at: usize| {
            let cells = rows.iter().filter_map(|row| row.get(at));
            let letters = cells
                .chain(headings.get(at))
                .map(|cell| cell.chars().count());
            letters.max().unwrap_or(0).max(SHORTEST) as f32
        };
        let all: f32 = (0..columns).map(longest).sum();
        let column = |(at, name): (usize, &String)| {
            let align = match self.words.contains(&at) {
                true => Align::Left,
                false => Align::Right,
            };
            Column::new(name, longest(at) / all, align)
        };
        block::Table {
            columns: headings.iter().enumerate().map(column).collect(),
            rows: rows.iter().cloned().map(block::Row::words).collect(),
        }
    }
}

/// A row for each figure: its name, its value in each run, its unit.
fn figures(values: &[Option<&Metrics>]) -> Vec<Vec<String>> {
    let row = |figure: &Figure| {
        let shown = |run: &Metrics| figure.shown((figure.of)(run));
        let cells = values.iter().map(|run| run.map_or(UNKNOWN.into(), shown));
        let named = std::iter::once(figure.name.into()).chain(cells);
        named.chain([figure.unit.into()]).collect()
    };
    Metrics::ALL.iter().map(row).collect()
}

fn one_run(rows: Vec<Vec<String>>) -> Table {
    Table {
        rows,
        ..Table::new(&[("FIGURE", ""), ("VALUE", ""), ("", "")], [0, 2])
    }
}

/// Figures of automatic runs, side by side under the names of their controllers.
pub fn of_runs(runs: &[Driven]) -> Table {
    let error = |run: &Driven| run.outcome.stop_error_m.map_or(UNKNOWN.into(), off);
    let mut rows = vec![vec!["Stop error".to_owned()]];
    rows[0].extend(runs.iter().map(error));
    rows[0].push(String::new());
    let metrics: Vec<_> = runs
        .iter()
        .map(|run| run.outcome.metrics.as_ref())
        .collect();
    rows.extend(figures(&metrics));
    let mut table = one_run(rows);
    if runs.len() > 1 {
        let name = |run: &Driven| (String::new(), run.case.controller.name().to_owned());
        table.words = vec![0, runs.len() + 1];
        table.headings = runs.iter().map(name).collect();
        table.headings.insert(0, Default::default());
        table.headings.push(Default::default());
    }
    table
}

/// Percentiles of the figures of many runs.
pub fn of_many(many: &MonteCarlo) -> Table {
    let row = |name: String, values: &[f64], shown: &dyn Fn(f64) -> String| {
        let cell = |percent| percentile(values, percent).map_or("-".into(), shown);
        let cells = PERCENTILES.iter().copied().chain([0.0, 100.0]).map(cell);
        std::iter::once(name).chain(cells).collect()
    };
    let errors = row("Stop error".into(), &many.stop_errors_m(), &off);
    let figure = |figure: &Figure| {
        let name = format!("{}, {}", figure.name, figure.unit);
        row(name, &many.figures(figure.of), &|value| figure.shown(value))
    };
    let percents = PERCENTILES.map(|percent| format!("{percent} %"));
    let mut headings = vec![("FIGURE", "")];
    headings.extend(
        percents
            .iter()
            .map(|percent| (percent.as_str(), percent.as_str())),
    );
    headings.extend([("LEAST", "least"), ("MOST", "most")]);
    Table {
        rows: std::iter::once(errors)
            .chain(Metrics::ALL.iter().map(figure))
            .collect(),
        ..Table::new(&headings, [0])
    }
}

/// The worst of many runs.
pub fn worst(many: &MonteCarlo) -> Table {
    let headings = [
        ("WORST: SEED", "Seed"),
        ("STOP", "Stop"),
        ("TRAIN AND DAY", "Train and day"),
    ];
    let mut table = Table::new(&headings, [1, 2]);
    for trial in many.worst() {
        let mut case = many.case.clone();
        (case.plan.load_kg, case.plan.conditions) = (trial.drawn.load_kg, trial.drawn.conditions);
        let day = conditions(&case).into_iter().skip(1);
        let day: Vec<_> = day
            .map(|(name, value)| format!("{} {value}", name.to_lowercase()))
            .collect();
        let row = vec![trial.seed.to_string(), stop(trial), day.join("; ")];
        table.rows.push(row);
    }
    table
}

/// Table of the events of a drive.
pub fn events(landmarks: &[Landmark], words: &Words) -> Table {
    let headings = [
        ("TIME s", "Time s"),
        ("PLACE m", "Place m"),
        ("EVENT", "Event"),
    ];
    let row = |mark: &Landmark| {
        vec![
            format!("{:.2}", mark.t_s),
            format!("{:.2}", mark.x_m),
            words.mark(&mark.what),
        ]
    };
    Table {
        rows: landmarks.iter().map(row).collect(),
        ..Table::new(&headings, [2])
    }
}
