//! Procedures: choose, run, look on.

mod controls;
mod overview;
mod prepare;
mod present;
mod results;
mod selection;
mod tree;

use btu_rig::procedure::plan::Connection;
use eframe::egui::{CentralPanel, Panel, RichText, ScrollArea, Ui};

use crate::diagnosis::diagnose_run;
use crate::gui::library::Asked;
use crate::gui::parts::RunNoteForm;
use crate::gui::{Desk, Palette, UnitChoice};
use crate::run::Suite;
use crate::station::Phase;
use prepare::{How, Prepared};
use results::Shown;
use selection::Selection;

/// The page.
pub struct ProceduresPage {
    suite: Asked<Suite>,
    /// What the suite was loaded for.
    loaded_for: Option<UnitChoice>,
    /// Nothing = everything but what is on request.
    selection: Option<Selection>,
    find: String,
    repeat: u32,
    stop_on_fail: bool,
    /// An order that is being made, for the unit at this place.
    order: Vec<(usize, Asked<Prepared>)>,
    /// A step to run as soon as the suite is there.
    wanted: Option<(String, Option<String>)>,
    shown: Shown,
    /// What the last run comes to, by run.
    conclusion: Asked<String>,
    concluded: Option<fault_db::Id>,
    note: RunNoteForm,
}

impl Default for ProceduresPage {
    fn default() -> Self {
        Self {
            suite: Asked::Not,
            loaded_for: None,
            selection: None,
            find: String::new(),
            repeat: 1,
            stop_on_fail: false,
            order: Vec::new(),
            wanted: None,
            shown: Shown::default(),
            conclusion: Asked::Not,
            concluded: None,
            note: RunNoteForm::default(),
        }
    }
}

impl ProceduresPage {
    /// Shows it.
    pub fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        self.keep_loaded(desk);
        self.poll(desk);
        Panel::left("procedures")
            .default_size(380.0)
            .size_range(260.0..=640.0)
            .show(ui, |ui| self.tree(ui, desk));
        CentralPanel::default().show(ui, |ui| {
            self.controls(ui, desk);
            overview::overview(ui, desk);
            ui.separator();
            if let Asked::There(suite) = &self.suite
                && !suite.errors.is_empty()
            {
                script_errors(ui, suite, desk);
            }
            self.run(ui, desk);
        });
    }

    /// Runs this step, or all of a procedure, on the chosen unit.
    pub fn run_step(&mut self, procedure: &str, step: Option<&str>, desk: &mut Desk<'_>) {
        if desk.units.chosen().phase() != Phase::Idle {
            desk.messages
                .trouble(desk.words.procedures.connect_first, "");
        }
        self.wanted = Some((procedure.to_owned(), step.map(str::to_owned)));
        self.keep_loaded(desk);
    }

    /// Scripts are loaded for the unit's configuration, line and train: anew when these change.
    fn keep_loaded(&mut self, desk: &Desk<'_>) {
        let choice = &desk.units.chosen().choice;
        let same = self.loaded_for.as_ref().is_some_and(|loaded| {
            loaded.unit_config == choice.unit_config
                && loaded.line == choice.line
                && loaded.train == choice.train
        });
        if !same {
            self.load(desk);
        }
    }

    fn load(&mut self, desk: &Desk<'_>) {
        let choice = desk.units.chosen().choice.clone();
        self.loaded_for = Some(choice.clone());
        self.suite = Asked::Pending(desk.library.ask(move |shelf| prepare::load(shelf, &choice)));
    }

    fn poll(&mut self, desk: &mut Desk<'_>) {
        if self.suite.poll()
            && let Asked::Failed(why) = &self.suite
        {
            let said = desk.words.procedures.not_loaded;
            desk.messages.trouble(said, why.clone());
        }
        self.run_wanted(desk);
        self.note.poll(desk.words, desk.messages);
        self.poll_orders(desk);
        self.conclude(desk);
    }

    /// Runs the step another page asked for, once the suite is there.
    fn run_wanted(&mut self, desk: &mut Desk<'_>) {
        let Some(suite) = self.suite.value() else {
            return;
        };
        let Some((procedure, step)) = self.wanted.take() else {
            return;
        };
        let found = suite.procedures.iter().find(|known| known.id == procedure);
        let only = found.map(|found| Selection::only(found, step.as_deref()));
        let Some(only) = only.filter(|only| only.extent(&suite.procedures).0 > 0) else {
            let what = format!("{procedure} {}", step.unwrap_or_default());
            desk.messages
                .trouble(desk.words.procedures.no_such_step, what);
            return;
        };
        self.selection = Some(only);
        if desk.units.chosen().phase() == Phase::Idle {
            self.order(desk.units.chosen_place(), false, desk);
        }
    }

    /// What is chosen, or would be run without a choice.
    fn chosen(&self, connection: Connection) -> Selection {
        let usual = || {
            let suite = self.suite.value();
            suite.map(|suite| Selection::usual(&suite.procedures, connection))
        };
        let chosen = self.selection.clone().or_else(usual);
        chosen.unwrap_or_default()
    }

    /// Has an order made for the unit at this place.
    fn order(&mut self, place: usize, adaptive: bool, desk: &Desk<'_>) {
        let Some(unit) = desk.units.iter().nth(place) else {
            return;
        };
        let Some(shown) = self.suite.value().map(|suite| suite.sha256.clone()) else {
            return;
        };
        let how = How {
            operator: desk.settings.operator.clone(),
            repeat: if adaptive { 1 } else { self.repeat },
            stop_on_fail: !adaptive && self.stop_on_fail,
            adaptive,
        };
        let selection = self.chosen(unit.choice.connection());
        let (choice, serial) = (unit.choice.clone(), unit.name());
        let order = desk
            .library
            .ask(move |shelf| prepare::order(shelf, &choice, &serial, &selection, how, &shown));
        self.order.push((place, Asked::Pending(order)));
    }

    fn poll_orders(&mut self, desk: &mut Desk<'_>) {
        let words = &desk.words.procedures;
        for (place, mut order) in std::mem::take(&mut self.order) {
            order.poll();
            match order {
                Asked::There(Prepared::Order(order)) => {
                    if let Some(unit) = desk.units.iter_mut().nth(place) {
                        unit.begin(*order);
                    }
                    self.shown = Shown::default();
                }
                Asked::There(Prepared::Changed(suite)) => {
                    let said = if suite.errors.is_empty() {
                        words.scripts_changed
                    } else {
                        words.script_errors
                    };
                    desk.messages.trouble(said, "");
                    self.suite = Asked::There(*suite);
                }
                Asked::Failed(why) => desk.messages.trouble(words.not_begun, why),
                waiting => self.order.push((place, waiting)),
            }
        }
    }

    /// Asks what a run that did not pass comes to.
    fn conclude(&mut self, desk: &Desk<'_>) {
        self.conclusion.poll();
        let run = desk.units.chosen().run.as_ref();
        let Some(outcome) = run.and_then(|run| run.ended.as_ref()?.as_ref()) else {
            return;
        };
        if self.concluded == Some(outcome.id) {
            return;
        }
        self.concluded = Some(outcome.id);
        let id = outcome.id;
        self.conclusion = match outcome.exit {
            crate::failure::Exit::Failed => Asked::Pending(desk.library.ask(move |shelf| {
                let answer = diagnose_run(&shelf.read()?, &shelf.scripts, id)?;
                Ok(answer.diagnosis.conclusion)
            })),
            _ => Asked::Not,
        };
    }

    fn run(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        let words = desk.words;
        let texts = self.suite.value().map(|suite| &suite.texts);
        let unit = desk.units.chosen();
        let Some(run) = &unit.run else {
            ui.label(words.procedures.choose_and_run);
            return;
        };
        let board = unit.station.board();
        present::present(ui, words, run, board, texts);
        if let Some(conclusion) = self.conclusion.value().filter(|_| !run.is_running()) {
            ui.label(RichText::new(conclusion).strong().size(17.0));
        }
        let note = (&mut self.note, desk.settings.operator.as_str());
        results::after_run(ui, (words, desk.library), run, note, desk.go);
        results::results(ui, words, run, &mut self.shown, texts);
    }
}

fn script_errors(ui: &mut Ui, suite: &Suite, desk: &Desk<'_>) {
    let bad = Palette::of(ui).bad;
    let said = desk.words.procedures.script_errors;
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
