//! A trace as a small picture on another page: some signals around the trigger, and behind them the good twin's trace.

use std::sync::Arc;

use eframe::egui::{Rect, Role, Sense, Stroke, Ui, WidgetInfo, vec2};

use super::compared_trace::OverlayRequest;
use super::lane_columns::LaneColumns;
use super::row::{GAP, Scratch, Sheet};
use crate::parts::lane::{self, AXIS_HEIGHT};
use crate::{PageContext, Palette};
use ptu_report::trace_view::TracePlot;
use ptu_report::trace_view::listing::OpenTrace;
use ptu_report::words::Words;

/// Time shown before and after the trigger, s.
const BEFORE_S: f64 = 3.0;
const AFTER_S: f64 = 1.5;

/// The picture, and buffers to paint it.
pub struct SmallTrace {
    scene: TracePlot,
    behind: OverlayRequest,
    scratch: Scratch,
}

impl SmallTrace {
    /// Picture of these signals of a trace; requests the good twin's trace behind them.
    pub fn beside_twin(opened: OpenTrace, signals: &[String], context: &PageContext<'_>) -> Self {
        let mut scene = TracePlot::new(Arc::new(opened), signals);
        scene.camera.show(-BEFORE_S, AFTER_S);
        let mut behind = OverlayRequest::default();
        behind.ask_twin(&mut scene, context);
        Self {
            scene,
            behind,
            scratch: Scratch::default(),
        }
    }

    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        self.behind.poll(&mut self.scene, context);
    }

    /// Whether the good twin's trace is being made.
    pub fn is_pending(&self) -> bool {
        self.behind.is_pending()
    }

    /// Whether the good twin's trace is shown.
    pub fn has_twin(&self) -> bool {
        self.scene.behind.as_ref().is_some()
    }

    /// Paints the picture as wide as there is room; `name` is for screen readers.
    pub fn show(&mut self, ui: &mut Ui, name: &str, words: &Words) {
        let palette = Palette::of(ui);
        let heights = |sheet: &Sheet<'_>| sheet.heights(0.0);
        let scene = &self.scene;
        let sheet = |places| Sheet {
            scene,
            places,
            rows: [None; 2],
            words,
            palette: &palette,
        };
        let whole = Rect::from_min_size(ui.cursor().min, vec2(ui.available_width(), 0.0));
        let heights = heights(&sheet(LaneColumns::of(ui, whole, 0)));
        let lanes: f32 = heights.iter().map(|height| height + GAP).sum();
        let size = vec2(ui.available_width(), lanes + AXIS_HEIGHT);
        let (all, response) = ui.allocate_exact_size(size, Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, name));
        if !ui.is_rect_visible(all) {
            return;
        }
        let places = LaneColumns::of(ui, all, 0);
        let middle = Rect::from_x_y_ranges(
            places.left..=places.right,
            all.top()..=all.bottom() - AXIS_HEIGHT,
        );
        self.scratch.edges(scene, middle.width());
        lane::grid(&ui.painter_at(all), middle, scene.window(), &palette);
        let sheet = sheet(places);
        let mut top = all.top();
        for (group, height) in scene.groups().into_iter().zip(heights) {
            let row = Rect::from_x_y_ranges(all.x_range(), top..=top + height + GAP);
            sheet.group(ui, group, row, &mut self.scratch);
            top = row.bottom();
        }
        let trigger = lane::x_at(middle, scene.window(), 0.0);
        let painter = ui.painter_at(all);
        painter.vline(trigger, middle.y_range(), Stroke::new(1.0, palette.warn));
        let below = Rect::from_x_y_ranges(middle.x_range(), middle.bottom()..=all.bottom());
        let unit = words.traces.seconds;
        lane::x_axis(&painter, below, scene.window(), unit, &palette);
    }
}
