//! The frame around the pages: connection bar, navigation, messages, keys.

mod about;
mod care;
mod connection;
mod keys;
mod lock;
mod lost;
mod messages;
mod navigation;
mod setup;

use eframe::egui::{Align2, Area, Context, Id, Order, RichText, Spinner, Ui};

use super::{PageContext, Palette, Sizes};
use about::About;
use care::Care;
pub use lock::only_look;
use ptu_report::words::Words;
use setup::Setup;

/// What the frame keeps while the window is open.
#[derive(Default)]
pub struct Frame {
    setup: Setup,
    about: About,
    care: Care,
    undo: messages::Undo,
}

impl Frame {
    /// Keys that work on every page.
    pub fn keys(&mut self, ui: &Ui, context: &mut PageContext<'_>) {
        keys::keys(ui.ctx(), context);
    }

    pub fn connection(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        Sizes::of(ui).set(ui);
        connection::bar(ui, context, &mut self.setup);
    }

    pub fn navigation(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        Sizes::of(ui).set(ui);
        navigation::bar(ui, context, (&mut self.about, &mut self.care));
    }

    /// What a locked window says, and the name that opens it.
    pub fn locked(&self, ui: &mut Ui, context: &mut PageContext<'_>) {
        Sizes::of(ui).set(ui);
        lock::bar(ui, context);
    }

    /// A run that broke off with the link, and how it goes on.
    pub fn lost(&self, ui: &mut Ui, goes_on: bool, context: &mut PageContext<'_>) {
        Sizes::of(ui).set(ui);
        lost::row(ui, goes_on, context);
    }

    /// The latest message, and all of them.
    pub fn messages(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        self.undo.poll(context);
        Sizes::of(ui).set(ui);
        messages::bar(ui, context, &mut self.undo);
    }

    /// Over everything while the window is being closed; true once the person has taken note that
    /// outputs were not confirmed safe.
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
            eframe::egui::Frame::popup(ui.style()).show(ui, content);
        });
}
