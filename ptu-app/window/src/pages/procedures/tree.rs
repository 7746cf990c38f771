//! The tree of scripts and steps.

use std::sync::Arc;

use btu_rig::procedure::Procedure;
use btu_rig::procedure::plan::Connection;
use eframe::egui::{
    Align, Checkbox, Label, Layout, Response, RichText, ScrollArea, TextWrapMode, Ui,
    collapsing_header,
};

use super::ProceduresPage;
use super::selection::{Selection, Share, possible};
use crate::parts::{before_more, find_edit, more};
use crate::request::Request;
use crate::{PageContext, Palette};
use ptu_report::words::{Words, fill};

/// Action on the whole tree.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Choice {
    All,
    None,
    Reload,
}

impl ProceduresPage {
    pub(super) fn tree(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        let said = &words.procedures;
        let mut choice = None;
        ui.horizontal(|ui| {
            let wide = before_more(ui);
            find_edit(ui, &mut self.find, said.find, wide);
            let all = [
                (Choice::Reload, said.reload),
                (Choice::All, said.all),
                (Choice::None, said.none),
            ];
            // Before the procedures are loaded, only reloading is offered.
            let offered = match self.suite {
                Request::Ready(_) => &all[..],
                _ => &all[..1],
            };
            choice = more(ui, said.choice, |ui| {
                let clicked = |(_, name): &&(Choice, &str)| ui.button(*name).clicked();
                let (choice, _) = offered.iter().filter(clicked).last()?;
                ui.close();
                Some(*choice)
            });
        });
        let choice = choice.flatten();
        if choice == Some(Choice::Reload) {
            self.load(context);
        }
        let Some(suite) = self.suite.shown(ui, words) else {
            return;
        };
        let connection = context.units.chosen().connection();
        let before = self.chosen(connection);
        let mut chosen = before.clone();
        match choice {
            Some(Choice::All) => chosen = Selection::usual(&suite.procedures, connection),
            Some(Choice::None) => chosen = Selection::default(),
            Some(Choice::Reload) | None => {}
        }
        let (steps, time) = chosen.extent(&suite.procedures);
        let time = minutes(time.as_secs());
        let said = fill(
            words.procedures.chosen,
            &[("steps", &steps), ("time", &time)],
        );
        ui.label(RichText::new(said).color(Palette::of(ui).quiet));
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.style_mut().wrap_mode = Some(TextWrapMode::Truncate);
            for (folder, procedures) in folders(&suite.procedures) {
                let found = procedures.iter().filter(|known| matches(known, &self.find));
                let found: Vec<_> = found.collect();
                show_folder(ui, words, folder, &found, connection, &mut chosen);
            }
        });
        if chosen != before {
            self.selection = Some(chosen);
        }
    }
}

fn show_folder(
    ui: &mut Ui,
    words: &Words,
    folder: &str,
    found: &[&Arc<Procedure>],
    connection: Connection,
    chosen: &mut Selection,
) {
    if found.is_empty() {
        return;
    }
    let can = || {
        found
            .iter()
            .copied()
            .filter(|known| possible(known, connection))
    };
    let share = chosen.share_of(can());
    let id = ui.make_persistent_id(("folder", folder));
    collapsing_header::CollapsingState::load_with_default_open(ui.ctx(), id, true)
        .show_header(ui, |ui| {
            let name = RichText::new(words.procedures.folder(folder)).strong();
            if tick(ui, share, name).on_hover_text(folder).clicked() {
                for procedure in can() {
                    chosen.set(procedure, share != Share::All && !procedure.on_request);
                }
            }
        })
        .body(|ui| {
            for procedure in found {
                match possible(procedure, connection) {
                    true => show_procedure(ui, words, procedure, chosen),
                    false => show_skipped(ui, words, procedure),
                }
            }
        });
}

/// Shows a procedure that needs a harness, which this connection lacks: it would be skipped.
fn show_skipped(ui: &mut Ui, words: &Words, procedure: &Procedure) {
    let said = format!("{}: {}", words.title(procedure), words.common.skipped);
    let text = RichText::new(said);
    let label = ui.add_enabled(false, Label::new(text));
    label.on_disabled_hover_text(format!(
        "{}. {}",
        procedure.id, words.procedures.needs_harness
    ));
}

fn show_procedure(ui: &mut Ui, words: &Words, procedure: &Procedure, chosen: &mut Selection) {
    let share = chosen.share(procedure);
    let id = ui.make_persistent_id(&procedure.id);
    collapsing_header::CollapsingState::load_with_default_open(ui.ctx(), id, false)
        .show_header(ui, |ui| {
            // "On request" stands at the right end; a long title is cut before it.
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if procedure.on_request {
                    let said = RichText::new(words.procedures.on_request).small();
                    ui.label(said.color(Palette::of(ui).quiet));
                }
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    let response = tick(ui, share, RichText::new(words.title(procedure)));
                    if response.on_hover_text(&procedure.id).clicked() {
                        chosen.set(procedure, share != Share::All);
                    }
                });
            });
        })
        .body(|ui| {
            ui.label(RichText::new(&procedure.id).italics());
            for (place, step) in procedure.steps.iter().enumerate() {
                let mut on = chosen.has(procedure, place);
                let response = ui.checkbox(&mut on, &*words.content(&step.name));
                let changed = response.changed();
                if let Some(note) = &step.note {
                    response.on_hover_text(&*words.content(note));
                }
                if changed {
                    chosen.set_step(procedure, place, on);
                }
            }
        });
}

/// A checkbox with a third state: chosen in part.
fn tick(ui: &mut Ui, share: Share, text: RichText) -> Response {
    let mut on = share == Share::All;
    ui.add(Checkbox::new(&mut on, text).indeterminate(share == Share::Some))
}

fn matches(procedure: &Procedure, find: &str) -> bool {
    let find = find.trim().to_lowercase();
    let has = |text: &str| text.to_lowercase().contains(&find);
    has(&procedure.id)
        || has(&procedure.title)
        || procedure.title_ko.as_deref().is_some_and(has)
        || procedure.steps.iter().any(|step| has(&step.name))
}

/// Seconds as minutes and seconds, like `3:07`.
pub fn minutes(seconds: f64) -> String {
    let seconds = seconds.round().max(0.0) as u64;
    format!("{}:{:02}", seconds / 60, seconds % 60)
}

/// Procedures by their folder, in order.
fn folders(procedures: &[Arc<Procedure>]) -> Vec<(&str, &[Arc<Procedure>])> {
    let folder = |procedure: &Arc<Procedure>| procedure.id.rfind('/').unwrap_or(0);
    let name = |procedure: &'_ Arc<Procedure>| procedure.id[..folder(procedure)].to_owned();
    procedures
        .chunk_by(|a, b| name(a) == name(b))
        .filter_map(|chunk| {
            chunk
                .first()
                .map(|first| (&first.id[..folder(first)], chunk))
        })
        .collect()
}
