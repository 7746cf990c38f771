//! The traces page: lanes on one axis, cursors, and the trace of a good unit behind.

mod bar;
mod compared_trace;
mod dropped;
mod events;
mod export;
mod input;
mod lane_columns;
mod lanes;
mod list;
mod notes;
mod record_comparison;
mod row;
mod signals;
mod small;
mod table;

use crate::request::Request;
use std::sync::Arc;

use eframe::egui::{CentralPanel, Frame, Panel, RichText, Ui};
use fault_db::Id;

use crate::parts::{Side, link};
use crate::{Destination, PageContext, Palette};
use compared_trace::OverlayRequest;
use export::Export;
use lanes::LaneCache;
use list::TraceList;
use notes::TraceNotes;
use ptu_report::naming::PartNames;
use ptu_report::trace_view::TracePlot;
use ptu_report::trace_view::listing::{self, OpenTrace};
use ptu_report::words::fill;
use record_comparison::RecordComparison;
pub use small::SmallTrace;

/// Height of a row of controls, points.
const ROW: f32 = 28.0;
/// Gap between two controls of the toolbar, points.
const BETWEEN: f32 = 4.0;

#[derive(Default)]
pub struct TracesPage {
    list: TraceList,
    opening: Request<(OpenTrace, String)>,
    scene: Option<TracePlot>,
    behind: OverlayRequest,
    export: Export,
    record: RecordComparison,
    notes: TraceNotes,
    painted: LaneCache,
    find_signal: String,
    /// Name under which the layout is to be saved, as typed.
    layout_name: String,
    choosing: bool,
    told: bool,
}

impl TracesPage {
    pub fn show(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        self.poll(context);
        let words = &context.words.traces;
        let chosen = self.scene.as_ref().map(|scene| scene.opened.id);
        let list = Side {
            name: words.recorded,
            wide: [268.0, 320.0],
            at_right: false,
        };
        self.list.keep_up(context);
        let clicked = list.show(ui, |ui| self.list.show(ui, context, chosen));
        // Without a choice the latest trace is opened: most people want that one.
        let nothing = self.scene.is_none() && self.opening.is_idle();
        if let Some((id, run)) = clicked.or_else(|| self.list.latest().filter(|_| nothing)) {
            self.read(id, Some(run), context);
        }
        CentralPanel::default()
            .frame(Frame::central_panel(ui.style()).inner_margin(4))
            .show(ui, |ui| self.central(ui, context));
        match (dropped::file(ui, context), &mut self.scene) {
            (Some(file), Some(scene)) => self.behind.ask_file(&file, scene, context),
            (Some(_), None) => context.messages.note(words.open_first),
            (None, _) => {}
        }
    }

    pub fn open(&mut self, id: Id, context: &mut PageContext<'_>) {
        self.read(id, None, context);
    }

    fn read(&mut self, id: Id, run: Option<Id>, context: &PageContext<'_>) {
        let question = context.queries.run(move |paths| {
            Ok((
                listing::open(&paths.read()?, &PartNames::of(&paths.scripts), id, run)?,
                export::usual_name(id),
            ))
        });
        self.opening = Request::Pending(question);
    }

    fn poll(&mut self, context: &mut PageContext<'_>) {
        if self.opening.poll() {
            self.scene = None;
            match std::mem::take(&mut self.opening) {
                Request::Ready((opened, name)) => {
                    self.export.name = name;
                    self.behind = OverlayRequest::default();
                    self.scene = Some(TracePlot::new(Arc::new(opened), &context.settings.lanes));
                }
                failed => self.opening = failed,
            }
            if let Request::Failed(why) = &self.opening {
                let said = context.words.traces.cannot_open;
                context.messages.trouble(said, why.clone());
            }
        }
        if let Some(scene) = &mut self.scene {
            self.behind.poll(scene, context);
            self.notes.poll(scene.opened.id, context);
        }
        self.export.poll(context);
    }

    fn central(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        let Some(scene) = &mut self.scene else {
            match &self.opening {
                Request::Idle => drop(ui.label(words.traces.choose_one)),
                Request::Failed(why) => {
                    let bad = Palette::of(ui).bad;
                    ui.label(RichText::new(words.traces.cannot_open).color(bad));
                    ui.label(&*words.trouble(why));
                }
                Request::Pending(_) | Request::Ready(_) => drop(ui.label(words.common.loading)),
            }
            return;
        };
        // Labels are as high as controls, so that both stand on one line.
        ui.spacing_mut().interact_size.y = ROW;
        let rect = self.painted.rect;
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = BETWEEN;
            let sides = (&mut self.choosing, &mut self.told);
            let roomy = bar::view(ui, scene, sides, context);
            self.export.bar(ui, scene, (rect, roomy), context);
            self.record.bar(ui, scene, context);
            self.behind.bar(ui, scene, &self.list, context);
        });
        ui.horizontal_wrapped(|ui| {
            heading(ui, scene, &self.list, context);
            bar::moved_back(ui, scene, &words.traces);
            self.behind.said(ui, scene, context);
        });
        events::links(ui, scene, words);
        self.notes.bar(ui, scene, context);
        if self.choosing {
            Panel::right("signals of the trace")
                .default_size(260.0)
                .size_range(200.0..=400.0)
                .show(ui, |ui| {
                    let typed = (&mut self.find_signal, &mut self.layout_name);
                    signals::choose(ui, scene, typed, context);
                });
        }
        if self.told {
            Panel::bottom("statistics of the trace")
                .resizable(true)
                .default_size(170.0)
                .size_range(80.0..=420.0)
                .show(ui, |ui| table::statistics(ui, scene, words));
        }
        CentralPanel::default()
            .frame(Frame::NONE)
            .show(ui, |ui| self.painted.lanes(ui, scene, &self.notes, words));
    }
}

/// Heading: unit and time of the trace, a warning if something is wrong with it, and links to other pages.
fn heading(ui: &mut Ui, scene: &TracePlot, list: &TraceList, context: &mut PageContext<'_>) {
    let words = context.words;
    let opened = &scene.opened;
    let (unit, when) = list.whose(opened.run);
    let known = |text| match text {
        "" => words.traces.not_known,
        text => text,
    };
    let (unit, when) = (known(unit), known(when));
    let title = fill(words.traces.of_unit, &[("unit", &unit), ("when", &when)]);
    let title = ui.label(RichText::new(title).strong());
    title.on_hover_text(opened.id.to_string());
    let data = &opened.view.data();
    let warn = Palette::of(ui).warn;
    for (amiss, text) in [
        (data.partial, words.traces.cut_short),
        (data.gaps, words.traces.has_gaps),
    ] {
        if amiss {
            ui.label(RichText::new(text).color(warn));
        }
    }
    if let Some(run) = opened.run {
        if link(ui, words.traces.to_report).clicked() {
            context.go_to.push(Destination::Report(run));
        }
        if link(ui, words.traces.to_diagnosis).clicked() {
            context.go_to.push(Destination::Diagnosis(run));
        }
    }
}
