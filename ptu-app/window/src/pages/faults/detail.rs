//! One fault: its repairs and notes, its occurrences, and the freeze frame of each.

use eframe::egui::{CollapsingHeader, Grid, RichText, Ui};
use fault_db::{FaultDetail, FaultEvent, FreezeSample, Occurrence};

use super::list::state_chip;
use crate::parts::{repair_line, serial_link};
use crate::{Destination, Palette, Sizes};
use ptu_report::event_text::{cause_text, correction_text, note_text};
use ptu_report::limits::short;
use ptu_report::naming::{self, PartNames};
use ptu_report::words::{Words, fill};
use ptu_runs::clock;

/// Occurrences shown at most; the command line shows all.
const MOST: usize = 50;
/// Width from which on a freeze frame has two columns of signals, points.
const TWO_BESIDE: f32 = 560.0;

/// Name and state of the fault.
pub fn head(
    ui: &mut Ui,
    (words, parts): (&Words, &PartNames),
    detail: &FaultDetail,
    go_to: &mut Vec<Destination>,
) {
    let fault = &detail.fault;
    let (palette, sizes) = (Palette::of(ui), Sizes::of(ui));
    state_chip(ui, words, fault.state);
    let name = RichText::new(parts.name(&fault.lru, words.language)).size(sizes.title);
    let name = ui.label(name.color(palette.ink));
    name.on_hover_text(fault.id.to_string());
    ui.label(&*words.found(&fault.findings, &fault.message));
    if let Some(latest) = detail.occurrences.first() {
        ui.horizontal_wrapped(|ui| ways(ui, words, latest, go_to));
    }
    ui.separator();
    let seen = (
        clock::local(fault.first_at_us),
        clock::local(fault.last_at_us),
    );
    let seen: [(&str, &dyn std::fmt::Display); 3] = [
        ("n", &fault.occurrences),
        ("first", &seen.0),
        ("last", &seen.1),
    ];
    let seen = fill(words.faults.times_seen, &seen);
    let part = part(words, detail, parts);
    let code = naming::code(fault.code, &fault.code_name, words);
    let severity = words.report.severity(&fault.severity);
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(words.common.unit).color(palette.quiet));
        serial_link(ui, words, &fault.unit_serial, go_to);
    });
    // The rows below are text that cannot be clicked, so they are as low as a line of text.
    let target = std::mem::replace(&mut ui.spacing_mut().interact_size.y, 0.0);
    for (what, value) in [
        (words.faults.cause, &*part),
        (words.common.code, &code),
        (words.common.severity, severity),
        (words.faults.seen, &seen),
    ] {
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(what).color(palette.quiet));
            ui.label(value);
        });
    }
    ui.spacing_mut().interact_size.y = target;
}

/// Text: the part that the fault points at, the part that is its cause, and the number of other faults of that cause.
fn part(words: &Words, detail: &FaultDetail, parts: &PartNames) -> String {
    let fault = &detail.fault;
    let part = parts.name(&fault.lru, words.language);
    let cause = parts.name(fault.cause(), words.language);
    let said = match detail.case.len() {
        0 => cause.to_owned(),
        n => fill(words.faults.case_of, &[("cause", &cause), ("n", &n)]),
    };
    match cause == part {
        true => said,
        false => fill(
            words.faults.with_cause,
            &[("part", &part), ("cause", &said)],
        ),
    }
}

/// Events, occurrences and the freeze frame of the latest.
pub fn rest(
    ui: &mut Ui,
    (words, parts): (&Words, &PartNames),
    detail: &FaultDetail,
    go_to: &mut Vec<Destination>,
) {
    ui.separator();
    ui.label(RichText::new(words.faults.what_was_done).strong());
    // Events from a run's diagnosis are no action of a person, and are shown above.
    let is_finding =
        |event: &&FaultEvent| (event.cause.as_ref()).is_some_and(|of| of.run.is_some());
    let events = detail.history().into_iter();
    for event in events.filter(|event| !is_finding(event)) {
        show_event(ui, (words, parts), event, (detail, go_to));
        if let Some(correction) = &event.correction {
            let said = correction_text(correction, words);
            let said = RichText::new(said).color(Palette::of(ui).warn);
            ui.indent((event.id, "withdrawn"), |ui| ui.label(said));
        }
    }
    ui.separator();
    CollapsingHeader::new(words.faults.occurrences).show(ui, |ui| {
        for seen in detail.occurrences.iter().take(MOST) {
            ui.horizontal_wrapped(|ui| {
                ui.label(clock::local(seen.at_us));
                ways(ui, words, seen, go_to);
                let found = words.found(&seen.findings, &seen.message);
                ui.label(RichText::new(&*found).color(Palette::of(ui).quiet));
            });
        }
    });
    if let Some(latest) = detail.occurrences.first() {
        CollapsingHeader::new(words.faults.freeze_frame)
            .default_open(true)
            .show(ui, |ui| freeze_frame(ui, words, &latest.freeze));
    }
}

/// Links to the trace, the sheet and the diagnosis of one occurrence.
fn ways(ui: &mut Ui, words: &Words, seen: &Occurrence, go_to: &mut Vec<Destination>) {
    let faults = &words.faults;
    let all = [
        (faults.to_trace, seen.trace_id.map(Destination::Trace)),
        (faults.to_run, Some(Destination::Report(seen.run_id))),
        (
            faults.to_diagnosis,
            Some(Destination::Diagnosis(seen.run_id)),
        ),
    ];
    for (name, to) in all {
        if let Some(to) = to.filter(|_| ui.button(name).clicked()) {
            go_to.push(to);
        }
    }
}

fn show_event(
    ui: &mut Ui,
    (words, parts): (&Words, &PartNames),
    event: &FaultEvent,
    (detail, go_to): (&FaultDetail, &mut Vec<Destination>),
) {
    let name = |part: &str| parts.name(part, words.language).to_owned();
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(clock::local(event.at_us)).color(Palette::of(ui).quiet));
        match event.state {
            Some(state) => state_chip(ui, words, state),
            None => {
                let cause = event.cause.as_ref();
                ui.label(cause.map_or(words.common.note, |_| words.faults.cause));
                if let Some(cause) = cause {
                    ui.label(cause_text(cause, name));
                }
            }
        }
        if !event.who.is_empty() {
            ui.label(RichText::new(&event.who).strong());
        }
    });
    if let Some(repair) = &event.repair {
        ui.indent(event.id.to_string(), |ui| {
            repair_line(ui, words, &name(&repair.part), repair, go_to);
        });
        return;
    }
    let said = note_text(detail, event, words);
    if !said.is_empty() {
        ui.indent(event.id.to_string(), |ui| ui.label(&*said));
    }
}

fn freeze_frame(ui: &mut Ui, words: &Words, samples: &[FreezeSample]) {
    let beside = if ui.available_width() < TWO_BESIDE {
        1
    } else {
        2
    };
    let wide = ui.available_width() / (2 * beside) as f32 - ui.spacing().item_spacing.x;
    Grid::new(("freeze", beside))
        .num_columns(2 * beside)
        .max_col_width(wide)
        .striped(true)
        .show(ui, |ui| {
            for pair in samples.chunks(beside) {
                for sample in pair {
                    ui.label(words.signal(&sample.name));
                    let value = match (&sample.label, sample.value) {
                        (Some(label), _) => words.state(&sample.name, label).into_owned(),
                        (None, Some(value)) => format!("{} {}", short(value), sample.unit),
                        (None, None) => words.faults.not_known.to_owned(),
                    };
                    ui.label(RichText::new(value).strong());
                }
                ui.end_row();
            }
        });
}
