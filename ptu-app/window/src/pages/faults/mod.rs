//! The fault history: filters, one fault with its freeze frame and what was done about it.

mod asked;
mod change;
mod detail;
mod filter;
mod list;

use eframe::egui::{Key, Label, Panel, RichText, ScrollArea, Ui, UiBuilder};
use egui_material_icons::icons::ICON_ARROW_BACK;
use fault_db::{FaultDetail, FaultFilter, FaultState, FaultSummary, Id};

use crate::page_context::FaultsOf;
use crate::parts::look_back::since_us;
use crate::parts::{
    Face, Look, MemoryReader, SavedSaid, Stored, UnitFilter, dialog_is_open, names, saved_questions,
};
use crate::request::FollowingResponse;
use crate::{DataPaths, PageContext, Palette};
use change::Change;
use filter::Filter;
use ptu_report::naming::PartNames;
use ptu_report::words::fill;
use ptu_runs::clock;

/// Number of faults that are listed.
const MOST: u32 = 20_000;
/// Least window width, and width of the panel of one fault, points; in a narrower window it replaces the table.
const DETAIL: [[f32; 2]; 2] = [[1600.0, 440.0], [1100.0, 344.0]];

/// Faults of the span that the filter asks for, and names of parts.
struct History {
    faults: Vec<FaultSummary>,
    parts: PartNames,
}

#[derive(Default)]
pub struct FaultsPage {
    filter: Filter,
    /// Name under which the question is to be saved, as typed.
    question: String,
    units: UnitFilter,
    /// The faults of the last days; the question is the number of days.
    history: FollowingResponse<Option<i64>, History>,
    chosen: Option<Id>,
    detail: FollowingResponse<Id, FaultDetail>,
    change: Change,
    /// The detail is being read again after a change made on this page; changes offered before may not be allowed now.
    changed_here: bool,
    /// The log of the chosen unit.
    unit_log: MemoryReader,
}

impl FaultsPage {
    pub fn show(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        self.keep_up(context);
        let screen = ui.ctx().content_rect().width();
        let detail = DETAIL.iter().find(|[from, _]| screen >= *from);
        let mut list = ui.available_rect_before_wrap();
        match (self.chosen.is_some(), detail) {
            (true, None) => {
                let back = Face::new(Look::Quiet, context.words.case.back).icon(ICON_ARROW_BACK);
                let esc = ui.input(|input| input.key_pressed(Key::Escape));
                if back.show(ui).clicked() || esc && !dialog_is_open(ui.ctx()) {
                    self.chosen = None;
                }
                self.chosen(ui, context);
                return;
            }
            (true, Some([_, wide])) => {
                let (left, right) = list.split_left_right_at_x(list.right() - wide);
                let right = right.with_min_x(right.left() + 12.0);
                let right = UiBuilder::new().max_rect(right).id_salt("fault");
                ui.scope_builder(right, |ui| self.chosen(ui, context));
                list = left;
            }
            (false, _) => {}
        }
        let list = UiBuilder::new().max_rect(list).id_salt("faults");
        let clicked = ui.scope_builder(list, |ui| self.list(ui, context));
        if let Some(id) = clicked.inner {
            self.open(id);
        }
    }
    pub fn open(&mut self, id: Id) {
        self.chosen = Some(id);
        self.detail.read_again();
    }

    /// Shows the faults that a bar of the statistics stands for.
    pub fn show_of(&mut self, of: FaultsOf) {
        self.units = of.units.clone();
        self.filter = Filter {
            days: of.days,
            of_bar: of,
            ..Filter::default()
        };
    }

    /// Reads again when the data, the span or the chosen fault have changed.
    fn keep_up(&mut self, context: &mut PageContext<'_>) {
        let days = (self.filter.days, true);
        self.history.keep_up(days, context, |paths, days| {
            let since_us = since_us(days, clock::now_us()).unwrap_or_default();
            let filter = FaultFilter {
                since_us: Some(since_us),
                limit: Some(MOST),
                ..FaultFilter::default()
            };
            Ok(History {
                faults: paths.read()?.faults(&filter)?,
                parts: PartNames::of(&paths.scripts),
            })
        });
        if let Some(id) = self.chosen {
            let read = |paths: &DataPaths, id| Ok(paths.read()?.fault(id)?);
            self.detail.keep_up((id, false), context, read);
        }
        self.changed_here &= self.detail.is_stale();
    }

    /// Takes the response to a change, whichever page is shown.
    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        if let Some(changed) = self.change.poll(context) {
            self.history.read_again();
            if self.chosen == Some(changed) {
                self.changed_here = true;
                self.detail.read_again();
            }
        }
    }

    fn list(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) -> Option<Id> {
        let words = context.words;
        let Some(history) = self.history.get().value() else {
            if (self.history.get()).missing(ui, words, words.faults.not_read) {
                self.history.read_again();
            }
            return None;
        };
        let mut is_read = false;
        let shown = ui.horizontal_wrapped(|ui| {
            list::filters(ui, words, &mut self.filter, history);
            let units = history.faults.iter().map(|fault| &*fault.unit_serial);
            self.units.show(ui, context, &names(units));
            let saved = (&mut context.settings.faults, &mut self.question);
            let now = self.filter.question(self.units.taken.as_deref());
            if let Some(asked) = saved_questions(ui, &SavedSaid::questions(words), saved, &now) {
                self.units.choose(asked.unit.clone());
                self.filter = Filter::asked(asked);
            }
            is_read = self.unit_log.show(ui, Stored::Log, context);
            list::of_bar(ui, words, &mut self.filter, &history.parts);
            let all = history.faults.iter();
            let (filter, units) = (&self.filter, &self.units);
            let takes =
                |fault: &&FaultSummary| filter.takes(fault) && units.takes(&fault.unit_serial);
            let shown: Vec<_> = all.filter(takes).collect();
            let count: [(&str, &dyn std::fmt::Display); 2] =
                [("n", &shown.len()), ("of", &history.faults.len())];
            let count = fill(words.faults.shown, &count);
            let count = RichText::new(count).color(Palette::of(ui).quiet);
            ui.add(Label::new(count).extend());
            shown
        });
        let clicked = list::table(ui, words, &shown.inner, &history.parts, self.chosen);
        if is_read {
            self.history.read_again();
        }
        clicked
    }

    fn chosen(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        // A change by another program disables no button; the store refuses a change that is no longer allowed.
        let stale = self.changed_here;
        let none = PartNames::default();
        let parts = self
            .history
            .get()
            .value()
            .map_or(&none, |known| &known.parts);
        let Some(detail) = self.detail.get().shown(ui, context.words) else {
            return;
        };
        let seen_since = self.history.get().value().is_some_and(|known| {
            known
                .faults
                .iter()
                .any(|other| takes_its_place(other, &detail.fault))
        });
        let stands = (stale, seen_since);
        let foot = Panel::bottom("changes of a fault").resizable(false);
        foot.show(ui, |ui| {
            self.change.show(ui, context, (detail, parts), stands)
        });
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            detail::head(ui, (context.words, parts), detail, context.go_to);
            detail::rest(ui, (context.words, parts), detail, context.go_to);
        });
    }
}

/// Whether `other` is the closed fault, seen again.
fn takes_its_place(other: &FaultSummary, closed: &FaultSummary) -> bool {
    let of = |fault: &FaultSummary| (fault.unit_serial.clone(), fault.code, fault.lru.clone());
    other.state != FaultState::Closed && of(other) == of(closed)
}
