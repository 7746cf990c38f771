//! Run, pause, single step, stop.

use eframe::egui::{DragValue, Ui};
use egui_material_icons::icons::{ICON_PAUSE, ICON_SKIP_NEXT, ICON_STOP};

use super::ProceduresPage;
use crate::PageContext;
use crate::parts::{ActionPlace, Face, Look};
use crate::request::Request;
use crate::units::Unit;
use ptu_report::words::Words;
use ptu_runs::bench_worker::Phase;

/// Most repetitions of a run.
const MOST: u32 = 10_000;

impl ProceduresPage {
    pub(super) fn controls(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        ui.horizontal_wrapped(|ui| {
            let unit = context.units.chosen();
            let phase = unit.phase();
            let live_state = &unit.bench.live_state();
            let state = (
                unit.id,
                phase == Phase::Running,
                live_state.paused(),
                unit.bench.stop().presses(),
            );
            let place = ActionPlace::new(ui, "run", state);
            if phase == Phase::Running {
                running(ui, context, &place);
            } else {
                self.begin(ui, context, &place);
            }
            let words = &context.words.procedures;
            ui.toggle_value(&mut context.settings.live_plot, words.live_signals)
                .on_hover_text(words.live_signals_hint);
        });
    }

    fn begin(&mut self, ui: &mut Ui, context: &mut PageContext<'_>, place: &ActionPlace) {
        let words = &context.words.procedures;
        let sound = matches!(&self.suite, Request::Ready(suite) if suite.errors.is_empty());
        let may = context.units.chosen().may_run() && sound && self.orders.is_empty();
        let why_not = why_not(context.units.chosen(), context.words);
        let run = Face::new(Look::Primary, words.run).off((!may).then_some(why_not));
        if place.clicked(&run.show(ui)) {
            self.order(context.units.chosen().id, false, context);
        }
        let find = Face::new(Look::Secondary, words.find_part).hint(words.find_part_hint);
        if place.clicked(&find.because((!may).then_some(why_not)).show(ui)) {
            self.order(context.units.chosen().id, true, context);
        }
        if context.units.count() > 1 {
            let idle = context.units.iter().filter(|unit| unit.may_run());
            let ready: Vec<u64> = idle.map(|unit| unit.id).collect();
            let may = sound && !ready.is_empty() && self.orders.is_empty();
            let all = Face::new(Look::Secondary, words.run_all);
            if place.clicked(&all.because((!may).then_some(why_not)).show(ui)) {
                for unit in ready {
                    self.order(unit, false, context);
                }
            }
        }
        ui.add(
            DragValue::new(&mut self.how.repeat)
                .range(1..=MOST)
                .suffix(format!(" × {}", words.repeat)),
        );
        ui.checkbox(&mut self.how.stop_on_fail, words.stop_on_fail);
    }
}

/// Reason for which a unit cannot be run now.
pub fn why_not(unit: &Unit, words: &Words) -> &'static str {
    match unit.phase() {
        Phase::Idle => words.procedures.about_to_begin,
        Phase::Running => words.case.under_way,
        Phase::MakingSafe => words.frame.stopping,
        Phase::Offline | Phase::Connecting => words.procedures.connect_first,
    }
}

fn running(ui: &mut Ui, context: &mut PageContext<'_>, place: &ActionPlace) {
    let words = &context.words.procedures;
    let worker = &context.units.chosen().bench;
    let live_state = &worker.live_state();
    let paused = live_state.paused();
    let pause = if paused { words.resume } else { words.pause };
    let pause = Face::new(Look::Secondary, pause).icon(ICON_PAUSE);
    if place.clicked(&pause.show(ui)) {
        live_state.pause(!paused);
    }
    let step = Face::new(Look::Secondary, words.single_step).icon(ICON_SKIP_NEXT);
    if step
        .because((!paused).then_some(words.pause))
        .show(ui)
        .clicked()
    {
        live_state.single_step();
    }
    let stop = if worker.stop().presses() == 0 {
        words.stop
    } else {
        words.stop_again
    };
    let stop = Face::new(Look::Danger, stop).icon(ICON_STOP);
    if place.clicked(&stop.show(ui)) {
        worker.stop().press();
    }
}
