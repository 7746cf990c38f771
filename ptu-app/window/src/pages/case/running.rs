//! A run of the case under way: what happens now, the unit live, and failures as they come.

use btu_rig::procedure::Verdict;
use eframe::egui::{RichText, Ui};
use protocol::signal::{Sample, Signal};

use super::{CasePage, Stage, large};
use crate::pages::bench::text::known;
use crate::pages::procedures::{measurements, present};
use crate::parts::{ActionPlace, verdict_chip};
use crate::{Density, PageContext, Sizes};
use ptu_report::words::{Words, fill};
use ptu_runs::bench_worker::{Phase, Progress};

/// As many failures are shown, the latest first.
const FAILURES: usize = 4;

impl CasePage {
    /// The run, or that there is none and the way back.
    pub(super) fn running(
        &mut self,
        ui: &mut Ui,
        has_orders: bool,
        back: Stage,
        context: &mut PageContext<'_>,
    ) {
        let words = context.words;
        let unit = context.units.chosen();
        let under_way = unit.run_of_case().filter(|run| run.is_running());
        let Some(run) = under_way else {
            // It has ended, and what it says is worked out; or it never began.
            let said = match has_orders || unit.phase() == Phase::Running || self.is_over(context) {
                true => words.case.preparing,
                false => words.case.not_begun,
            };
            ui.label(RichText::new(said).size(Sizes::of(ui).lead));
            let place = ActionPlace::new(ui, "case back", has_orders);
            if place.clicked(&large(ui, words.case.back, !has_orders)) {
                self.stage = back;
            }
            return;
        };
        let with_path = Sizes::of(ui).density == Density::Engineer;
        let answer = present(ui, words, run, None, with_path);
        live(ui, words, &unit.bench.live().sample);
        failures(ui, words, run);
        let place = ActionPlace::new(ui, "case stop", unit.bench.stop_presses());
        if place.clicked(&large(ui, words.procedures.stop, true)) {
            unit.bench.stop_run();
        }
        if let Some(yes) = answer {
            context.units.chosen_mut().answer(yes);
        }
    }

    /// The last run has ended and was not looked at yet.
    fn is_over(&self, context: &PageContext<'_>) -> bool {
        let id = context.units.chosen().run_of_case().and_then(Progress::id);
        id.is_some() && id != self.seen
    }
}

/// Speed, limit and brakes as they are now.
fn live(ui: &mut Ui, words: &Words, sample: &Sample) {
    ui.horizontal_wrapped(|ui| {
        let bench = &words.bench;
        for (name, signal) in [
            (bench.group_speed, Signal::Speed),
            (bench.limit, Signal::Limit),
            (bench.fsb, Signal::Fsb),
            (bench.eb, Signal::Eb),
        ] {
            let Some(value) = sample.get(signal) else {
                continue;
            };
            let value = known(&words.bench, signal, value);
            ui.label(RichText::new(format!("{name} {value}")).size(Sizes::of(ui).lead));
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
