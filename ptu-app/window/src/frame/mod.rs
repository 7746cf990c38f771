//! The frame around the pages: bar of the unit, rail of the pages, messages, dialogs, keys.

mod about;
mod bar;
mod care;
mod find;
mod keys;
mod lock;
mod lost;
mod menu;
mod messages;
mod rail;
mod setup;
mod unit_menu;

use std::sync::Arc;

use btu_rig::procedure::Procedure;
use eframe::egui::{
    Align2, Area, Context, Frame as Ground, Id, Key, Margin, Modifiers, Order, Panel, RichText,
    Spinner, Ui, vec2,
};

use super::{Destination, Page, PageContext, Palette, Sizes};
use crate::pages::case_steps;
use crate::parts::{FORM, dialog_is_open};
use about::About;
use care::HistoryMaintenance;
use find::Find;
pub use lock::only_look;
use ptu_report::words::Words;
use setup::Setup;

/// Gap between the messages and the edges of the page, points.
const AROUND: f32 = 12.0;

/// State of the frame while the window is open.
#[derive(Default)]
pub struct Frame {
    setup: Setup,
    about: About,
    care: HistoryMaintenance,
    undo: messages::Undo,
    pub find: Find,
    is_wide: bool,
}

impl Frame {
    /// Keys that work on every page.
    pub fn keys(&mut self, ui: &Ui, context: &mut PageContext<'_>) {
        keys::keys(ui.ctx(), context);
        let key = |key| ui.input_mut(|input| input.consume_key(Modifiers::COMMAND, key));
        if key(Key::K) && (self.find.open || !dialog_is_open(ui.ctx())) {
            self.find.toggle(context);
        }
        self.is_wide ^= key(Key::B);
    }

    /// Draws bar and rail; the rest of `ui` is for the page, and disabled while a dialog is open.
    pub fn around(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let (palette, sizes) = (Palette::of(ui), Sizes::of(ui));
        let ground = Ground::new().fill(palette.panel);
        let bar = Panel::top("bar").exact_size(sizes.bar).resizable(false);
        bar.frame(ground.inner_margin(Margin::symmetric(8, 0)))
            .show(ui, |ui| bar::bar(&mut self.find, ui, context));
        if dialog_is_open(ui.ctx()) {
            // The page is not greyed: the dialog dims it already.
            ui.visuals_mut().disabled_alpha = 1.0;
            ui.disable();
        }
        if self.is_wide {
            return;
        }
        let rail = Panel::left("rail")
            .exact_size(rail::wide(ui))
            .resizable(false);
        rail.frame(ground.inner_margin(4))
            .show(ui, |ui| rail::rail(ui, context));
    }

    /// Opens the dialog that this destination names, if it is one.
    pub fn go_to(&mut self, to: &Destination) {
        match to {
            Destination::Setup => self.setup.open(),
            Destination::History => self.care.open(),
            Destination::About => self.about.open(),
            _ => {}
        }
    }

    /// Bar of a locked window, with the field for the name that unlocks the window.
    pub fn locked(&self, ui: &mut Ui, context: &mut PageContext<'_>) {
        lock::bar(ui, context);
    }

    /// Row about a run that broke off when the link was lost, with the button to continue the run.
    pub fn lost(&self, ui: &mut Ui, goes_on: bool, context: &mut PageContext<'_>) {
        lost::row(ui, goes_on, context);
    }

    /// Shows messages and open dialogs over the page.
    pub fn over(&mut self, ui: &Ui, procedures: &[Arc<Procedure>], context: &mut PageContext<'_>) {
        self.undo.poll(context);
        // Messages cover neither steps and foot of a case, nor the foot of a form.
        let wide = ui.ctx().content_rect().width();
        let (left, below) = match context.settings.page {
            Page::Case => (case_steps(wide), Sizes::of(ui).footer),
            Page::Drive | Page::Signals => (FORM, 0.0),
            _ => (0.0, 0.0),
        };
        let rail = if self.is_wide { 0.0 } else { rail::wide(ui) };
        let at = vec2(rail + left + AROUND, -below - AROUND);
        messages::toasts(ui, at, context, &mut self.undo);
        self.setup.show(ui, context);
        self.care.show(ui, context);
        self.about.show(ui, context);
        self.find.show(ui, procedures, context);
    }

    /// Shows, over everything, that the window is being closed; true once the person has taken note
    /// that outputs were not confirmed safe.
    pub fn closing(&self, ui: &mut Ui, words: &Words, not_safe: bool) -> bool {
        let mut noted = false;
        over_everything(ui.ctx(), |ui| {
            if not_safe {
                let bad = Palette::of(ui).bad;
                let said = format!("⚠ {}", words.frame.not_safe);
                ui.label(RichText::new(said).color(bad).heading());
                noted = ui.button(words.frame.close_anyway).clicked();
                return;
            }
            ui.horizontal(|ui| {
                ui.add(Spinner::new());
                ui.label(RichText::new(words.frame.closing).heading());
            });
        });
        noted
    }
}

fn over_everything(context: &Context, content: impl FnOnce(&mut Ui)) {
    Area::new(Id::unique("over everything"))
        .order(Order::Foreground)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .show(context, |ui| {
            Ground::popup(ui.style()).show(ui, content);
        });
}
