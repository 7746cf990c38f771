//! A run of the case under way: the current step, the unit live, and failures as they occur.

use btu_rig::procedure::Verdict;
use eframe::egui::Ui;
use protocol::signal::{Sample, Signal};

use super::CasePage;
use crate::pages::bench::text::known;
use crate::pages::procedures::{measurements, present};
use crate::parts::{fact, ground, title, verdict_chip};
use crate::{Density, PageContext, Palette, Sizes};
use ptu_report::words::{Words, fill};
use ptu_runs::bench_worker::{Phase, Progress};

/// Number of failures that are shown, the latest first.
const FAILURES: usize = 4;

impl CasePage {
    /// Whether a run of the case is under way or about to begin.
    pub(super) fn is_running(&self, has_orders: bool, context: &PageContext<'_>) -> bool {
        let runs = context
            .units
            .chosen()
            .run_of_case()
            .is_some_and(Progress::is_running);
        runs || has_orders
    }

    /// Draws the run, or that its result is being worked out or that no run began.
    pub(super) fn running(&mut self, ui: &mut Ui, has_orders: bool, context: &mut PageContext<'_>) {
        let words = context.words;
        let unit = context.units.chosen();
        let waits = has_orders || self.is_over(context);
        let Some(run) = unit.run_of_case().filter(|_| !waits) else {
            // The run is about to begin, or its result is being worked out, or it never began.
            title(
                ui,
                match waits || unit.phase() == Phase::Running {
                    true => words.case.preparing,
                    false => words.case.not_begun,
                },
            );
            return;
        };
        let with_path = Sizes::of(ui).density == Density::Engineer;
        let answer = present(ui, words, run, None, with_path);
        if run.is_running() {
            live(ui, words, &unit.bench.live().sample);
        }
        failures(ui, words, run);
        if let Some(yes) = answer {
            context.units.chosen_mut().answer(yes);
        }
    }

    /// Draws the run that is to prove the repair, or what has to be done before that run.
    pub(super) fn prove(&mut self, ui: &mut Ui, has_orders: bool, context: &mut PageContext<'_>) {
        if self.is_running(has_orders, context) {
            self.running(ui, has_orders, context);
            return;
        }
        let words = &context.words.case;
        title(ui, words.stage_prove);
        self.proof.told(ui);
        ui.label(words.fitted_hint);
        ui.label(words.prove_hint);
    }

    /// Whether the case has a run whose result was not taken yet.
    pub(super) fn is_over(&self, context: &PageContext<'_>) -> bool {
        let id = context.units.chosen().run_of_case().and_then(Progress::id);
        id.is_some() && id != self.seen
    }
}

/// Draws the present speed, limit and brakes.
fn live(ui: &mut Ui, words: &Words, sample: &Sample) {
    let bench = &words.bench;
    let signals = [
        (bench.group_speed, Signal::Speed),
        (bench.limit, Signal::Limit),
        (bench.fsb, Signal::Fsb),
        (bench.eb, Signal::Eb),
    ];
    ui.columns(signals.len(), |columns| {
        for (ui, (name, signal)) in columns.iter_mut().zip(signals) {
            let value = sample.get(signal).map(|value| known(bench, signal, value));
            ground(&Palette::of(ui)).show(ui, |ui| {
                ui.set_width(ui.available_width());
                fact(ui, name, value.as_deref().unwrap_or("–"));
            });
        }
    });
}

fn failures(ui: &mut Ui, words: &Words, run: &Progress) {
    let results = run.procedures.iter().rev().flat_map(|progress| {
        let results = progress.results.iter().rev();
        results.map(move |result| (&progress.procedure.id, result))
    });
    let failed = results.filter(|(_, result)| result.verdict == Verdict::Failed);
    let count = failed.clone().count();
    for (place, (procedure, result)) in failed.take(FAILURES).enumerate() {
        ui.horizontal_wrapped(|ui| {
            verdict_chip(ui, result.verdict, words);
            let name = words.result(result);
            ui.label(match Sizes::of(ui).density {
                Density::Operator => name,
                Density::Engineer => format!("{procedure}: {name}"),
            });
            ui.label(words.findings(&result.findings));
        });
        ui.push_id(("failure", place), |ui| {
            measurements(ui, words, &result.measurements);
        });
    }
    if count > FAILURES {
        let more = fill(words.diagnosis.more, &[("n", &(count - FAILURES))]);
        ui.label(more);
    }
}
