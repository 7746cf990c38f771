//! The fault history: filters, charts, one fault with its freeze frame and what was done about it.

mod bars;
mod change;
mod charts;
mod detail;
mod filter;
mod list;

use eframe::egui::{CentralPanel, Panel, RichText, ScrollArea, Ui};
use fault_db::{DailyCount, FaultDetail, FaultFilter, FaultSummary, Id};

use crate::clock;
use crate::gui::library::{Asked, Kept, Pending};
use crate::gui::{Desk, Palette};
use change::Change;
use filter::Filter;

/// As many faults as are listed.
const MOST: u32 = 20_000;

/// What the list and the charts show.
struct History {
    faults: Vec<FaultSummary>,
    daily: Vec<DailyCount>,
}

/// The page.
#[derive(Default)]
pub struct FaultsPage {
    filter: Filter,
    history: Kept<History>,
    /// What the history was asked for with: days, and runs that had ended.
    asked: Option<(Option<i64>, usize)>,
    chosen: Option<Id>,
    detail: Kept<FaultDetail>,
    change: Change,
}

impl FaultsPage {
    /// Shows it.
    pub fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        self.keep_up(desk);
        let list = Panel::left("fault list").default_size(640.0);
        let list = list.size_range(420.0..=900.0);
        let clicked = list.show(ui, |ui| self.list(ui, desk)).inner;
        if let Some(id) = clicked {
            self.open(id, desk);
        }
        CentralPanel::default().show(ui, |ui| {
            ScrollArea::vertical()
                .auto_shrink(false)
                .show(ui, |ui| self.chosen(ui, desk));
        });
    }

    /// Shows this fault.
    pub fn open(&mut self, id: Id, desk: &mut Desk<'_>) {
        self.chosen = Some(id);
        self.detail.ask_other(detail_of(id, desk));
    }

    /// Asks anew when a run has ended or the span is another.
    fn keep_up(&mut self, desk: &mut Desk<'_>) {
        let wanted = (self.filter.days, desk.units.runs_ended());
        if self.asked != Some(wanted) {
            if let Some((_, ended)) = self.asked.replace(wanted)
                && ended != wanted.1
            {
                self.reread(desk);
            }
            let since_us = self.filter.since_us(clock::now_us());
            let utc_offset_us = clock::utc_offset_us();
            self.history.ask(desk.library.ask(move |shelf| {
                let store = shelf.read()?;
                let filter = FaultFilter {
                    since_us: Some(since_us),
                    limit: Some(MOST),
                    ..FaultFilter::default()
                };
                Ok(History {
                    faults: store.faults(&filter)?,
                    daily: store.daily_occurrences(since_us, utc_offset_us)?,
                })
            }));
        }
        self.history.poll();
        self.detail.poll();
        if let Some(changed) = self.change.poll(desk) {
            self.asked = None;
            if self.chosen == Some(changed) {
                self.reread(desk);
            }
        }
    }

    fn reread(&mut self, desk: &Desk<'_>) {
        if let Some(id) = self.chosen {
            self.detail.ask(detail_of(id, desk));
        }
    }

    fn list(&mut self, ui: &mut Ui, desk: &Desk<'_>) -> Option<Id> {
        let words = desk.words;
        match self.history.get() {
            Asked::There(history) => {
                list::filters(ui, words, &mut self.filter, &history.faults);
                let counts = history
                    .daily
                    .iter()
                    .filter(|count| self.filter.counts(count));
                bars::charts(ui, words, &counts.collect::<Vec<_>>());
                list::list(ui, words, &self.filter, &history.faults, self.chosen)
            }
            Asked::Failed(why) => {
                let said = RichText::new(words.faults.not_read).color(Palette::of(ui).bad);
                ui.label(said.strong());
                ui.label(why);
                if ui.button(words.common.refresh).clicked() {
                    self.asked = None;
                }
                None
            }
            Asked::Not | Asked::Pending(_) => {
                ui.label(words.common.loading);
                None
            }
        }
    }

    fn chosen(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        let stale = self.detail.is_stale();
        match self.detail.get() {
            Asked::There(detail) => {
                detail::head(ui, desk.words, detail);
                self.change.show(ui, desk, &detail.fault, stale);
                detail::rest(ui, desk.words, detail, desk.go);
            }
            Asked::Failed(why) => {
                ui.label(RichText::new(why).color(Palette::of(ui).bad));
            }
            Asked::Not => {
                ui.label(desk.words.faults.choose);
            }
            Asked::Pending(_) => {
                ui.label(desk.words.common.loading);
            }
        }
    }
}

fn detail_of(id: Id, desk: &Desk<'_>) -> Pending<FaultDetail> {
    desk.library.ask(move |shelf| Ok(shelf.read()?.fault(id)?))
}
