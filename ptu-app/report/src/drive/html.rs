//! Runs as one HTML page with nothing outside it: figures, conditions, plots, and how to repeat the
//! run.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::figures::{FIGURES, conditions, ending, off, title};
use super::plots::plots;
use super::{Outcomes, Results, html_many};
use crate::page_text;
use ptu_bench::clock;
use ptu_bench::drive::{Case, Driven};

/// The page.
pub fn html(results: &Results) -> String {
    let (heading, body) = match &results.outcomes {
        Outcomes::Single(runs) => (
            "Station-to-station run",
            html! { @for group in groups(runs) { (section(group)) } },
        ),
        Outcomes::Many(many) => (
            "Monte Carlo of station-to-station runs",
            html! { @for one in many { (html_many::section(one)) } },
        ),
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

/// Runs of the same section together: its controllers side by side.
fn groups(runs: &[Driven]) -> impl Iterator<Item = &[Driven]> {
    runs.chunk_by(|a, b| a.case.plan.section.section == b.case.plan.section.section)
}

fn section(runs: &[Driven]) -> Markup {
    let Some(first) = runs.first() else {
        return html! {};
    };
    let alone = runs.len() == 1;
    html! {
        section {
            h2 { (if alone { title(&first.case) } else {
                format!("{} section {}", first.case.bench.line.content.name, first.case.plan.section.section)
            }) }
            @for run in runs {
                p.verdict.good[run.aligned()].bad[!run.aligned()] {
                    @if !alone { b { (run.case.controller.name()) ": " } }
                    (ending(run))
                }
            }
            div.tables { (figures(runs)) (facts(&first.case)) }
            @for plot in plots(runs) { (plot.svg()) }
            @for run in runs { (events(run, alone)) }
        }
    }
}

fn figures(runs: &[Driven]) -> Markup {
    let of = |run: &Driven, shown: &dyn Fn(&btu_rig::drive::Metrics) -> String| {
        run.outcome.metrics.as_ref().map_or("–".into(), shown)
    };
    html! {
        table {
            @if runs.len() > 1 {
                tr { th {} @for run in runs { th.number { (run.case.controller.name()) } } th {} }
            }
            tr {
                th { "Stop error" }
                @for run in runs {
                    td.number { (run.outcome.stop_error_m.map_or("–".into(), off)) }
                }
                td {}
            }
            @for figure in &FIGURES {
                tr {
                    th { (figure.name) }
                    @for run in runs { td.number { (of(run, &|m| figure.shown(m))) } }
                    td { (figure.unit) }
                }
            }
        }
    }
}

/// What was run, on what, under which conditions.
pub fn facts(case: &Case) -> Markup {
    let bench = &case.bench;
    let settings = bench
        .settings
        .iter()
        .map(ToString::to_string)
        .collect::<Vec<_>>();
    html! {
        table {
            @for (name, value) in conditions(case) { tr { th { (name) } td { (value) } } }
            tr { th { "Unit configuration" } td { (bench.config.content.name) ", " code { (format!("{:08x}", bench.config.crc)) } } }
            @if !settings.is_empty() {
                tr { th { "Keys changed" } td { @for setting in settings { code { (setting) } br; } } }
            }
            tr { th { "Track database" } td { (bench.line.content.name) ", " code { (format!("{:08x}", bench.line.crc)) } } }
            tr { th { "Length to the stop point" } td { (format!("{:.2} m", case.plan.section.stop_m - case.plan.section.start_m)) } }
            tr { th { "Seed" } td { (case.seed) } }
        }
    }
}

fn events(run: &Driven, alone: bool) -> Markup {
    html! {
        details open[alone] {
            summary { "Events" @if !alone { ", " (run.case.controller.name()) } }
            table {
                tr { th.number { "Time s" } th.number { "Place m" } th { "Event" } }
                @for landmark in &run.outcome.landmarks {
                    tr {
                        td.number { (format!("{:.2}", landmark.t_s)) }
                        td.number { (format!("{:.2}", landmark.x_m)) }
                        td { (landmark.what) }
                    }
                }
            }
        }
    }
}

/// An argument as a shell takes it back.
fn quoted(argument: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:@+%".contains(c);
    if !argument.is_empty() && argument.chars().all(plain) {
        return argument.to_owned();
    }
    format!("'{}'", argument.replace('\'', "'\\''"))
}

/// Look of the page, light and dark.
const STYLE: &str = include_str!("style.css");
