//! A run by hand as one HTML page with nothing outside it.

use maud::{Markup, html};

use super::super::html::page;
use super::figures::{FIGURES, facts};
use super::plots::plots;
use super::steps::{HEADINGS, cells, step_results};
use ptu_bench::drive::manual::ManualRun;

/// The page.
pub fn html(run: &ManualRun) -> String {
    let passed = run.passed();
    let body = html! {
        section {
            h2 { (run.case.plan.sequence.title) }
            p.verdict.good[passed].bad[!passed] { (run.outcome.ending) }
            div.tables { (figures(run)) (conditions(run)) }
            @for plot in plots(run) { (plot.svg()) }
            h2 { "What was done" }
            (steps(run))
            (events(run))
        }
    };
    page("Driven by hand", &body)
}

fn figures(run: &ManualRun) -> Markup {
    html! {
        table {
            @for figure in &FIGURES {
                tr {
                    th { (figure.name) }
                    td.number { (figure.shown(&run.outcome.figures)) }
                    td { (figure.unit) }
                }
            }
        }
    }
}

fn conditions(run: &ManualRun) -> Markup {
    let bench = &run.case.bench;
    html! {
        table {
            tr { th { "Sequence" } td { (run.case.name) } }
            @for (name, value) in facts(run) { tr { th { (name) } td { (value) } } }
            tr { th { "Unit configuration" } td { (bench.config.content.name) ", " code { (format!("{:08x}", bench.config.crc)) } } }
            @if !bench.settings.is_empty() {
                tr { th { "Keys changed" } td { @for setting in &bench.settings { code { (setting) } br; } } }
            }
            tr { th { "Track database" } td { (bench.line.content.name) ", " code { (format!("{:08x}", bench.line.crc)) } } }
            tr { th { "Seed" } td { (run.case.seed) } }
        }
    }
}

fn steps(run: &ManualRun) -> Markup {
    html! {
        table {
            tr { @for (at, heading) in HEADINGS.iter().enumerate() { th.number[at != 2] { (heading) } } }
            @for step in step_results(run) {
                tr { @for (at, cell) in cells(&step).iter().enumerate() { td.number[at != 2] { (cell) } } }
            }
        }
        p { "Efforts are those of MT pair 1 3 s later, or before the next step." }
    }
}

fn events(run: &ManualRun) -> Markup {
    html! {
        details {
            summary { "Events of unit and TCMS" }
            table {
                tr { th.number { "Time s" } th.number { "Place m" } th { "Event" } }
                @for mark in &run.outcome.landmarks {
                    tr {
                        td.number { (format!("{:.2}", mark.t_s)) }
                        td.number { (format!("{:.2}", mark.x_m)) }
                        td { (mark.what) }
                    }
                }
            }
        }
    }
}
