//! The fault history: filters, one fault with its freeze frame and what was done about it.

mod change;
mod closing;
mod detail;
mod filter;
mod list;

use eframe::egui::{CentralPanel, RichText, ScrollArea, Ui};
use fault_db::{FaultDetail, FaultFilter, FaultState, FaultSummary, Id};

use crate::page_context::FaultsOf;
use crate::parts::look_back::since_us;
use crate::parts::{FirstHalf, MemoryReader, SavedSaid, UnitFilter, saved_questions};
use crate::query_worker::Pending;
use crate::request::CachedResponse;
use crate::request::Request;
use crate::{PageContext, Palette};
use change::Change;
use filter::Filter;
use ptu_report::naming::PartNames;
use ptu_runs::clock;

/// As many faults as are listed.
const MOST: u32 = 20_000;
const LIST: FirstHalf = FirstHalf {
    name: "fault list",
    width: 620.0,
    share: 0.5,
};

/// Faults of the history that the filter lets through, and names of their parts.
struct History {
    faults: Vec<FaultSummary>,
    parts: PartNames,
}

#[derive(Default)]
pub struct FaultsPage {
    filter: Filter,
    /// Name for a question, as it is typed.
    question: String,
    units: UnitFilter,
    history: CachedResponse<History>,
    /// What the history was asked for with: days, and its version.
    asked: Option<(Option<i64>, (usize, u64))>,
    chosen: Option<Id>,
    detail: CachedResponse<FaultDetail>,
    change: Change,
    /// The detail is being read again because of a change made here: what was offered before may no longer be.
    changed_here: bool,
    /// The log of the chosen unit.
    unit_log: MemoryReader,
}

impl FaultsPage {
    pub fn show(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        self.keep_up(context);
        let clicked = LIST.show(ui, |ui| self.list(ui, context));
        if let Some(id) = clicked {
            self.open(id, context);
        }
        CentralPanel::default().show(ui, |ui| {
            ScrollArea::vertical()
                .auto_shrink(false)
                .show(ui, |ui| self.chosen(ui, context));
        });
    }

    pub fn open(&mut self, id: Id, context: &mut PageContext<'_>) {
        self.chosen = Some(id);
        self.detail.request_other(detail_of(id, context));
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

    /// Asks again when the data or the span are others.
    fn keep_up(&mut self, context: &mut PageContext<'_>) {
        let wanted = (self.filter.days, context.data_version());
        if self.asked != Some(wanted) {
            if let Some((_, version)) = self.asked.replace(wanted)
                && version != wanted.1
            {
                self.reread(context);
            }
            let since_us = since_us(self.filter.days, clock::now_us()).unwrap_or_default();
            self.history.request(context.queries.run(move |paths| {
                let store = paths.read()?;
                let filter = FaultFilter {
                    since_us: Some(since_us),
                    limit: Some(MOST),
                    ..FaultFilter::default()
                };
                Ok(History {
                    faults: store.faults(&filter)?,
                    parts: PartNames::of(&paths.scripts),
                })
            }));
        }
        self.history.poll();
        self.detail.poll();
        self.changed_here &= self.detail.is_stale();
    }

    /// Takes what has been stored, whatever page is in front.
    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        if let Some(changed) = self.change.poll(context) {
            self.asked = None;
            if self.chosen == Some(changed) {
                self.changed_here = true;
                self.reread(context);
            }
        }
    }

    fn reread(&mut self, context: &PageContext<'_>) {
        if let Some(id) = self.chosen {
            self.detail.request(detail_of(id, context));
        }
    }

    fn list(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) -> Option<Id> {
        let words = context.words;
        if self.unit_log.show(ui, context) {
            self.asked = None;
        }
        match self.history.get() {
            Request::Ready(history) => {
                list::filters(ui, words, &mut self.filter, history);
                ui.horizontal_wrapped(|ui| {
                    let saved = (&mut context.settings.faults, &mut self.question);
                    let now = self.filter.question();
                    if let Some(asked) =
                        saved_questions(ui, &SavedSaid::questions(words), saved, &now)
                    {
                        self.filter = Filter::asked(asked);
                    }
                });
                ui.horizontal_wrapped(|ui| {
                    self.units.show(ui, context);
                    list::of_bar(ui, words, &mut self.filter, &history.parts);
                });
                let shown = (&self.filter, &self.units);
                let known = (history.faults.as_slice(), &history.parts);
                list::list(ui, words, shown, known, self.chosen)
            }
            Request::Failed(why) => {
                let said = RichText::new(words.faults.not_read).color(Palette::of(ui).bad);
                ui.label(said.strong());
                ui.label(&*words.trouble(why));
                if ui.button(words.common.refresh).clicked() {
                    self.asked = None;
                }
                None
            }
            Request::Idle | Request::Pending(_) => {
                ui.label(words.common.loading);
                None
            }
        }
    }

    fn chosen(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        // What others write takes no click away; the store refuses what it no longer allows.
        let stale = self.changed_here;
        let none = PartNames::default();
        let parts = self
            .history
            .get()
            .value()
            .map_or(&none, |known| &known.parts);
        match self.detail.get() {
            Request::Ready(detail) => {
                detail::head(ui, (context.words, parts), detail, context.go_to);
                let seen_since = self.history.get().value().is_some_and(|known| {
                    known
                        .faults
                        .iter()
                        .any(|other| takes_its_place(other, &detail.fault))
                });
                let stands = (stale, seen_since);
                self.change.show(ui, context, (detail, parts), stands);
                detail::rest(ui, (context.words, parts), detail, context.go_to);
            }
            Request::Failed(why) => {
                let why = context.words.trouble(why);
                ui.label(RichText::new(&*why).color(Palette::of(ui).bad));
            }
            Request::Idle => {
                ui.label(context.words.faults.choose);
            }
            Request::Pending(_) => {
                ui.label(context.words.common.loading);
            }
        }
    }
}

/// The same fault, seen again after this one was closed.
fn takes_its_place(other: &FaultSummary, closed: &FaultSummary) -> bool {
    let of = |fault: &FaultSummary| (fault.unit_serial.clone(), fault.code, fault.lru.clone());
    other.state != FaultState::Closed && of(other) == of(closed)
}

fn detail_of(id: Id, context: &PageContext<'_>) -> Pending<FaultDetail> {
    context
        .queries
        .run(move |paths| Ok(paths.read()?.fault(id)?))
}
