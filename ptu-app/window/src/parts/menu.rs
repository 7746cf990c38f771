//! Menus of a page; a menu stays open until a click outside it.

use eframe::egui::{Popup, PopupCloseBehavior, Ui};
use egui_material_icons::icons::ICON_MORE_VERT;

use super::{Face, Look};

/// A button and its menu; returns the result of `content` while the menu is open.
pub fn menu<R>(ui: &mut Ui, face: &Face<'_>, content: impl FnOnce(&mut Ui) -> R) -> Option<R> {
    let menu = Popup::menu(&face.show(ui));
    let menu = menu.close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    menu.show(content).map(|shown| shown.inner)
}

/// A menu of seldom used actions, behind a button with three dots and this name.
pub fn more<R>(ui: &mut Ui, name: &str, content: impl FnOnce(&mut Ui) -> R) -> Option<R> {
    menu(ui, &points().named(name).hint(name), content)
}

/// Width of a field that has the button with three dots at its right.
pub fn before_more(ui: &Ui) -> f32 {
    ui.available_width() - points().wide(ui) - 3.0 * ui.spacing().item_spacing.x
}

fn points() -> Face<'static> {
    Face::new(Look::Quiet, "").icon(ICON_MORE_VERT)
}
