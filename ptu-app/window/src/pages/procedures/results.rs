//! Results of the steps, and details of the selected one.

use std::collections::BTreeMap;
use std::ops::Range;

use btu_rig::procedure::{Findings, Measurement, Procedure, StepResult, Verdict};
use eframe::egui::{
    Align, Button, Grid, Id, Label, Layout, Response, RichText, Ui, UiBuilder, vec2,
};
use egui_material_icons::icons::ICON_SHOW_CHART;
use protocol::lru;

use crate::parts::{
    Cell, Column, Face, Look, NoteOn, RunNoteForm, Table, limit_bar, rows, segments, value_text,
    verdict_look,
};
use crate::query_worker::QueryWorker;
use crate::{Density, Destination, Palette, Sizes};
use ptu_report::limits::limits_text;
use ptu_report::limits::short;
use ptu_report::naming::{self, DOT, PartNames, code, failed_turn};
use ptu_report::run::source_in_words;
use ptu_report::words::{Words, fill};
use ptu_runs::bench_worker::{Progress, outside_place};
use ptu_runs::run::CHECK_FAILED;

/// Script lines shown before a step's line, and after it (end excluded).
const AROUND: Range<u32> = 1..4;
/// Room for the button that leads to a trace, points.
const TO_TRACE: f32 = 50.0;

/// Which of the results are shown.
#[derive(Default)]
pub struct ResultsView {
    all: bool,
    /// Places of the procedure and of the result in it.
    chosen: Option<(usize, usize)>,
}

/// Buttons that lead on from an ended run, and the field for a note on the run by `who`.
pub fn after_run(
    ui: &mut Ui,
    (words, queries): (&Words, &QueryWorker),
    run: &Progress,
    (note, who): (&mut RunNoteForm, &str),
    go_to: &mut Vec<Destination>,
) {
    let Some(id) = run.id() else { return };
    // An id of its own: widgets that come and go above take neither the focus nor a click away.
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

/// Shows the faults and the steps: those that did not pass, or all.
pub fn results(
    ui: &mut Ui,
    (words, parts): (&Words, &PartNames),
    run: &Progress,
    shown: &mut ResultsView,
    texts: Option<&BTreeMap<String, String>>,
    (traced, go_to): (&[(Findings, fault_db::Id)], &mut Vec<Destination>),
) {
    let bad = |result: &StepResult| !matches!(result.verdict, Verdict::Passed | Verdict::Skipped);
    let results = || run.procedures.iter().flat_map(|of| &of.results);
    let counts = [
        results().filter(|result| bad(result)).count(),
        results().count(),
    ];
    ui.horizontal(|ui| {
        ui.label(RichText::new(words.procedures.results).size(Sizes::of(ui).lead));
        let named = [words.procedures.bad_n, words.procedures.all_n];
        let [bad, all] = [0, 1].map(|place| fill(named[place], &[("n", &counts[place])]));
        segments(ui, &mut shown.all, [(false, &*bad), (true, &*all)]);
    });
    if let Some(result) = chosen(run, shown) {
        details(ui, (words, parts), run, result, texts);
        ui.separator();
    }
    let mut lines = Vec::new();
    for (p, of) in run.procedures.iter().enumerate() {
        let all = of.results.iter().enumerate();
        let mut of_it = all
            .filter(|(_, result)| shown.all || bad(result))
            .peekable();
        lines.extend(of_it.peek().is_some().then_some((p, None)));
        lines.extend(of_it.map(|(r, result)| (p, Some((r, result)))));
    }
    if lines.is_empty() {
        if run.id().is_some() {
            let passed = fill(words.procedures.all_passed, &[("n", &run.counts().passed)]);
            ui.label(RichText::new(passed).color(Palette::of(ui).quiet));
        }
    } else {
        table(ui, words, run, (&lines, shown), (traced, go_to));
    }
    faults(ui, (words, parts), run);
}

/// A line of the table: index of a procedure, and for a result its index and itself; without a result a heading.
type Line<'a> = (usize, Option<(usize, &'a StepResult)>);

fn table(
    ui: &mut Ui,
    words: &Words,
    run: &Progress,
    (lines, shown): (&[Line<'_>], &mut ResultsView),
    (traced, go_to): (&[(Findings, fault_db::Id)], &mut Vec<Destination>),
) {
    let columns = columns(words);
    let table = Table {
        columns: &columns,
        end: TO_TRACE,
    };
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        table.head(ui, 0.0);
        rows(ui, Table::high(ui), lines.len(), |ui, range| {
            for (p, line) in lines.get(range).into_iter().flatten() {
                let Some((r, result)) = line else {
                    group(ui, &run.procedures[*p].procedure, words);
                    continue;
                };
                let trace = trace_of(run, *p, result, traced);
                ui.horizontal(|ui| {
                    ui.spacing_mut().item_spacing.x = 0.0;
                    let on = shown.chosen == Some((*p, *r));
                    let id = &run.procedures[*p].procedure.id;
                    if row(ui, words, &table, (id, result), on).clicked() {
                        shown.chosen = (!on).then_some((*p, *r));
                    }
                    if trace.is_some() {
                        let to_trace = Face::new(Look::Quiet, "").icon(ICON_SHOW_CHART);
                        if to_trace.named(words.faults.to_trace).show(ui).clicked() {
                            go_to.extend(trace.map(Destination::Trace));
                        }
                    }
                });
            }
        });
    });
}

fn columns(words: &Words) -> [Column<'static>; 6] {
    let (common, procedures) = (&words.common, &words.procedures);
    [
        Column::new(common.verdict, 150.0),
        Column::new(common.step, 0.0),
        Column::new(common.value, 116.0).from(560.0),
        Column::new(procedures.measured, 76.0).right().from(460.0),
        Column::new("", 100.0).from(720.0),
        Column::new(procedures.limit, 92.0).from(620.0),
    ]
}

/// Heading of a procedure, above the rows of its results.
fn group(ui: &mut Ui, procedure: &Procedure, words: &Words) {
    let size = vec2(ui.available_width(), Table::high(ui));
    let quiet = Palette::of(ui).quiet;
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.set_min_size(size);
        ui.add_space(12.0);
        let name = Label::new(RichText::new(words.title(procedure)).color(quiet));
        ui.add(name.truncate()).on_hover_text(&*procedure.id);
    });
}

/// The trace that shows a step of the run's procedure at index `procedure`.
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

/// Row of a result, with the value that decided the verdict, or else the finding.
fn row(
    ui: &mut Ui,
    words: &Words,
    table: &Table<'_>,
    (procedure, result): (&str, &StepResult),
    on: bool,
) -> Response {
    let palette = Palette::of(ui);
    let (icon, colour) = verdict_look(result.verdict, &palette);
    let name = words.result(result);
    let found = words.findings(&result.findings);
    let missed = |of: &&Measurement| of.verdict != Verdict::Passed;
    let measured = result.measurements.iter().find(missed);
    let measured = measured.or_else(|| result.measurements.first().filter(|_| found.is_empty()));
    let mut cells = vec![
        Cell::State(icon, words.common.verdict(result.verdict), colour),
        Cell::Text((&*name).into(), palette.ink),
    ];
    match measured {
        Some(of) => {
            let ink = match of.verdict {
                Verdict::Passed => palette.ink,
                _ => palette.bad,
            };
            let value = of.value.map_or_else(|| "?".to_owned(), short);
            let value = format!("{value} {}", words.unit(of.unit));
            let limits = limits_text(words, of.low, of.high);
            cells.extend([
                Cell::Text(naming::measurement(&of.name, words).into(), palette.second),
                Cell::Text(value.into(), ink),
                Cell::Limits(of),
                Cell::Text(limits.into(), palette.quiet),
            ]);
        }
        None => cells.push(Cell::Rest((&*found).into(), palette.second)),
    }
    let said = match found.is_empty() {
        true => format!("{procedure}: {name}"),
        false => format!("{procedure}: {name}{DOT}{found}"),
    };
    table.row(ui, (&said, on), &cells)
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

/// Shows the script around a marked line, in an engineer's window only.
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

/// Faults that unit and train reported by themselves; failed checks stand among the steps.
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
