//! History of a unit: open faults and earlier repairs.

use eframe::egui::{RichText, Ui};
use fault_db::{FaultFilter, FaultState, FaultSummary, RepairRecord, StoreError};

use crate::parts::{fact, link, repair_line};
use crate::request::{FollowingResponse, Request};
use crate::{DataPaths, Destination, PageContext, Palette, Sizes};
use ptu_report::naming::PartNames;
use ptu_report::words::{Words, fill};
use ptu_runs::clock;
use ptu_runs::failure::Failure;

/// Number of faults that are read for their repairs, the latest first.
const MOST: u32 = 50;
/// Number of lines of each kind that are shown.
const SHOWN: usize = 5;

/// The history of one unit.
#[derive(Default)]
pub struct KnownUnit {
    /// Serial number of the unit.
    of: Option<String>,
    history: FollowingResponse<String, History>,
}

#[derive(Default)]
struct History {
    open: Vec<FaultSummary>,
    /// Repairs with their time, µs since 1970, the latest first.
    repairs: Vec<(i64, RepairRecord)>,
    parts: PartNames,
}

impl KnownUnit {
    /// Reads the history of this unit, unless it is read and the data are unchanged.
    pub fn keep_up(&mut self, serial: &str, context: &PageContext<'_>) {
        self.of = Some(serial.to_owned());
        (self.history).keep_up((serial.to_owned(), true), context, read);
    }

    /// Serial number of the part in the unit, according to the part's last repair.
    pub fn serial_of(&self, part: &str) -> Option<String> {
        let repairs = &self.history.get().value()?.repairs;
        let last = repairs.iter().find(|(_, repair)| repair.part == part);
        last.and_then(|(_, repair)| repair.serial_new.clone())
    }

    /// Name of a part in the window's language.
    pub fn part_name<'a>(&'a self, id: &'a str, words: &Words) -> &'a str {
        let history = self.history.get().value();
        history.map_or(id, |known| known.parts.name(id, words.language))
    }

    /// Draws the numbers of open faults and of repairs.
    pub fn facts(&self, ui: &mut Ui, words: &Words) {
        if let Some(history) = self.history.get().value() {
            let number = |n: usize| match n {
                0 => words.frame.none.to_owned(),
                n => n.to_string(),
            };
            fact(ui, words.case.open_faults, &number(history.open.len()));
            fact(ui, words.case.repairs, &number(history.repairs.len()));
        }
    }

    pub fn show(&self, ui: &mut Ui, words: &Words, go_to: &mut Vec<Destination>) {
        let history = match self.history.get() {
            Request::Ready(history) => history,
            Request::Failed(why) => {
                let why = words.trouble(why);
                ui.label(RichText::new(&*why).color(Palette::of(ui).bad));
                return;
            }
            Request::Idle | Request::Pending(_) => {
                ui.label(words.common.loading);
                return;
            }
        };
        if history.open.is_empty() && history.repairs.is_empty() {
            let quiet = Palette::of(ui).quiet;
            ui.label(RichText::new(words.case.nothing_known).color(quiet));
            return;
        }
        let open = history.open.iter().map(|fault| {
            let at = clock::local(fault.last_at_us);
            let said = history
                .parts
                .fault(fault.cause(), (&fault.findings, &fault.message), words);
            format!("{at}  {said}")
        });
        for (place, said) in open.take(SHOWN).enumerate() {
            heading(ui, words.case.open_faults, place);
            ui.label(said);
        }
        for (place, (at_us, repair)) in history.repairs.iter().take(SHOWN).enumerate() {
            heading(ui, words.case.repairs, place);
            let part = history.parts.name(&repair.part, words.language);
            let said = format!("{}  {part}", clock::local(*at_us));
            repair_line(ui, words, &said, repair, go_to);
        }
        if let Some(serial) = &self.of
            && link(ui, fill(words.life.open, &[("serial", serial)])).clicked()
        {
            go_to.push(Destination::Life(serial.clone()));
        }
    }
}

/// A title above the first line.
fn heading(ui: &mut Ui, title: &str, place: usize) {
    if place == 0 {
        ui.label(RichText::new(title).size(Sizes::of(ui).lead).strong());
    }
}

fn read(paths: &DataPaths, serial: String) -> Result<History, Failure> {
    let mut history = History {
        parts: PartNames::of(&paths.scripts),
        ..History::default()
    };
    if !paths.is_there() {
        return Ok(history);
    }
    let store = paths.read()?;
    let filter = FaultFilter {
        unit: Some(serial),
        limit: Some(MOST),
        ..FaultFilter::default()
    };
    let faults = match store.faults(&filter) {
        // The database does not know this unit.
        Err(StoreError::NotFound { .. }) => return Ok(history),
        faults => faults?,
    };
    for fault in faults {
        let events = store.fault(fault.id)?.events.into_iter();
        let repairs = events.filter_map(|event| Some((event.at_us, event.repair?)));
        history.repairs.extend(repairs);
        if matches!(fault.state, FaultState::Open | FaultState::Acknowledged) {
            history.open.push(fault);
        }
    }
    history.repairs.sort_by_key(|(at_us, _)| -at_us);
    // The repair of a case is stored with each fault of the case, so it occurs several times.
    history.repairs.dedup();
    Ok(history)
}
