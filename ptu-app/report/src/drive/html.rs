//! Runs as one HTML page with nothing outside it: figures, conditions, plots, and how to repeat the
//! run.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::facts::{Fact, by_hand, conditions, ending, title};
use super::plots::{plots, plots_by_hand, plots_of_many};
use super::tables::{self, Table};
use super::{Outcomes, Results};
use crate::page_text;
use crate::plot::Plot;
use ptu_bench::clock;
use ptu_bench::drive::manual::ManualRun;
use ptu_bench::drive::monte_carlo::MonteCarlo;
use ptu_bench::drive::{Case, DriveBench, Driven};

/// Look of the page, light and dark.
const STYLE: &str = include_str!("style.css");

pub fn html(results: &Results) -> String {
    let (heading, body) = match &results.outcomes {
        Outcomes::Single(runs) => (
            "Station-to-station run",
            html! { @for group in groups(runs) { (of_runs(group)) } },
        ),
        Outcomes::Many(many) => (
            "Monte Carlo of station-to-station runs",
            html! { @for one in many { (of_many(one)) } },
        ),
        Outcomes::ByHand(run) => ("Driven by hand", of_run_by_hand(run)),
    };
    page(heading, &body)
}

/// A page with nothing outside it, and how to make it again.
pub fn page(heading: &str, body: &Markup) -> String {
    let command = std::env::args()
        .skip(1)
        .map(|argument| quoted(&argument))
        .collect::<Vec<_>>();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (heading) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { (heading) }
                (body)
                footer {
                    p { "Repeat with " code { "ptu " (command.join(" ")) } }
                    p { "ptu " (env!("CARGO_PKG_VERSION")) ", " (clock::local(clock::now_us())) }
                }
            }
        }
    };
    page_text(page)
}

/// A section of the page: what came of it, its figures beside what was run on, plots, and the rest.
fn section(
    heading: &str,
    verdicts: &[(bool, Markup)],
    tables: [Markup; 2],
    plots: &[Plot],
    rest: &Markup,
) -> Markup {
    html! {
        section {
            h2 { (heading) }
            @for (good, verdict) in verdicts { p.verdict.good[*good].bad[!*good] { (verdict) } }
            div.tables { @for table in &tables { (table) } }
            @for plot in plots { (plot.svg()) }
            (rest)
        }
    }
}

/// Runs of the same section together: its controllers side by side.
fn groups(runs: &[Driven]) -> impl Iterator<Item = &[Driven]> {
    runs.chunk_by(|a, b| a.case.plan.section.section == b.case.plan.section.section)
}

fn of_runs(runs: &[Driven]) -> Markup {
    let Some(Driven { case, .. }) = runs.first() else {
        return html! {};
    };
    let alone = runs.len() == 1;
    let heading = if alone {
        title(case)
    } else {
        let line = &case.bench.line.content.name;
        format!("{line} section {}", case.plan.section.section)
    };
    let verdict = |run: &Driven| {
        let name = run.case.controller.name();
        (
            run.aligned(),
            html! { @if !alone { b { (name) ": " } } (ending(run)) },
        )
    };
    let verdicts: Vec<_> = runs.iter().map(verdict).collect();
    let events = |run: &Driven| {
        let summary = html! { "Events" @if !alone { ", " (run.case.controller.name()) } };
        folded(alone, &summary, &tables::events(&run.outcome.landmarks))
    };
    let rest = html! { @for run in runs { (events(run)) } };
    let tables = [tables::of_runs(runs).html(), facts(case)];
    section(&heading, &verdicts, tables, &plots(runs), &rest)
}

fn of_many(many: &MonteCarlo) -> Markup {
    let (done, asked) = (many.trials.len(), many.asked);
    let verdict = html! {
        (format!("within ±10 cm {:.2} %, within ±30 cm {:.2} %", many.within(0.1) * 100.0, many.within(0.3) * 100.0))
        ", more than 1 m past " (many.past_1m()) ", did not stop " (many.failures().count())
    };
    let rest = html! {
        h3 { "Worst runs" }
        p { "Repeat one with " code { "--scattered --seed SEED" } " in place of " code { "--monte-carlo" } "." }
        (tables::worst(many).html())
    };
    section(
        &format!("{}, {done} of {asked} runs", title(&many.case)),
        &[(many.passed(), verdict)],
        [tables::of_many(many).html(), facts(&many.case)],
        &plots_of_many(many),
        &rest,
    )
}

fn of_run_by_hand(run: &ManualRun) -> Markup {
    let (case, outcome) = (&run.case, &run.outcome);
    let mut known = vec![("Sequence", case.name.clone())];
    known.extend(by_hand(run));
    let rest = html! {
        h2 { "What was done" }
        (tables::steps(run).html())
        p { "Efforts are those of MT pair 1 3 s later, or before the next step." }
        (folded(false, &html! { "Events of unit and TCMS" }, &tables::events(&outcome.landmarks)))
    };
    section(
        &case.plan.sequence.title,
        &[(run.passed(), html! { (outcome.ending) })],
        [
            tables::of_run_by_hand(run).html(),
            made_of(known, &case.bench, None, case.seed),
        ],
        &plots_by_hand(run),
        &rest,
    )
}

/// What was run, on what, under which conditions.
fn facts(case: &Case) -> Markup {
    let section = &case.plan.section;
    let length_m = section.stop_m - section.start_m;
    made_of(conditions(case), &case.bench, Some(length_m), case.seed)
}

/// What is known of a run, and what its bench was made of.
fn made_of(known: Vec<Fact>, bench: &DriveBench, length_m: Option<f64>, seed: u64) -> Markup {
    let (config, line, settings) = (&bench.config, &bench.line, &bench.settings);
    let file = |name: &str, crc: u32| html! { td { (name) ", " code { (format!("{crc:08x}")) } } };
    html! {
        table {
            @for (name, value) in known { tr { th { (name) } td { (value) } } }
            tr { th { "Unit configuration" } (file(&config.content.name, config.crc)) }
            @if !settings.is_empty() {
                tr { th { "Keys changed" } td { @for setting in settings { code { (setting) } br; } } }
            }
            tr { th { "Track database" } (file(&line.content.name, line.crc)) }
            @if let Some(length_m) = length_m {
                tr { th { "Length to the stop point" } td { (format!("{length_m:.2} m")) } }
            }
            tr { th { "Seed" } td { (seed) } }
        }
    }
}

fn folded(open: bool, summary: &Markup, table: &Table) -> Markup {
    html! { details open[open] { summary { (summary) } (table.html()) } }
}

/// An argument as a shell takes it back.
fn quoted(argument: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:@+%".contains(c);
    if !argument.is_empty() && argument.chars().all(plain) {
        return argument.to_owned();
    }
    format!("'{}'", argument.replace('\'', "'\\''"))
}
