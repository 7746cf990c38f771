//! A table: a heading, and rows of one line each, of which only those in view are drawn. The whole row can be clicked;
//! arrow keys move, Enter opens.

use crate::parts::selectable;
use std::borrow::Cow;
use std::ops::Range;

use btu_rig::procedure::Measurement;
use eframe::egui::text::{LayoutJob, TextWrapping};
use eframe::egui::{Color32, FontId, Rect, Response, ScrollArea, Sense, Stroke, Ui, pos2, vec2};
use egui_material_icons::MaterialIcon;

use super::limits_within;
use crate::{Palette, Sizes};

/// Gap between two columns, points.
const GAP: f32 = 12.0;
/// Height of a row of a dense page, points.
const HIGH: f32 = 30.0;

pub struct Column<'a> {
    pub name: &'a str,
    /// Width in an engineer's window, points; 0 = the width that the other columns leave.
    pub wide: f32,
    /// The column holds numbers, aligned right.
    pub right: bool,
    /// Least width of a table that shows this column, points.
    pub from: f32,
}

/// Content of one cell.
pub enum Cell<'a> {
    Text(Cow<'a, str>, Color32),
    /// Coloured text over all columns that follow.
    Rest(Cow<'a, str>, Color32),
    State(MaterialIcon, &'a str, Color32),
    Limits(&'a Measurement),
}

pub struct Table<'a> {
    pub columns: &'a [Column<'a>],
    /// Width kept free at the right end of each row for a button, points.
    pub end: f32,
}

impl<'a> Column<'a> {
    pub fn new(name: &'a str, wide: f32) -> Self {
        Self {
            name,
            wide,
            right: false,
            from: 0.0,
        }
    }

    pub fn right(self) -> Self {
        Self {
            right: true,
            ..self
        }
    }

    pub fn from(self, from: f32) -> Self {
        Self { from, ..self }
    }
}

impl Table<'_> {
    /// Height of a row, points.
    pub fn high(ui: &Ui) -> f32 {
        Sizes::of(ui).target.max(HIGH)
    }

    /// Draws the heading, and below it `count` rows that scroll.
    pub fn scrolled(&self, ui: &mut Ui, count: usize, show: impl FnOnce(&mut Ui, Range<usize>)) {
        ui.spacing_mut().item_spacing.y = 0.0;
        let bar = ui.spacing().scroll.allocated_width();
        self.head(ui, bar);
        let area = ScrollArea::vertical().auto_shrink(false);
        area.show_rows(ui, Self::high(ui), count, show);
    }

    /// Draws the names of the columns; `narrower` is left free at the right end, points.
    pub fn head(&self, ui: &mut Ui, narrower: f32) {
        let (palette, sizes) = (Palette::of(ui), Sizes::of(ui));
        let size = vec2(ui.available_width(), 2.0 * sizes.caption);
        let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
        ui.painter().rect_filled(rect, 0.0, palette.panel);
        let within = rect.with_max_x(rect.right() - narrower - self.end);
        for (column, place) in self.columns.iter().zip(self.places(ui, within)) {
            if let Some(place) = place {
                let said = (column.name, sizes.caption, palette.quiet);
                text(ui, place, column.right, said);
            }
        }
    }

    pub fn row(&self, ui: &mut Ui, (name, chosen): (&str, bool), cells: &[Cell<'_>]) -> Response {
        let (palette, sizes) = (Palette::of(ui), Sizes::of(ui));
        let size = vec2(ui.available_width() - self.end, Self::high(ui));
        let (rect, response) = selectable(ui, size, (name, chosen));
        if !ui.is_rect_visible(rect) {
            return response;
        }
        let line = Stroke::new(1.0, palette.grid);
        ui.painter()
            .hline(rect.x_range(), rect.bottom() - 0.5, line);
        let columns = self.columns.iter().zip(self.places(ui, rect));
        for (cell, (column, place)) in cells.iter().zip(columns) {
            let Some(place) = place else { continue };
            match cell {
                Cell::Text(said, ink) => text(ui, place, column.right, (said, sizes.body, *ink)),
                Cell::Rest(said, ink) => {
                    let place = place.with_max_x(rect.right() - GAP);
                    text(ui, place, false, (said, sizes.body, *ink));
                }
                Cell::State(icon, said, ink) => {
                    let font = FontId::new(sizes.icon, icon.font_family());
                    let sign = ui
                        .painter()
                        .layout_no_wrap(icon.codepoint.into(), font, *ink);
                    let at = pos2(place.left(), place.center().y - sign.size().y / 2.0);
                    let after = place.with_min_x(at.x + sign.size().x + GAP / 2.0);
                    ui.painter().galley(at, sign, *ink);
                    text(ui, after, false, (said, sizes.body, *ink));
                }
                Cell::Limits(measured) => {
                    let bar = Rect::from_center_size(place.center(), vec2(place.width(), 14.0));
                    limits_within(ui, bar, measured);
                }
            }
        }
        response
    }

    /// Areas of the columns in a row; none for a column that a row of this width does not show.
    fn places(&self, ui: &Ui, row: Rect) -> Vec<Option<Rect>> {
        let scale = Sizes::of(ui).body / 14.0;
        let shown = |column: &&Column<'_>| column.from * scale <= row.width();
        let columns = || self.columns.iter().filter(shown);
        let fixed: f32 = columns().map(|column| column.wide * scale + GAP).sum();
        let grow = columns().filter(|column| column.wide == 0.0).count();
        let rest = ((row.width() - GAP - fixed) / grow.max(1) as f32).max(0.0);
        let mut x = row.left() + GAP;
        let place = |column: &Column<'_>| {
            shown(&column).then(|| {
                let wide = if column.wide == 0.0 {
                    rest
                } else {
                    column.wide * scale
                };
                let place = Rect::from_x_y_ranges(x..=x + wide, row.y_range());
                x += wide + GAP;
                place
            })
        };
        self.columns.iter().map(place).collect()
    }
}

/// One line of text, with "…" where it has no room.
fn text(ui: &Ui, area: Rect, right: bool, (said, size, ink): (&str, f32, Color32)) {
    let mut job = LayoutJob::simple_singleline(said.to_owned(), FontId::proportional(size), ink);
    job.wrap = TextWrapping::truncate_at_width(area.width());
    let laid = ui.painter().layout_job(job);
    let x = match right {
        true => area.right() - laid.size().x,
        false => area.left(),
    };
    let at = pos2(x, area.center().y - laid.size().y / 2.0);
    ui.painter().galley(at, laid, ink);
}
