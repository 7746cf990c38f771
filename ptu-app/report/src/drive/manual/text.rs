//! A run by hand as text for people.

use super::figures::{FIGURES, facts};
use super::steps::{HEADINGS, cells, step_results};
use ptu_bench::drive::manual::ManualRun;
use ptu_bench::table::Table;

/// All of it.
pub fn text(run: &ManualRun) -> String {
    let (case, outcome) = (&run.case, &run.outcome);
    let named = facts(run).into_iter();
    let named: Vec<_> = named
        .map(|(name, value)| format!("{}: {value}", name.to_lowercase()))
        .collect();
    let mut figures = Table::new(&["FIGURE", "VALUE", ""]);
    for figure in &FIGURES {
        let shown = figure.shown(&outcome.figures);
        figures.row([figure.name.into(), shown, figure.unit.into()]);
    }
    let headings = HEADINGS.map(|heading| match heading {
        "Time s" => "TIME s",
        "Done" => "DONE",
        "Brake within 2 % after s" => "WITHIN 2 % s",
        "Electric kN" => "EL kN",
        "Air T kN" => "AIR T kN",
        "Air M kN" => "AIR M kN",
        "Brake kN" => "BRAKE kN",
        other => other,
    });
    let mut steps = Table::new(&headings);
    for step in step_results(run) {
        steps.row(cells(&step));
    }
    let mut events = Table::new(&["TIME s", "PLACE m", "EVENT"]);
    for mark in &outcome.landmarks {
        let (t, x) = (format!("{:.2}", mark.t_s), format!("{:.2}", mark.x_m));
        events.row([t, x, mark.what.clone()]);
    }
    [
        format!("{}: {}\n{}", case.name, outcome.ending, named.join("; ")),
        figures.render(),
        format!("{}\n(efforts of MT pair 1, 3 s later)", steps.render()),
        events.render(),
    ]
    .join("\n\n")
}
