//! The page of the repair: part, serial numbers, note.

use std::collections::BTreeSet;

use eframe::egui::{Grid, Ui};
use fault_db::{FaultAction, Id, RepairRecord};

use super::known::KnownUnit;
use super::result::Found;
use crate::messages::Written;
use crate::parts::{
    ActionPlace, Face, Look, field, go_on, name_edit, note_edit, pick, title, typed,
};
use crate::request::Request;
use crate::{DataPaths, PageContext};
use ptu_report::words::fill;
use ptu_runs::clock::now_us;
use ptu_runs::failure::Failure;

/// Width of a field, points.
const FIELD: f32 = 300.0;

/// The form of a repair, and the repair that was stored.
#[derive(Default)]
pub struct Repair {
    run: Option<Id>,
    /// Parts to choose from, the likeliest first.
    parts: Vec<String>,
    pub part: String,
    /// Name of the part in the window's language.
    part_name: String,
    serial_old: String,
    serial_new: String,
    note: String,
    /// Response: a fault of the case, and when the repair was written.
    saving: Request<Option<Written>>,
    written: Option<Written>,
}

impl Repair {
    /// Fills in the part that was found, and its serial number from the part's last repair.
    pub fn prepare(&mut self, found: &Found, known: &KnownUnit) {
        if self.run == Some(found.run) {
            return;
        }
        let part = found.parts.first().cloned().unwrap_or_default();
        *self = Self {
            run: Some(found.run),
            serial_old: known.serial_of(&part).unwrap_or_default(),
            parts: found.parts.clone(),
            part,
            ..Self::default()
        };
    }

    /// Takes the response; true when the repair has been stored with this call.
    pub fn poll(&mut self, known: &KnownUnit, context: &mut PageContext<'_>) -> bool {
        if !self.saving.poll() {
            return false;
        }
        let words = &context.words.case;
        match std::mem::take(&mut self.saving) {
            Request::Failed(why) => {
                context.messages.trouble(words.not_recorded, why.clone());
                false
            }
            Request::Ready(written) => {
                self.written = written;
                self.part_name = known.part_name(&self.part, context.words).to_owned();
                let said = fill(words.recorded, &[("part", &self.part_name)]);
                match written {
                    Some(written) => context.messages.note_written(said, written),
                    None => context.messages.note(said),
                }
                true
            }
            Request::Idle | Request::Pending(_) => false,
        }
    }

    /// A fault of this case that was repaired.
    pub fn fault(&self) -> Option<Id> {
        self.written.map(|written| written.fault)
    }

    /// The repair is stored, and was not undone.
    pub fn is_written(&self) -> bool {
        self.written.is_some()
    }

    /// The part and its new serial number, once the repair is stored; else empty.
    pub fn said(&self) -> String {
        if !self.is_written() {
            return String::new();
        }
        [&*self.part_name, self.serial_new()]
            .join(" ")
            .trim()
            .to_owned()
    }

    pub fn serial_new(&self) -> &str {
        self.serial_new.trim()
    }

    /// Whether the repair has been undone since the last call.
    pub fn is_undone(&mut self, context: &PageContext<'_>) -> bool {
        let is_undone = |written: &mut Written| context.messages.was_taken_back(*written);
        self.written.take_if(is_undone).is_some()
    }

    /// The form has the serial number of a new part, or a note on what else was done.
    fn says_what(&self) -> bool {
        !self.serial_new.trim().is_empty() || !self.note.trim().is_empty()
    }

    fn record(&self) -> RepairRecord {
        RepairRecord {
            part: self.part.trim().to_owned(),
            serial_old: typed(&self.serial_old),
            serial_new: typed(&self.serial_new),
            note: self.note.trim().to_owned(),
        }
    }
}

impl Repair {
    /// Draws the form.
    pub fn show(&mut self, ui: &mut Ui, known: &KnownUnit, context: &PageContext<'_>) {
        let words = &context.words.case;
        title(ui, known.part_name(&self.part, context.words));
        ui.label(words.switch_off);
        ui.add_space(8.0);
        Grid::new("repair").num_columns(2).show(ui, |ui| {
            ui.label(words.part);
            let name = |part: &str| known.part_name(part, context.words).to_owned();
            let parts = self.parts.iter().map(|part| (part.clone(), name(part)));
            if pick(ui, (words.part, FIELD), &mut self.part, parts) {
                self.serial_old = known.serial_of(&self.part).unwrap_or_default();
            }
            ui.end_row();
            let (old, new) = (&mut self.serial_old, &mut self.serial_new);
            let fields = [
                field(ui, words.serial_old, name_edit(old, FIELD)),
                field(ui, words.serial_new, name_edit(new, FIELD)),
                field(ui, words.note, note_edit(&mut self.note, FIELD)),
            ];
            go_on(ui, &fields);
        });
    }

    /// The button that stores the repair.
    pub fn foot(&mut self, ui: &mut Ui, context: &PageContext<'_>) {
        let words = &context.words.case;
        let who = context.settings.operator.trim().to_owned();
        let may = !who.is_empty() && self.says_what() && self.saving.is_idle();
        let place = ActionPlace::new(ui, "case save", self.saving.is_idle());
        let hint = match who.is_empty() {
            true => words.name_first,
            false => words.serial_or_note,
        };
        let save = Face::new(Look::Primary, words.save).off((!may).then_some(hint));
        if let (true, Some(run)) = (place.clicked(&save.show(ui)), self.run) {
            let repair = self.record();
            let store = move |paths: &DataPaths| store(paths, run, &repair, &who);
            self.saving = Request::Pending(context.queries.run(store));
        }
    }
}

/// Writes the repair for each fault of the run that is still to be repaired, and for its case, all with one time
/// stamp, which the undo uses; returns the first fault.
fn store(
    paths: &DataPaths,
    run: Id,
    repair: &RepairRecord,
    who: &str,
) -> Result<Option<Written>, Failure> {
    let (store, at_us) = (paths.open()?, now_us());
    let mut faults: Vec<Id> = store
        .run_occurrences(run)?
        .iter()
        .map(|seen| seen.fault)
        .collect();
    faults.sort_unstable();
    faults.dedup();
    let mut first = None;
    let mut done = BTreeSet::new();
    for fault in faults {
        // A fault whose case was just repaired needs no repair of its own.
        let state = store.fault(fault)?.fault.state;
        if !done.contains(&fault) && state.next(FaultAction::Repair).is_ok() {
            let (named, rest) = store.repair_case(fault, repair, who, at_us)?;
            done.extend(rest.iter().chain([&named]).map(|changed| changed.id));
            first.get_or_insert(Written { fault, at_us });
        }
    }
    Ok(first)
}
