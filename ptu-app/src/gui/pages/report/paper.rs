//! A sheet in the window: placed once for a width, then only what is in view is drawn.

use std::collections::BTreeMap;
use std::sync::Arc;

use eframe::egui::{
    Color32, FontId, Galley, Key, Label, Pos2, Rect, ScrollArea, Stroke, StrokeKind, Ui, UiBuilder,
    Vec2, pos2, vec2,
};
use fault_db::Id;

use super::drawing;
use super::flow::{
    ABOVE_HEADING, ABOVE_SUBHEADING, AROUND_ROW, BELOW, BETWEEN, CELL, Flow, HEADING, INSIDE_FRAME,
    NAMES, Piece, SUBHEADING, TEXT, TITLE, heading, placed,
};
use super::ruler::Ruler;
use crate::gui::Palette;
use ptu_report::plot::Mark;
use ptu_report::run::{Align, Block, Cell, Row, RowKind, Table, Tone};

/// A sheet is so wide at least and at most, points.
const WIDTH: (f32, f32) = (560.0, 1000.0);
/// It is placed anew when its width has changed by so much, points.
const STEP: f32 = 16.0;
/// Free beside it, points.
const BESIDE: f32 = 12.0;
/// Share of what is in view that a key scrolls by.
const PAGE: f32 = 0.9;

/// A sheet as it was placed.
#[derive(Default)]
pub struct Paper {
    flow: Option<Flow>,
    /// Points on a pixel may change the widths of letters.
    pixels_per_point: f32,
    /// What plots are drawn with, by their block; made when first in view.
    marks: BTreeMap<usize, Vec<Mark>>,
}

impl Paper {
    /// Shows the blocks of the sheet of this run.
    pub fn show(&mut self, ui: &mut Ui, run: Id, blocks: &[Block]) {
        let area = ScrollArea::both()
            .id_salt(("sheet", run))
            .auto_shrink(false);
        area.show_viewport(ui, |ui, viewport| {
            let flow = self.placed(ui, blocks, viewport.width());
            let beside = ((viewport.width() - flow.width) / 2.0).max(BESIDE);
            let corner = ui.min_rect().min;
            let whole = vec2(flow.width + 2.0 * BESIDE, flow.height + HEADING);
            ui.set_min_size(whole);
            keys(ui, viewport.height());
            let ink = Ink::of(ui);
            let marks = &mut self.marks;
            for piece in flow.within(viewport.top(), viewport.bottom()) {
                let at = corner + vec2(beside, piece.top);
                let on = On {
                    ui,
                    ink: &ink,
                    at,
                    width: flow.width,
                    piece,
                };
                if let Some(block) = blocks.get(piece.block) {
                    on.draw(block, marks);
                }
            }
            self.flow = Some(flow);
        });
    }

    /// The sheet placed for what is `room` wide.
    fn placed(&mut self, ui: &Ui, blocks: &[Block], room: f32) -> Flow {
        let width = (room - 2.0 * BESIDE).clamp(WIDTH.0, WIDTH.1);
        let width = (width / STEP).floor() * STEP;
        let pixels_per_point = ui.pixels_per_point();
        let same = |flow: &Flow| flow.width == width && self.pixels_per_point == pixels_per_point;
        match self.flow.take().filter(same) {
            Some(flow) => flow,
            None => {
                self.pixels_per_point = pixels_per_point;
                self.marks.clear();
                let mut ruler = Ruler::new(ui);
                Flow::new(blocks, width, &mut |text, size, width| {
                    ruler.height(text, size, width)
                })
            }
        }
    }
}

/// A page up or down where no field has the keys.
fn keys(ui: &Ui, page: f32) {
    if ui.ctx().text_edit_focused() {
        return;
    }
    let pages = ui.input(|input| {
        f32::from(u8::from(input.key_pressed(Key::PageUp)))
            - f32::from(u8::from(input.key_pressed(Key::PageDown)))
    });
    if pages != 0.0 {
        ui.scroll_with_delta(vec2(0.0, pages * page * PAGE));
    }
}

/// What words are written in.
struct Ink {
    palette: Palette,
    plain: Color32,
    strong: Color32,
}

impl Ink {
    fn of(ui: &Ui) -> Self {
        Self {
            palette: Palette::of(ui),
            plain: ui.visuals().text_color(),
            strong: ui.visuals().strong_text_color(),
        }
    }

    fn tone(&self, tone: Tone) -> Color32 {
        match tone {
            Tone::Plain => self.plain,
            Tone::Soft => self.palette.quiet,
            Tone::Good => self.palette.good,
            Tone::Bad => self.palette.bad,
        }
    }
}

/// Where a piece is drawn.
struct On<'a> {
    ui: &'a mut Ui,
    ink: &'a Ink,
    at: Pos2,
    width: f32,
    piece: &'a Piece,
}

impl On<'_> {
    fn draw(mut self, block: &Block, marks: &mut BTreeMap<usize, Vec<Mark>>) {
        let (plain, strong, soft) = (self.ink.plain, self.ink.strong, self.ink.palette.quiet);
        match block {
            Block::Title(title, below) => {
                let high = self.words((0.0, BELOW), TITLE, strong, title).y;
                self.words((0.0, BELOW + high), TEXT, soft, below);
            }
            Block::Heading(text) => {
                let high = self.words((0.0, ABOVE_HEADING), HEADING, strong, text).y;
                self.rule(ABOVE_HEADING + high + 2.0, soft);
            }
            Block::Subheading(text, end) => {
                let long = self
                    .words((0.0, ABOVE_SUBHEADING), SUBHEADING, strong, text)
                    .x;
                self.words((long + BETWEEN, ABOVE_SUBHEADING + 2.0), TEXT, soft, end);
            }
            Block::Verdict(tone, verdict, beside) => self.verdict(*tone, verdict, beside),
            Block::Facts(facts) => {
                if let Some((name, value)) = facts.get(self.piece.line) {
                    self.wrapped((0.0, 0.0), NAMES - BETWEEN, TEXT, soft, name);
                    self.wrapped((NAMES, 0.0), self.width - NAMES, TEXT, plain, value);
                }
            }
            Block::Text(tone, text) => {
                let colour = self.ink.tone(*tone);
                self.wrapped((0.0, 0.0), self.width, TEXT, colour, text);
            }
            Block::Table(table) => self.table(table),
            Block::Plot(plot) => {
                let (width, height) = plot.size(f64::from(self.width));
                let marks = marks
                    .entry(self.piece.block)
                    .or_insert_with(|| plot.marks(width));
                let rect = Rect::from_min_size(self.at, vec2(width as f32, height as f32));
                let id = self.ui.scope_id().with(("plot", self.piece.block));
                drawing::plot(self.ui, id, rect, &plot.title, marks);
            }
            Block::Signatures(who, date) => self.signatures(who, date),
        }
    }

    /// The verdict within a frame.
    fn verdict(&mut self, tone: Tone, verdict: &str, beside: &str) {
        let colour = self.ink.tone(tone);
        let frame = vec2(self.width, self.piece.height - 2.0 * BELOW);
        let frame = Rect::from_min_size(self.at + vec2(0.0, BELOW), frame);
        let stroke = Stroke::new(2.0, colour);
        let painter = self.ui.painter();
        painter.rect_stroke(frame, 4.0, stroke, StrokeKind::Inside);
        let inside = BELOW + INSIDE_FRAME;
        let long = self.words((14.0, inside), TITLE, colour, verdict).x;
        let plain = self.ink.plain;
        self.words((14.0 + long + 16.0, inside + 8.0), TEXT, plain, beside);
    }

    fn table(&mut self, table: &Table) {
        let line = self.piece.line;
        if line == 0 {
            self.row(&heading(table), table);
            self.rule(self.piece.height, self.ink.palette.quiet);
        } else if let Some(row) = table.rows.get(line - 1) {
            if row.kind == RowKind::Head && line > 1 {
                self.rule(0.0, self.ink.palette.grid);
            }
            self.row(row, table);
        }
    }

    fn row(&mut self, row: &Row, table: &Table) {
        for cell in placed(row, &table.columns, self.width) {
            match cell.cell {
                Cell::Text(tone, text) => {
                    let colour = self.ink.tone(*tone);
                    let laid = self.laid(cell.width, CELL, colour, text);
                    let spare = match cell.align {
                        Align::Left => 0.0,
                        Align::Right => (cell.width - laid.size().x).max(0.0),
                    };
                    self.put((cell.left + spare, AROUND_ROW), laid);
                }
                Cell::Verdict(tone, text) => {
                    let colour = self.ink.tone(*tone);
                    let laid = self.laid(cell.width, CELL, colour, text);
                    let at = self.at + vec2(cell.left, AROUND_ROW);
                    let chip = Rect::from_min_size(at, laid.size()).expand2(vec2(5.0, 1.0));
                    let ground = colour.gamma_multiply(0.18);
                    self.ui.painter().rect_filled(chip, 4.0, ground);
                    self.put((cell.left, AROUND_ROW), laid);
                }
                Cell::Gauge(Some(gauge)) => {
                    let at = self.at + vec2(cell.left, AROUND_ROW);
                    let bar = Rect::from_min_size(at, vec2(cell.width, CELL + 2.0));
                    drawing::gauge(self.ui, bar, gauge);
                }
                Cell::Gauge(None) => {}
            }
        }
    }

    fn signatures(&mut self, who: &[String], date: &str) {
        let each = self.width / who.len().max(1) as f32;
        let (plain, soft) = (self.ink.plain, self.ink.palette.quiet);
        for (number, name) in who.iter().enumerate() {
            let left = number as f32 * each;
            for (from, share, text) in [(0.0, 0.56, name.as_str()), (0.62, 0.3, date)] {
                let begin = self.at + vec2(left + from * each, 50.0);
                let line = begin.x..=begin.x + share * each;
                let stroke = Stroke::new(1.0, plain);
                self.ui.painter().hline(line, begin.y, stroke);
                self.words((left + from * each, 54.0), TEXT, soft, text);
            }
        }
    }

    fn rule(&self, y: f32, colour: Color32) {
        let across = self.at.x..=self.at.x + self.width;
        let stroke = Stroke::new(1.0, colour);
        self.ui.painter().hline(across, self.at.y + y, stroke);
    }

    /// A text as wide as there is room on the right; its size.
    fn words(&mut self, from: (f32, f32), size: f32, colour: Color32, text: &str) -> Vec2 {
        self.wrapped(from, self.width - from.0, size, colour, text)
    }

    fn wrapped(
        &mut self,
        from: (f32, f32),
        width: f32,
        size: f32,
        colour: Color32,
        text: &str,
    ) -> Vec2 {
        let laid = self.laid(width, size, colour, text);
        let room = laid.size();
        self.put(from, laid);
        room
    }

    fn laid(&self, width: f32, size: f32, colour: Color32, text: &str) -> Arc<Galley> {
        let font = FontId::proportional(size);
        let painter = self.ui.painter();
        painter.layout(text.to_owned(), font, colour, width.max(size))
    }

    /// A label: what is said can be read by a screen reader and copied.
    fn put(&mut self, (x, y): (f32, f32), laid: Arc<Galley>) {
        if laid.text().is_empty() {
            return;
        }
        let at = pos2(self.at.x + x, self.at.y + y);
        let name = (self.piece.block, self.piece.line, x.to_bits());
        let place = UiBuilder::new()
            .id_salt(name)
            .max_rect(Rect::from_min_size(at, laid.size()));
        self.ui.new_child(place).add(Label::new(laid));
    }
}
