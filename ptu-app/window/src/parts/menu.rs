//! Menus of a page: open until something beside them is clicked.

use eframe::egui::{Popup, PopupCloseBehavior, Ui};
use egui_material_icons::icons::ICON_MORE_VERT;

use super::{Face, Look};

/// A button and its menu; what came of what is in it.
pub fn menu<R>(ui: &mut Ui, face: &Face<'_>, content: impl FnOnce(&mut Ui) -> R) -> Option<R> {
    let menu = Popup::menu(&face.show(ui));
    let menu = menu.close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    menu.show(content).map(|shown| shown.inner)
}

/// A menu of seldom used acts, behind a button with three points and this name.
pub fn more<R>(ui: &mut Ui, name: &str, content: impl FnOnce(&mut Ui) -> R) -> Option<R> {
    menu(ui, &points().named(name).hint(name), content)
}

/// Width of a field that has the three points at its right.
pub fn before_more(ui: &Ui) -> f32 {
    ui.available_width() - points().wide(ui) - 3.0 * ui.spacing().item_spacing.x
}

fn points() -> Face<'static> {
    Face::new(Look::Quiet, "").icon(ICON_MORE_VERT)
}
