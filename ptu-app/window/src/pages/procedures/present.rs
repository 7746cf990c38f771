//! The current step of a run: what the step waits for, its prompt, its script line and its measurements.

use std::collections::BTreeMap;
use std::ops::Range;

use eframe::egui::{Frame, Margin, RichText, Ui, vec2};
use fault_db::StepKind;

use super::results::{measurements, source};
use super::tree::minutes;
use crate::parts::{ActionPlace, Face, Look, ground, progress, progress_text, verdict_chip};
use crate::{Palette, Sizes};
use ptu_report::words::{Words, fill};
use ptu_runs::bench_worker::{Progress, RunPosition};

/// Height of the progress bar of a run, points.
const BAR: f32 = 8.0;
/// Script lines shown before the current line, and after it (end excluded).
const AROUND: Range<u32> = 2..5;

/// Shows the progress of the run and the current step, with its script line (`texts`) and the procedure's
/// id (`with_path`); returns the operator's answer to a prompt.
pub fn present(
    ui: &mut Ui,
    words: &Words,
    run: &Progress,
    texts: Option<&BTreeMap<String, String>>,
    with_path: bool,
) -> Option<bool> {
    head(ui, words, run);
    if !run.is_running() {
        return None;
    }
    let Some(present) = &run.present else {
        ui.label(words.procedures.bringing_up);
        return None;
    };
    let card = ground(&Palette::of(ui));
    card.show(ui, |ui| {
        ui.set_width(ui.available_width());
        step(ui, words, (run, present), texts, with_path)
    })
    .inner
}

fn step(
    ui: &mut Ui,
    words: &Words,
    (run, present): (&Progress, &RunPosition),
    texts: Option<&BTreeMap<String, String>>,
    with_path: bool,
) -> Option<bool> {
    let progress = run.procedures.get(present.procedure)?;
    let procedure = &progress.procedure;
    let name = words.step(&present.name, present.turn, StepKind::Step);
    let name = match with_path {
        true => format!("{}: {name}", procedure.id),
        false => name,
    };
    ui.label(RichText::new(name).strong().size(Sizes::of(ui).lead));
    ui.label(RichText::new(words.title(procedure)).color(Palette::of(ui).quiet));
    waits(ui, words, present);
    let answer = prompt(ui, words, present);
    let Some(step) = run.step() else {
        return answer;
    };
    if let Some(note) = &step.note {
        ui.label(format!("{}: {}", words.common.note, words.content(note)));
    }
    source(ui, texts, &procedure.path, step.line, AROUND);
    measurements(ui, words, &present.measured);
    answer
}

fn head(ui: &mut Ui, words: &Words, run: &Progress) {
    let procedures = &words.procedures;
    let quiet = Palette::of(ui).quiet;
    let of_unit = fill(procedures.of_unit, &[("unit", &run.unit)]);
    ui.label(RichText::new(of_unit).color(quiet));
    progress(ui, vec2(ui.available_width(), BAR), run, words);
    ui.horizontal_wrapped(|ui| {
        ui.label(progress_text(run, words));
        match &run.ended {
            Some(Some(outcome)) => {
                verdict_chip(ui, outcome.verdict, words);
            }
            Some(None) => {
                ui.colored_label(Palette::of(ui).bad, words.frame.run_failed);
            }
            None => {
                let elapsed = minutes(run.elapsed_s());
                ui.label(fill(procedures.elapsed, &[("time", &elapsed)]));
                let left = minutes(run.left_s());
                ui.label(fill(procedures.left, &[("time", &left)]));
            }
        }
    });
}

fn waits(ui: &mut Ui, words: &Words, present: &RunPosition) {
    let palette = Palette::of(ui);
    if let Some(next) = &present.paused {
        let said = fill(words.procedures.paused, &[("step", next)]);
        ui.label(RichText::new(said).color(palette.warn).strong());
    } else if let Some(waiting) = &present.waiting {
        let left = format!("{:.1}", waiting.left_s());
        let said = fill(
            words.procedures.waiting,
            &[("what", &words.awaited(&waiting.what)), ("left", &left)],
        );
        ui.label(RichText::new(said).color(palette.quiet));
    }
}

fn prompt(ui: &mut Ui, words: &Words, present: &RunPosition) -> Option<bool> {
    let prompt = present.prompt.as_ref()?;
    let place = ActionPlace::new(ui, "prompt", &prompt.what);
    let mut answer = None;
    let warn = Palette::of(ui).warn;
    Frame::new()
        .stroke((2.0, warn))
        .inner_margin(Margin::same(10))
        .corner_radius(4)
        .show(ui, |ui| {
            ui.label(RichText::new(words.procedures.asked).color(warn).small());
            ui.label(RichText::new(&prompt.what).size(17.0));
            ui.horizontal(|ui| {
                // The answer is evidence: no key and no colour suggests one.
                for (text, yes) in [(words.procedures.yes, true), (words.procedures.no, false)] {
                    if place.clicked(&Face::new(Look::Secondary, text).show(ui)) {
                        answer = Some(yes);
                    }
                }
                ui.label(format!("{:.0} s", prompt.left_s()));
            });
        });
    answer
}
