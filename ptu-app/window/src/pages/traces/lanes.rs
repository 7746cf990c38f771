//! The lanes of a trace: names at the left, curves in the middle, values at the right, the shared axis below.

use eframe::egui::{
    Align2, CursorIcon, FontId, Painter, Pos2, Rect, Role, ScrollArea, Sense, Stroke, StrokeKind,
    Ui, UiBuilder, WidgetInfo, pos2, vec2,
};

use super::bar;
use super::compared_trace::file_name;
use super::events::{self, STRIP};
use super::input::{self, Drag};
use super::lane_columns::LaneColumns;
use super::notes::TraceNotes;
use super::row::{self, GAP, Scratch, Sheet};
use crate::Palette;
use crate::parts::lane::{self, AXIS_HEIGHT};
use ptu_report::trace_view::{Cursor, Kind, OverlaySource, TracePlot};
use ptu_report::words::Words;
use ptu_runs::clock;

/// Layout that painting keeps from one frame to the next.
pub struct LaneCache {
    /// Area in which the lanes with names, values and axis were painted.
    pub rect: Rect,
    drag: Drag,
    scratch: Scratch,
}

impl Default for LaneCache {
    fn default() -> Self {
        Self {
            rect: Rect::NOTHING,
            drag: Drag::default(),
            scratch: Scratch::default(),
        }
    }
}

impl LaneCache {
    /// Shows the lanes in all the available room.
    pub fn lanes(&mut self, ui: &mut Ui, scene: &mut TracePlot, notes: &TraceNotes, words: &Words) {
        let palette = Palette::of(ui);
        let all = ui.available_rect_before_wrap();
        self.rect = all;
        let both = scene.cursor(Cursor::A).is_some() && scene.cursor(Cursor::B).is_some();
        let places = LaneColumns::of(ui, all, if both { 3 } else { 1 });
        let middle = Rect::from_x_y_ranges(
            places.left..=places.right,
            all.top() + STRIP..=all.bottom() - AXIS_HEIGHT,
        );
        if middle.height() < AXIS_HEIGHT {
            return;
        }
        let response = ui.interact(middle, ui.scope_id().with("lanes"), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Pane, true, words.traces.lanes));
        if response.has_focus() {
            let line = Stroke::new(1.0, palette.accent);
            ui.painter()
                .rect_stroke(middle, 0.0, line, StrokeKind::Outside);
        }
        if response.hovered() {
            ui.set_cursor_icon(CursorIcon::Crosshair);
        }
        input::pointer(ui, &response, middle, scene, &mut self.drag);
        input::keys(ui, &response, middle, scene);

        let pointer = response.hover_pos().filter(|at| middle.contains(*at));
        let share = |at: Pos2| f64::from((at.x - middle.left()) / middle.width());
        let pointer_row = pointer.and_then(|at| scene.axis.row_at(scene.window().at(share(at))));
        let (heads, rows) = told(scene, pointer_row);
        self.scratch.edges(scene, middle.width());
        let strip = Rect::from_x_y_ranges(middle.x_range(), all.top()..=middle.top());
        let below = Rect::from_x_y_ranges(middle.x_range(), middle.bottom()..=all.bottom());
        let painter = ui.painter_at(all);
        lane::grid(&painter, middle, scene.window(), &palette);
        for (i, head) in heads.iter().enumerate() {
            row::put_right(ui, places.value(i, strip), head, palette.warn);
        }
        let sheet = Sheet {
            scene,
            places,
            rows,
            words,
            palette: &palette,
        };
        title(&painter, &sheet, strip);
        self.stack(ui, &sheet, middle);
        events::flags(&painter, strip, middle, &sheet);
        notes.flags(ui, strip, middle, &sheet);
        if let (Drag::Stretch(from), Some(at)) = (self.drag, response.interact_pointer_pos()) {
            let from = lane::x_at(middle, scene.window(), from);
            let (left, right) = (from.min(at.x), from.max(at.x));
            let stretch = Rect::from_x_y_ranges(left..=right, middle.y_range());
            let ground = palette.accent.gamma_multiply(0.25);
            painter.rect_filled(stretch.intersect(middle), 0.0, ground);
        }
        let unit = match scene.axis.kind() {
            Kind::Time => words.traces.seconds,
            Kind::Distance => words.traces.metres,
        };
        lane::x_axis(&painter, below, scene.window(), unit, &palette);
    }

    /// Draws the lanes one above the other; only lanes in view are painted.
    fn stack(&mut self, ui: &mut Ui, sheet: &Sheet<'_>, middle: Rect) {
        let right = ui.max_rect().right();
        let whole = Rect::from_x_y_ranges(sheet.places.names..=right, middle.y_range());
        ui.scope_builder(UiBuilder::new().max_rect(whole), |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                if sheet.scene.lanes.is_empty() {
                    ui.label(sheet.words.traces.no_signals);
                }
                let heights = sheet.heights(middle.height());
                for (group, height) in sheet.scene.groups().into_iter().zip(heights) {
                    let size = vec2(ui.available_width(), height + GAP);
                    let (row, _) = ui.allocate_exact_size(size, Sense::hover());
                    if ui.is_rect_visible(row) {
                        sheet.group(ui, group, row, &mut self.scratch);
                    }
                }
            });
        });
    }
}

/// Names of the shown trace and, in grey, of the trace behind it, so that an exported picture tells what it shows.
fn title(painter: &Painter, sheet: &Sheet<'_>, strip: Rect) {
    let opened = &sheet.scene.opened;
    let line = |row: f32, text: String, colour| {
        let at = pos2(sheet.places.names + 2.0, strip.top() + row * STRIP / 2.0);
        let font = FontId::proportional(lane::TEXT);
        painter.text(at, Align2::LEFT_TOP, text, font, colour);
    };
    let when = clock::local(opened.view.data().t0_us);
    let own = format!("{}  {when}", opened.id.short());
    line(0.0, own, sheet.palette.accent);
    if let Some(behind) = sheet.scene.behind.as_ref() {
        let name = match &behind.overlay.against {
            OverlaySource::Twin => sheet.words.traces.good_twin.to_owned(),
            OverlaySource::File(file) => file_name(file),
            OverlaySource::Trace(id) => {
                let when = clock::local(behind.overlay.view.data().t0_us);
                format!("{}  {when}", id.short())
            }
        };
        line(1.0, name, sheet.palette.quiet);
    }
}

/// Headings of the value columns at the right, and the rows whose values they show: at the cursors, else the pointer.
fn told(scene: &TracePlot, pointer_row: Option<usize>) -> (Vec<String>, [Option<usize>; 2]) {
    let at = |row: usize| bar::place(scene, row);
    match [Cursor::A, Cursor::B].map(|cursor| scene.cursor(cursor)) {
        [Some(a), Some(b)] => {
            let between = scene.axis.at(b) - scene.axis.at(a);
            let between = format!("B−A {}", bar::length(scene, between));
            let heads = vec![format!("A {}", at(a)), format!("B {}", at(b)), between];
            (heads, [Some(a), Some(b)])
        }
        [Some(a), None] => (vec![format!("A {}", at(a))], [Some(a), None]),
        [None, Some(b)] => (vec![format!("B {}", at(b))], [Some(b), None]),
        [None, None] => (
            pointer_row.map(at).into_iter().collect(),
            [pointer_row, None],
        ),
    }
}
