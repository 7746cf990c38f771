//! The procedures page: select steps, run them, follow the run.

mod conclusion;
mod controls;
mod overview;
mod prepare;
mod present;
mod results;
mod selection;
mod tree;
mod wanted;

use std::sync::Arc;

use btu_rig::procedure::plan::Connection;
use btu_rig::procedure::{Findings, Procedure};
use eframe::egui::{CentralPanel, Panel, RichText, ScrollArea, Ui};

use super::bench::{BenchSnapshot, Plot, chosen};
use crate::messages::{About, told};
use crate::parts::{RunNoteForm, Side};
use crate::request::Request;
use crate::{PageContext, Palette, Sizes, Wanted};
pub use conclusion::Concluded;
pub use controls::why_not;
use prepare::{Prepared, RunSettings, ShownSuite};
pub use present::present;
use ptu_report::naming::PartNames;
use ptu_runs::bench_worker::Phase;
use ptu_runs::run::{BenchChoice, Suite};
use results::ResultsView;
pub use results::measurements;
use selection::Selection;

/// Least height of the live signals, points.
const LIVE_LEAST: f32 = 140.0;
/// Height of margins and space above the live signals, without their buttons, points.
const LIVE_HEADING: f32 = 24.0;
/// Least height of the run above the live signals, points.
const RUN_LEAST: f32 = 120.0;
/// Share of the page's height that the live signals take until the divider is dragged.
const LIVE_SHARE: f32 = 0.3;

#[derive(Default)]
pub struct ProceduresPage {
    suite: Request<Arc<Suite>>,
    /// Choice for which the suite was loaded.
    loaded_for: Option<BenchChoice>,
    /// Chosen procedures and steps; none = all except those on request.
    selection: Option<Selection>,
    parts: Request<PartNames>,
    find: String,
    /// Settings with which the chosen procedures are run.
    how: RunSettings,
    orders: Vec<PendingOrder>,
    /// Count of stops (`Units::stops`) when `orders` were checked last.
    stops: u64,
    /// Run to order as soon as the suite is loaded, and the number of its unit.
    wanted: Option<(Wanted, u64)>,
    shown: ResultsView,
    /// The conclusion of the diagnosis of the last run.
    conclusion: Request<Concluded>,
    concluded: Option<fault_db::Id>,
    /// Findings of the last run's faults, with their traces.
    traced: Request<Vec<(Findings, fault_db::Id)>>,
    note: RunNoteForm,
    plot: Plot,
}

/// An order that is being prepared.
struct PendingOrder {
    /// Number of the unit that the order is for.
    unit: u64,
    /// The run belongs to the unit's case.
    of_case: bool,
    order: Request<Prepared>,
}

impl ProceduresPage {
    pub fn show(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        self.keep_loaded(context);
        let tree = Side {
            name: context.words.procedures.title,
            wide: [300.0, 320.0],
            at_right: false,
        };
        // Stays open, because several procedures are chosen one after the other.
        tree.show_open(ui, |ui| self.tree(ui, context));
        CentralPanel::default().show(ui, |ui| {
            self.controls(ui, context);
            overview::overview(ui, context);
            ui.separator();
            if let Request::Ready(suite) = &self.suite
                && !suite.errors.is_empty()
            {
                script_errors(ui, suite, context);
            }
            let room = ui.available_height();
            let live =
                context.settings.live_plot && context.units.chosen().phase() != Phase::Offline;
            // In a low window the live signals scroll with the run, above it.
            let scrolls = live && room < LIVE_LEAST + RUN_LEAST;
            if live && !scrolls {
                let panel = Panel::bottom("live signals").resizable(true);
                let panel = panel.default_size((room * LIVE_SHARE).max(LIVE_LEAST));
                panel
                    .size_range(LIVE_LEAST..=room - RUN_LEAST)
                    .show(ui, |ui| {
                        let height = ui.available_height();
                        live_signals(ui, &mut self.plot, height, context);
                    });
            }
            // All parts of a run scroll together, so that each can be reached in a low window.
            ScrollArea::vertical()
                .id_salt("run")
                .auto_shrink(false)
                .show(ui, |ui| {
                    if scrolls {
                        live_signals(ui, &mut self.plot, LIVE_LEAST, context);
                    }
                    self.run(ui, context);
                });
        });
    }

    /// The procedures of the chosen unit, once they are loaded.
    pub fn loaded(&mut self, context: &PageContext<'_>) -> &[Arc<Procedure>] {
        self.keep_loaded(context);
        let suite = self.suite.value();
        suite.map_or(&[], |suite| &suite.procedures)
    }

    /// Chooses this step alone.
    pub fn choose_step(&mut self, procedure: &str, step: &str) {
        let all = self
            .suite
            .value()
            .map_or(&[][..], |suite| &suite.procedures);
        if let Some(found) = all.iter().find(|known| known.id == procedure) {
            self.selection = Some(Selection::only(found, step));
            found.id.clone_into(&mut self.find);
        }
    }

    /// A run is about to begin.
    pub fn has_orders(&self) -> bool {
        self.wanted.is_some() || !self.orders.is_empty()
    }

    /// Conclusion of the last run of the chosen unit, once it is known.
    pub fn concluded(&self) -> Option<(fault_db::Id, &Request<Concluded>)> {
        Some((self.concluded?, &self.conclusion))
    }

    /// Loads the scripts for the unit's configuration, line and train, again when one of the three changes.
    fn keep_loaded(&mut self, context: &PageContext<'_>) {
        let choice = &context.units.chosen().choice;
        let loaded_for = self.loaded_for.as_ref();
        let same = loaded_for.is_some_and(|loaded| loaded.same_files(choice));
        if !same {
            self.load(context);
        }
    }

    fn load(&mut self, context: &PageContext<'_>) {
        let parts = context
            .queries
            .run(|paths| Ok(PartNames::of(&paths.scripts)));
        self.parts = Request::Pending(parts);
        let choice = context.units.chosen().choice.clone();
        self.loaded_for = Some(choice.clone());
        self.suite = Request::Pending(
            context
                .queries
                .run(move |paths| prepare::load(paths, &choice).map(Arc::new)),
        );
    }

    /// Takes responses that have arrived and begins runs, whichever page is shown.
    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        if self.stops != context.units.stops() || context.settings.is_locked() {
            // After a stop of all units no ordered run begins by itself, nor while the window is locked.
            self.stops = context.units.stops();
            self.orders.clear();
            self.wanted = None;
        }
        if self.suite.poll()
            && let Request::Failed(why) = &self.suite
        {
            let said = context.words.procedures.not_loaded;
            context.messages.trouble(said, why.clone());
        }
        self.parts.poll();
        self.run_wanted(context);
        self.note.poll(context.words, context.messages);
        self.poll_orders(context);
        self.conclude(context);
    }

    /// Chosen procedures, or those that would run without a choice.
    fn chosen(&self, connection: Connection) -> Selection {
        let usual = || {
            let suite = self.suite.value();
            suite.map(|suite| Selection::usual(&suite.procedures, connection))
        };
        let chosen = self.selection.clone().or_else(usual);
        chosen.unwrap_or_default()
    }

    fn order(&mut self, unit: u64, adaptive: bool, context: &mut PageContext<'_>) {
        let search = RunSettings {
            adaptive,
            ..RunSettings::default()
        };
        let how = if adaptive { search } else { self.how.clone() };
        let connection = context.units.of_id(unit).map(|unit| unit.connection());
        if let Some(connection) = connection {
            let selection = self.chosen(connection);
            self.order_of((unit, false), selection, how, context);
        }
    }

    /// Prepares an order for the unit of number `id`; `of_case`: the unit's case orders the run.
    fn order_of(
        &mut self,
        (id, of_case): (u64, bool),
        selection: Selection,
        mut how: RunSettings,
        context: &mut PageContext<'_>,
    ) {
        how.operator.clone_from(&context.settings.operator);
        let (Some(suite), Some(loaded_for)) = (self.suite.value(), &self.loaded_for) else {
            return;
        };
        let shown = ShownSuite {
            suite: suite.clone(),
            loaded_for: loaded_for.clone(),
        };
        let Some(unit) = context.units.of_id(id) else {
            return;
        };
        let (choice, serial, connection) = (unit.choice.clone(), unit.name(), unit.connection());
        context.messages.over(About::Run(id));
        let order = context.queries.run(move |paths| {
            let unit = (serial.as_str(), connection);
            prepare::order(paths, &choice, unit, &selection, how, &shown)
        });
        self.orders.push(PendingOrder {
            unit: id,
            of_case,
            order: Request::Pending(order),
        });
    }

    /// Begins the runs whose orders are ready, unless something else has taken the bench meanwhile.
    fn poll_orders(&mut self, context: &mut PageContext<'_>) {
        let words = &context.words.procedures;
        for mut ordered in std::mem::take(&mut self.orders) {
            ordered.order.poll();
            match ordered.order {
                Request::Ready(Prepared::Order(order)) => {
                    let unit = context.units.of_id(ordered.unit);
                    if unit.is_some_and(|unit| unit.begin(*order, ordered.of_case)) {
                        self.shown = ResultsView::default();
                    } else {
                        let run = About::Run(ordered.unit);
                        context
                            .messages
                            .trouble_about(run, words.not_begun, told(""));
                    }
                }
                Request::Ready(Prepared::Changed) => {
                    context.messages.trouble(words.scripts_changed, told(""));
                    self.load(context);
                }
                Request::Failed(why) => {
                    let run = About::Run(ordered.unit);
                    context
                        .messages
                        .trouble_about(run, words.not_begun, why.clone());
                }
                order => self.orders.push(PendingOrder { order, ..ordered }),
            }
        }
    }

    fn run(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        let unit = context.units.chosen();
        let Some(run) = &unit.run else {
            ui.label(words.procedures.choose_and_run);
            return;
        };
        // Only scripts of the same checksum are shown: in other scripts the wrong line would be marked.
        let suite = self.suite.value();
        let texts = suite.filter(|suite| suite.sha256 == run.scripts_sha256);
        let texts = texts.map(|suite| &suite.texts);
        let answer = present::present(ui, words, run, texts, true);
        let note = (&mut self.note, context.settings.operator.as_str());
        results::after_run(ui, (words, context.queries), run, note, context.go_to);
        // The conclusion arrives later; it stands below the note and the buttons, so that these do not move.
        let conclusion = match &self.conclusion {
            Request::Ready(concluded) => Some(concluded.text.as_str()),
            Request::Pending(_) => Some(words.common.loading),
            Request::Idle | Request::Failed(_) => None,
        };
        if let Some(conclusion) = conclusion.filter(|_| self.concluded == run.id()) {
            ui.label(RichText::new(conclusion).strong().size(17.0));
        }
        let traced = self.traced.value().filter(|_| self.concluded == run.id());
        let traced = traced.map(Vec::as_slice).unwrap_or_default();
        let ways = (traced, &mut *context.go_to);
        let unnamed = PartNames::default();
        let named = (words, self.parts.value().unwrap_or(&unnamed));
        results::results(ui, named, run, &mut self.shown, texts, ways);
        if let Some(yes) = answer {
            context.units.chosen_mut().answer(yes);
        }
    }
}

/// Plot of the chosen signals over the last seconds, as on the page Bench.
fn live_signals(ui: &mut Ui, plot: &mut Plot, height: f32, context: &mut PageContext<'_>) {
    let unit = context.units.chosen();
    let seen = BenchSnapshot::of(&unit.bench);
    let plotted = &mut context.settings.plotted;
    let signals = chosen(plotted);
    plot.take(&unit.bench, &signals);
    // A heading height less than the real one would make the panel grow with each frame.
    let heading = Sizes::of(ui).target + LIVE_HEADING;
    let height = height.max(LIVE_LEAST) - heading;
    plot.show(ui, height, &signals, plotted, (context.words, &seen));
}

fn script_errors(ui: &mut Ui, suite: &Suite, context: &PageContext<'_>) {
    let bad = Palette::of(ui).bad;
    let said = context.words.procedures.script_errors;
    ui.label(RichText::new(format!("⚠ {said}")).color(bad).strong());
    ScrollArea::vertical()
        .id_salt("script errors")
        .max_height(160.0)
        .show(ui, |ui| {
            for error in &suite.errors {
                ui.label(RichText::new(error).monospace());
            }
        });
}
