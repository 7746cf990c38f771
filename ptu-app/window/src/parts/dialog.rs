//! A dialog over the page. The page is dimmed and takes no clicks meanwhile; the bar above stays usable, so that
//! everything can be stopped.

use eframe::egui::{
    Align, Align2, Area, Color32, Context, Frame, Id, Key, Layout, Margin, Rect, RichText,
    ScrollArea, Sense, Stroke, Ui, pos2, vec2,
};

use crate::{Palette, Sizes};

/// Width of a dialog's content, and margin around it, points.
const WIDE: f32 = 520.0;
const AROUND: f32 = 20.0;
/// Radius of a dialog's corners, points; darkness of the page behind, 0 to 255.
const CORNER: u8 = 12;
const DIM: u8 = 150;

/// Shows a dialog; false once it is to be closed.
pub fn dialog(ui: &Ui, name: &str, title: &str, content: impl FnOnce(&mut Ui)) -> bool {
    let sizes = Sizes::of(ui);
    let place = (Align2::CENTER_CENTER, sizes.bar / 2.0, WIDE);
    let (open, ..) = over_page(ui, name, place, |ui| {
        let title = RichText::new(title)
            .size(sizes.title)
            .color(Palette::of(ui).ink);
        ui.label(title);
        ui.add_space(AROUND / 2.0);
        let high =
            ui.ctx().content_rect().height() - sizes.bar - 4.0 * AROUND - ui.min_rect().height();
        let area = ScrollArea::vertical().max_height(high);
        // In the frame in which the area is placed, it offers less room than the dialog takes later.
        let area = area.min_scrolled_height(high);
        area.show(ui, content);
    });
    open
}

/// Shows `content` over the page, `wide` points wide, `lower` points below the place `at`. Returns: Esc was not
/// pressed; the page behind was clicked; what `content` returns.
pub fn over_page<R>(
    ui: &Ui,
    name: &str,
    (at, lower, wide): (Align2, f32, f32),
    content: impl FnOnce(&mut Ui) -> R,
) -> (bool, bool, R) {
    let (context, sizes, palette) = (ui.ctx(), Sizes::of(ui), Palette::of(ui));
    let screen = context.content_rect();
    let page = Rect::from_min_max(pos2(screen.left(), screen.top() + sizes.bar), screen.max);
    let behind = Area::new(Id::unique("behind a dialog").with(name)).fixed_pos(page.min);
    let behind = behind.show(context, |ui| {
        let (_, response) = ui.allocate_exact_size(page.size(), Sense::click_and_drag());
        let dim = Color32::from_black_alpha(DIM);
        ui.painter().rect_filled(page, 0.0, dim);
        response
    });
    let area = Area::new(Id::unique("dialog").with(name));
    let area = area.anchor(at, vec2(0.0, lower));
    let shown = area.show(context, |ui| {
        let frame = Frame::new()
            .fill(palette.raised)
            .stroke(Stroke::new(1.0, palette.edge))
            .corner_radius(CORNER)
            .shadow(ui.visuals().window_shadow)
            .inner_margin(Margin::same(AROUND as i8));
        frame
            .show(ui, |ui| {
                ui.set_width(wide.min(page.width() - 4.0 * AROUND));
                content(ui)
            })
            .inner
    });
    for layer in [behind.response.layer_id, shown.response.layer_id] {
        context.move_to_top(layer);
    }
    let now = context.cumulative_frame_nr();
    context.data_mut(|data| data.insert_temp(id(), now));
    let escaped = ui.input(|input| input.key_pressed(Key::Escape));
    (!escaped, behind.inner.clicked(), shown.inner)
}

/// The last row of a dialog: its buttons from the right end, the main one first.
pub fn last_row(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    ui.add_space(AROUND / 2.0);
    let size = vec2(ui.available_width(), Sizes::of(ui).target);
    let ends = Layout::right_to_left(Align::Center);
    ui.allocate_ui_with_layout(size, ends, content);
}

/// Whether a dialog is open, or was in the previous frame.
pub fn dialog_is_open(context: &Context) -> bool {
    let shown = context.data(|data| data.get_temp::<u64>(id()));
    shown.is_some_and(|shown| shown + 1 >= context.cumulative_frame_nr())
}

fn id() -> Id {
    Id::unique("dialog shown")
}
