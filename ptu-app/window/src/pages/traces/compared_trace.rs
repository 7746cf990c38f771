//! Choice of the trace behind: the trace of the good twin, another trace or a file, with an offset.

use std::path::Path;
use std::sync::Arc;

use eframe::egui::{ComboBox, DragValue, RichText, Ui};

use super::bar;
use super::list::TraceList;
use crate::parts::named_combo;
use crate::query_worker::Pending;
use crate::request::Request;
use crate::{PageContext, Palette};
use ptu_report::naming::DOT;
use ptu_report::trace_view::{FirstDifference, Overlay, OverlaySource, OverlayTrace, TracePlot};
use ptu_report::words::fill;

/// Most traces offered for comparison.
const OFFERED: usize = 100;
/// Width of the box in which the trace is chosen, points.
const CHOICE: f32 = 110.0;
/// Most deviating signals of which lanes are shown.
const DEVIATING: usize = 12;

#[derive(Default)]
pub struct OverlayRequest {
    against: Option<OverlaySource>,
    overlay: Request<Overlay>,
    parting: Option<Pending<FirstDifference>>,
}

impl OverlayRequest {
    /// Takes responses that have arrived, and requests where the traces deviate while that is unknown for this offset.
    pub fn poll(&mut self, scene: &mut TracePlot, context: &mut PageContext<'_>) {
        if self.overlay.poll() {
            match std::mem::take(&mut self.overlay) {
                Request::Ready(overlay) => {
                    let kind = scene.axis.kind();
                    scene.behind = Some(OverlayTrace::new(Arc::new(overlay), kind));
                }
                Request::Failed(why) => {
                    context
                        .messages
                        .trouble(context.words.traces.cannot_overlay, why.clone());
                    self.against = None;
                }
                other => self.overlay = other,
            }
        }
        if let Some(answer) = self.parting.as_ref().and_then(Pending::take) {
            self.parting = None;
            if let (Ok(parting), Some(against)) = (answer, &self.against) {
                if let Some(why) = &parting.trouble {
                    context
                        .messages
                        .trouble(context.words.traces.cannot_compare, why.clone());
                }
                scene.told(against, parting);
            }
        }
        let Some(behind) = scene.behind.as_ref() else {
            return;
        };
        let told = behind.parting.as_ref().map(|parting| parting.shift_rows);
        if self.parting.is_none() && told != Some(behind.shift_rows) {
            let (overlay, opened) = (behind.overlay.clone(), scene.opened.clone());
            let shift_rows = behind.shift_rows;
            let question = move |_: &_| Ok(overlay.parting(&opened.view, shift_rows));
            self.parting = Some(context.queries.run(question));
        }
    }

    /// Requests the good twin's trace behind the shown one.
    pub fn ask_twin(&mut self, scene: &mut TracePlot, context: &PageContext<'_>) {
        self.ask(Some(OverlaySource::Twin), scene, context);
    }

    /// Requests the trace in a file behind the shown one.
    pub fn ask_file(&mut self, file: &Path, scene: &mut TracePlot, context: &PageContext<'_>) {
        self.ask(Some(OverlaySource::File(file.into())), scene, context);
    }

    /// Whether the trace behind is being made or read.
    pub fn is_pending(&self) -> bool {
        matches!(self.overlay, Request::Pending(_))
    }

    /// Draws the choice of the trace behind: none, the good twin, a file, or another trace.
    pub fn bar(
        &mut self,
        ui: &mut Ui,
        scene: &mut TracePlot,
        list: &TraceList,
        context: &mut PageContext<'_>,
    ) {
        let words = &context.words.traces;
        let mut against = self.against.clone();
        let chosen = self.name(list, context);
        let combo = ComboBox::from_id_salt("compare with")
            .width(CHOICE)
            .truncate()
            .selected_text(&chosen)
            .show_ui(ui, |ui| {
                ui.selectable_value(&mut against, None, words.no_overlay);
                ui.selectable_value(&mut against, Some(OverlaySource::Twin), words.good_twin);
                let own = scene.opened.id;
                if let Some(OverlaySource::File(file)) = &self.against {
                    ui.selectable_value(&mut against, self.against.clone(), file_name(file));
                }
                for (run, trace) in list.all().filter(|(_, t)| t.id != own).take(OFFERED) {
                    let said = trace.said(context.words.language);
                    let name = [&*run.unit, &*run.began, &*said].join(DOT);
                    ui.selectable_value(&mut against, Some(OverlaySource::Trace(trace.id)), name)
                        .on_hover_text(trace.id.to_string());
                }
            });
        named_combo(&combo.response, words.overlay_choice, &chosen);
        if against != self.against {
            self.ask(against, scene, context);
        }
    }

    /// Draws the result of the comparison, and the field for the offset.
    pub fn said(&self, ui: &mut Ui, scene: &mut TracePlot, context: &mut PageContext<'_>) {
        if self.is_pending() {
            ui.spinner();
            ui.label(match &self.against {
                Some(OverlaySource::Twin) => context.words.traces.making_twin,
                _ => context.words.common.loading,
            });
        }
        if scene.behind.as_ref().is_some() {
            offset(ui, scene, context);
            said(ui, scene, context);
        }
    }

    fn ask(
        &mut self,
        against: Option<OverlaySource>,
        scene: &mut TracePlot,
        context: &PageContext<'_>,
    ) {
        self.against.clone_from(&against);
        self.parting = None;
        scene.behind = None;
        let id = scene.opened.id;
        self.overlay = match against {
            None => Request::Idle,
            Some(against) => Request::Pending(
                context
                    .queries
                    .run(move |paths| Overlay::get(&paths.read()?, &paths.scripts, id, against)),
            ),
        };
    }

    fn name(&self, list: &TraceList, context: &PageContext<'_>) -> String {
        match &self.against {
            None => context.words.traces.overlay.to_owned(),
            Some(OverlaySource::Twin) => context.words.traces.good_twin.to_owned(),
            Some(OverlaySource::File(file)) => file_name(file),
            Some(OverlaySource::Trace(id)) => {
                let run = list.all().find(|(_, trace)| trace.id == *id);
                let unit = run.map_or("", |(run, _)| &run.unit);
                format!("{unit} {}", id.short())
            }
        }
    }
}

/// Name of a file in lists and above the lanes.
pub fn file_name(file: &Path) -> String {
    let name = file.file_name().unwrap_or(file.as_os_str());
    name.to_string_lossy().into_owned()
}

fn offset(ui: &mut Ui, scene: &mut TracePlot, context: &PageContext<'_>) {
    let words = &context.words.traces;
    let period_s = scene.view().data().period_us as f64 / 1e6;
    let Some(shift_rows) = scene.behind.as_ref().map(|behind| behind.shift_rows) else {
        return;
    };
    let label = ui.label(words.offset);
    let mut offset_s = shift_rows as f64 * period_s;
    let value = DragValue::new(&mut offset_s)
        .speed(period_s)
        .range(-3600.0..=3600.0)
        .fixed_decimals(2)
        .suffix(" s");
    let value = ui.add(value).labelled_by(label.id);
    if value.on_hover_text(words.offset_hint).changed() {
        scene.shift((offset_s / period_s).round() as i64);
    }
}

fn said(ui: &mut Ui, scene: &mut TracePlot, context: &mut PageContext<'_>) {
    let words = &context.words.traces;
    let parting = scene
        .behind
        .as_ref()
        .and_then(|behind| behind.parting.as_ref());
    let Some(parting) = parting else {
        ui.label(context.words.common.loading);
        return;
    };
    let palette = Palette::of(ui);
    if parting.trouble.is_some() {
        ui.label(RichText::new(words.cannot_compare).color(palette.warn));
        return;
    }
    let Some(first) = &parting.first else {
        ui.label(RichText::new(words.no_deviation).color(palette.good));
        return;
    };
    let text = fill(
        words.deviations,
        &[
            ("count", &parting.stretches.len()),
            ("signal", &first.signal),
            ("place", &bar::place(scene, first.row)),
        ],
    );
    ui.label(RichText::new(text).color(palette.bad));
    if ui.button(words.show_deviating).clicked() {
        scene.show_deviating(DEVIATING);
        context.settings.lanes = scene.signals();
    }
}
