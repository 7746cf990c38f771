//! The rail of the pages: an icon, the key and the name of each; below them the history and the menu.

use crate::parts::selectable;
use eframe::egui::{
    Align, Align2, FontId, Layout, Popup, Rect, RectAlign, Response, Ui, pos2, vec2,
};
use egui_material_icons::MaterialIcon;
use egui_material_icons::icons::{
    ICON_ASSIGNMENT, ICON_BAR_CHART, ICON_CHECKLIST, ICON_DATABASE, ICON_DESCRIPTION,
    ICON_GRAPHIC_EQ, ICON_MENU, ICON_REPORT, ICON_SHOW_CHART, ICON_SPEED, ICON_TRAIN,
    ICON_TROUBLESHOOT,
};

use super::menu;
use crate::{Density, Destination, Page, PageContext, Palette, Sizes};

/// Least width of a window whose rail has names beside the icons, and width of that rail, points.
const WIDE: [f32; 2] = [1600.0, 200.0];
/// Gap between two entries of the rail, points.
const GAP: f32 = 1.0;

/// A page, the history or the menu in the rail.
struct RailEntry<'a> {
    icon: MaterialIcon,
    key: &'a str,
    name: &'a str,
    chosen: bool,
}

/// Width of the rail, points.
pub fn wide(ui: &Ui) -> f32 {
    match Sizes::of(ui).density {
        _ if ui.ctx().content_rect().width() >= WIDE[0] => WIDE[1],
        Density::Operator => 80.0,
        Density::Engineer => 76.0,
    }
}

pub fn rail(ui: &mut Ui, context: &mut PageContext<'_>) {
    ui.spacing_mut().item_spacing.y = GAP;
    let usual = match Sizes::of(ui).density {
        Density::Operator => 56.0,
        Density::Engineer => 46.0,
    };
    let all = Page::ALL.len() as f32 + 2.0;
    // In a low window the rail has no entry for the history; the menu has it.
    let is_low = ui.available_height() < all * (usual + GAP);
    let all = all - f32::from(u8::from(is_low));
    let high = (ui.available_height() / all - GAP).floor().min(usual);
    for page in Page::ALL {
        let place = RailEntry {
            icon: icon(page),
            key: page.key(),
            name: page.name(context.words),
            chosen: context.settings.page == page,
        };
        if shown(ui, high, &place).clicked() {
            context.settings.page = page;
        }
    }
    let other = |icon, name| RailEntry {
        icon,
        key: "",
        name,
        chosen: false,
    };
    ui.with_layout(Layout::bottom_up(Align::Min), |ui| {
        let menu = shown(ui, high, &other(ICON_MENU, context.words.frame.menu));
        let popup = Popup::menu(&menu).align(RectAlign::RIGHT_END);
        let popup = popup.close_behavior(eframe::egui::PopupCloseBehavior::CloseOnClickOutside);
        popup.show(|ui| menu::menu(is_low, ui, context));
        let history = other(ICON_DATABASE, context.words.care.title);
        if !is_low && shown(ui, high, &history).clicked() {
            context.go_to.push(Destination::History);
        }
    });
}

fn shown(ui: &mut Ui, high: f32, place: &RailEntry<'_>) -> Response {
    let (palette, sizes) = (Palette::of(ui), Sizes::of(ui));
    let size = vec2(ui.available_width(), high);
    let (rect, response) = selectable(ui, size, (place.name, place.chosen));
    let (icon, ink) = match place.chosen {
        true => (palette.accent, palette.ink),
        false => (palette.second, palette.second),
    };
    let painter = ui.painter();
    if place.chosen {
        let at = Rect::from_x_y_ranges(rect.left() - 4.0..=rect.left() - 1.0, rect.y_range());
        let painter = painter.with_clip_rect(at);
        painter.rect_filled(at.shrink2(vec2(0.0, 4.0)), 0.0, palette.accent);
    }
    let draw = |x, y, align: Align2, text: &str, font, colour| {
        painter.text(pos2(x, y), align, text, font, colour).right()
    };
    let (left, centre) = (Align2::LEFT_CENTER, Align2::CENTER_CENTER);
    let of_icon = FontId::new(sizes.icon, place.icon.font_family());
    let [body, caption, small] = [sizes.body, 12.0, 11.0].map(FontId::proportional);
    let (top, middle, sign) = (rect.top(), rect.center(), place.icon.codepoint);
    let (key, quiet) = (place.key, palette.quiet);
    if rect.width() > 100.0 {
        let x = rect.left() + 12.0;
        let x = draw(x, middle.y, left, sign, of_icon, icon) + 12.0;
        draw(x, middle.y, left, place.name, body, ink);
        let x = rect.right() - 8.0;
        draw(x, middle.y, Align2::RIGHT_CENTER, key, caption, quiet);
    } else if high >= 2.0 * 12.0 + sizes.icon {
        // Icon and key in one line, the name below.
        let y = top + high * 0.34;
        let shift = if key.is_empty() { 0.0 } else { 11.0 };
        let x = draw(middle.x - shift, y, centre, sign, of_icon, icon) + 4.0;
        draw(x, y, left, key, small, quiet);
        let y = top + high * 0.74;
        draw(middle.x, y, centre, place.name, caption, ink);
    } else {
        let y = top + high * if key.is_empty() { 0.5 } else { 0.34 };
        draw(middle.x, y, centre, sign, of_icon, icon);
        draw(middle.x, top + high * 0.8, centre, key, small, quiet);
    }
    response.on_hover_text(place.name)
}

pub fn icon(page: Page) -> MaterialIcon {
    match page {
        Page::Case => ICON_ASSIGNMENT,
        Page::Bench => ICON_SPEED,
        Page::Procedures => ICON_CHECKLIST,
        Page::Traces => ICON_SHOW_CHART,
        Page::Faults => ICON_REPORT,
        Page::Diagnosis => ICON_TROUBLESHOOT,
        Page::Report => ICON_DESCRIPTION,
        Page::Statistics => ICON_BAR_CHART,
        Page::Drive => ICON_TRAIN,
        Page::Signals => ICON_GRAPHIC_EQ,
    }
}
