//! Side panels of a page: a list, a form, a strip. In a narrow window lists and strips are drawers.

use eframe::egui::{Align2, Frame, Margin, Panel, Rangef, Ui};
use egui_material_icons::icons::ICON_MENU_OPEN;

use super::{Face, Look, over_page};
use crate::{Palette, Sizes};

/// Window width below which side panels are drawers, and from which on they are wider, points.
const BESIDE: f32 = 1100.0;
const WIDE: f32 = 1600.0;
/// Width of a form, points.
pub const FORM: f32 = 268.0;
/// Least width of a side panel, and of the page beside it, points.
const LEAST: f32 = 200.0;
const LEFT: f32 = 440.0;
/// Gap below the content of a drawer, points.
const BELOW: f32 = 24.0;

/// Side panel of a page; its divider can be dragged.
pub struct Side<'a> {
    /// Name of the list, form or strip, and text of the button that opens its drawer.
    pub name: &'a str,
    /// Width until the divider is dragged, and the width in a wide window, points.
    pub wide: [f32; 2],
    pub at_right: bool,
}

impl Side<'_> {
    /// The window is so narrow that the list is a drawer.
    pub fn is_narrow(ui: &Ui) -> bool {
        ui.ctx().content_rect().width() < BESIDE
    }

    /// Shows a side panel whose drawer stays open after a click in it.
    pub fn show_open(&self, ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
        let _: Option<()> = self.show(ui, |ui| {
            content(ui);
            None
        });
    }

    /// Shows the side panel, or the button that opens its drawer; returns what was chosen, which closes the drawer.
    pub fn show<R>(&self, ui: &mut Ui, content: impl FnOnce(&mut Ui) -> Option<R>) -> Option<R> {
        if !Self::is_narrow(ui) {
            let most = (ui.available_width() - LEFT).max(LEAST);
            let range = Rangef::new(LEAST, most);
            let is_wide = ui.ctx().content_rect().width() >= WIDE;
            let wide = range.clamp(self.wide[usize::from(is_wide)]);
            let name = format!("{} {is_wide}", self.name);
            let panel = match self.at_right {
                true => Panel::right(name),
                false => Panel::left(name),
            };
            let panel = panel.default_size(wide).size_range(range);
            let shown = panel.frame(ground(ui)).show(ui, |ui| {
                // The panel keeps its size, whatever is in it.
                ui.set_min_size(ui.available_size());
                content(ui)
            });
            return shown.inner;
        }
        let id = ui.scope_id().with(("drawer", self.name));
        let above = Panel::top(format!("{} above", self.name)).resizable(false);
        let open = Face::new(Look::Quiet, self.name).icon(ICON_MENU_OPEN);
        let clicked = above.show(ui, |ui| open.show(ui).clicked()).inner;
        if !clicked && ui.data(|data| data.get_temp(id)) != Some(true) {
            return None;
        }
        let at = match self.at_right {
            true => Align2::RIGHT_TOP,
            false => Align2::LEFT_TOP,
        };
        let place = (at, Sizes::of(ui).bar, self.wide[0]);
        let (stays, beside, chosen) = over_page(ui, self.name, place, |ui| {
            let high = ui.ctx().content_rect().bottom() - ui.cursor().top() - BELOW;
            ui.set_height(high);
            content(ui)
        });
        let stays = stays && chosen.is_none() && (clicked || !beside);
        ui.data_mut(|data| data.insert_temp(id, stays));
        chosen
    }
}

/// A form at the left of a page.
pub fn form<R>(ui: &mut Ui, name: &str, content: impl FnOnce(&mut Ui) -> R) -> R {
    let panel = Panel::left(name.to_owned()).resizable(false);
    let panel = panel.exact_size(FORM).frame(ground(ui));
    panel.show(ui, content).inner
}

/// Main button of a form or a strip, below the part that scrolls.
pub fn foot<R>(ui: &mut Ui, name: &str, content: impl FnOnce(&mut Ui) -> R) -> R {
    let panel = Panel::bottom(name.to_owned()).resizable(false);
    let frame = Frame::new().inner_margin(Margin::symmetric(0, 8));
    panel.frame(frame).show(ui, content).inner
}

fn ground(ui: &Ui) -> Frame {
    let frame = Frame::new().fill(Palette::of(ui).panel);
    frame.inner_margin(Margin::symmetric(12, 8))
}
