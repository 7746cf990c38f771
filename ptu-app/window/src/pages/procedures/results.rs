//! Results of the steps, and details of the selected one.

use std::collections::BTreeMap;
use std::ops::Range;

use btu_rig::procedure::{Findings, Measurement, StepResult, Verdict};
use eframe::egui::{Button, Grid, Id, RichText, Ui, UiBuilder};
use protocol::lru;

use crate::parts::{NoteOn, RunNoteForm, limit_bar, link, rows, value_text, verdict_chip};
use crate::query_worker::QueryWorker;
use crate::{Density, Destination, Palette, Sizes};
use ptu_report::naming::{self, PartNames, code, failed_turn};
use ptu_report::run::source_in_words;
use ptu_report::words::{Words, fill};
use ptu_runs::bench_worker::{Progress, outside_place};
use ptu_runs::run::CHECK_FAILED;

/// Lines shown before and after a step's.
const AROUND: Range<u32> = 1..4;

/// Which of the results are shown.
#[derive(Default)]
pub struct ResultsView {
    all: bool,
    /// Places of the procedure and of the result in it.
    chosen: Option<(usize, usize)>,
}

/// Ways on from a run that is over, and what `who` has to say about it.
pub fn after_run(
    ui: &mut Ui,
    (words, queries): (&Words, &QueryWorker),
    run: &Progress,
    (note, who): (&mut RunNoteForm, &str),
    go_to: &mut Vec<Destination>,
) {
    let Some(id) = run.id() else { return };
    // A name of its own: what comes and goes above takes neither the focus nor a click away.
    let named = UiBuilder::new().scope_id(Id::unique(("after run", id)));
    let row = |ui: &mut Ui| {
        let found = !run.faults.is_empty() || run.not_passed > 0;
        let button = Button::new(RichText::new(words.procedures.to_diagnosis).strong());
        if ui.add_enabled(found, button).clicked() {
            go_to.push(Destination::Diagnosis(id));
        }
        if ui.button(words.procedures.to_report).clicked() {
            go_to.push(Destination::Report(id));
        }
        note.show(ui, words, queries, who, NoteOn::Run(id));
    };
    ui.scope_builder(named, |ui| ui.horizontal_wrapped(row));
}

/// Steps that did not pass, or all, and faults.
pub fn results(
    ui: &mut Ui,
    (words, parts): (&Words, &PartNames),
    run: &Progress,
    shown: &mut ResultsView,
    texts: Option<&BTreeMap<String, String>>,
    (traced, go_to): (&[(Findings, fault_db::Id)], &mut Vec<Destination>),
) {
    ui.separator();
    ui.horizontal(|ui| {
        ui.label(RichText::new(words.procedures.results).strong());
        let mut only_bad = !shown.all;
        ui.checkbox(&mut only_bad, words.procedures.only_bad);
        shown.all = !only_bad;
    });
    let all = shown.all;
    let found: Vec<(usize, usize, &StepResult)> = run
        .procedures
        .iter()
        .enumerate()
        .flat_map(|(p, progress)| {
            let results = progress.results.iter().enumerate();
            results.map(move |(r, result)| (p, r, result))
        })
        .filter(|(.., result)| all || !matches!(result.verdict, Verdict::Passed | Verdict::Skipped))
        .collect();
    if let Some(result) = chosen(run, shown) {
        details(ui, (words, parts), run, result, texts);
        ui.separator();
    }
    faults(ui, (words, parts), run);
    if found.is_empty() && run.id().is_some() {
        let passed = fill(words.procedures.all_passed, &[("n", &run.counts().passed)]);
        ui.label(RichText::new(passed).color(Palette::of(ui).quiet));
    }
    let height = ui.spacing().interact_size.y;
    rows(ui, height, found.len(), |ui, range| {
        for (p, r, result) in found.get(range).into_iter().flatten() {
            let on = shown.chosen == Some((*p, *r));
            let trace = trace_of(run, *p, result, traced);
            if row(
                ui,
                words,
                run,
                ((*p, *r), result, trace.is_some()),
                on,
                shown,
            ) {
                go_to.extend(trace.map(Destination::Trace));
            }
        }
    });
}

/// The trace that shows a step of the run's procedure of this place.
fn trace_of(
    run: &Progress,
    procedure: usize,
    result: &StepResult,
    traced: &[(Findings, fault_db::Id)],
) -> Option<fault_db::Id> {
    let procedure = &run.procedures.get(procedure)?.procedure.id;
    let mut traced = traced.iter();
    Some(
        traced
            .find(|(seen, _)| failed_turn(seen, procedure, &result.name) == Some(result.turn))?
            .1,
    )
}

/// A result; true when its trace is wanted.
fn row(
    ui: &mut Ui,
    words: &Words,
    run: &Progress,
    (place, result, has_trace): ((usize, usize), &StepResult, bool),
    on: bool,
    shown: &mut ResultsView,
) -> bool {
    let row = ui.horizontal(|ui| {
        verdict_chip(ui, result.verdict, words);
        let id = run.procedures.get(place.0).map(|p| p.procedure.id.as_str());
        let name = format!("{}: {}", id.unwrap_or_default(), words.result(result));
        let to_trace = has_trace && link(ui, words.faults.to_trace).clicked();
        if ui.selectable_label(on, name).clicked() {
            shown.chosen = (!on).then_some(place);
        }
        if !result.findings.is_empty() {
            let message =
                RichText::new(words.findings(&result.findings)).color(Palette::of(ui).quiet);
            ui.add(eframe::egui::Label::new(message).truncate());
        }
        to_trace
    });
    row.inner
}

fn chosen<'a>(run: &'a Progress, shown: &ResultsView) -> Option<(usize, &'a StepResult)> {
    let (procedure, result) = shown.chosen?;
    Some((
        procedure,
        run.procedures.get(procedure)?.results.get(result)?,
    ))
}

fn details(
    ui: &mut Ui,
    (words, parts): (&Words, &PartNames),
    run: &Progress,
    (procedure, result): (usize, &StepResult),
    texts: Option<&BTreeMap<String, String>>,
) {
    let Some(progress) = run.procedures.get(procedure) else {
        return;
    };
    let procedure = &progress.procedure;
    let name = words.result(result);
    ui.label(RichText::new(format!("{}: {name}", procedure.id)).strong());
    if !result.findings.is_empty() {
        ui.label(words.findings(&result.findings));
    }
    if outside_place(result).is_some() {
        return;
    }
    if result.verdict == Verdict::Failed {
        let part = parts.name(lru::shown(result.suspect.as_ref()), words.language);
        ui.label(fill(words.procedures.suspect, &[("part", &part)]));
    }
    if let Some(note) = procedure
        .steps
        .get(result.index)
        .and_then(|step| step.note.as_ref())
    {
        ui.label(format!("{}: {}", words.common.note, words.content(note)));
    }
    if result.measurements.is_empty() {
        ui.label(RichText::new(words.procedures.no_measurements).color(Palette::of(ui).quiet));
    }
    measurements(ui, words, &result.measurements);
    source(ui, texts, &procedure.path, result.line, AROUND);
}

/// Measurements with their limits as bars.
pub fn measurements(ui: &mut Ui, words: &Words, measured: &[Measurement]) {
    if measured.is_empty() {
        return;
    }
    Grid::new("measurements").num_columns(3).show(ui, |ui| {
        for measurement in measured {
            let name = naming::measurement(&measurement.name, words);
            ui.label(&name);
            let bar = limit_bar(ui, words, (&name, measurement));
            if let Some(source) = &measurement.limit_source {
                bar.on_hover_text(source_in_words(source, words));
            }
            let colour = Palette::of(ui).verdict(measurement.verdict);
            ui.colored_label(colour, value_text(measurement, words));
            ui.end_row();
        }
    });
}

/// The script around a line, which is marked; an operator reads no source.
pub fn source(
    ui: &mut Ui,
    texts: Option<&BTreeMap<String, String>>,
    path: &str,
    line: u32,
    around: Range<u32>,
) {
    let shown = texts.filter(|_| Sizes::of(ui).density == Density::Engineer);
    let Some(text) = shown.and_then(|texts| texts.get(path)) else {
        return;
    };
    let palette = Palette::of(ui);
    let first = line.saturating_sub(around.start).max(1);
    let lines = (first..).zip(text.lines().skip(first as usize - 1));
    let job = lines
        .take_while(|(number, _)| *number < line + around.end)
        .map(|(number, text)| {
            let mark = if number == line { "▶" } else { " " };
            (number == line, format!("{mark}{number:>4}  {text}"))
        });
    ui.label(
        RichText::new(format!("{path}:{line}"))
            .small()
            .color(palette.quiet),
    );
    for (present, text) in job {
        let text = RichText::new(text).monospace();
        let text = if present {
            text.color(palette.accent)
        } else {
            text.color(palette.quiet)
        };
        ui.add(eframe::egui::Label::new(text).truncate());
    }
}

/// What unit and train reported by themselves; failed checks stand among the steps.
fn faults(ui: &mut Ui, (words, parts): (&Words, &PartNames), run: &Progress) {
    let reported = || run.faults.iter().filter(|fault| fault.code != CHECK_FAILED);
    if reported().next().is_none() {
        return;
    }
    ui.label(RichText::new(words.procedures.faults_found).strong());
    for fault in reported() {
        let bad = Palette::of(ui).bad;
        ui.horizontal_wrapped(|ui| {
            let code = code(i64::from(fault.code), &fault.name, words);
            ui.colored_label(bad, code);
            let part = parts.name(lru::shown(fault.lru.as_ref()), words.language);
            ui.label(fill(words.procedures.suspect, &[("part", &part)]));
            ui.label(words.finding(&fault.finding));
        });
    }
}
