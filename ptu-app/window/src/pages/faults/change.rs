//! Changes to a fault: state, repairs and notes.

use eframe::egui::{Button, Grid, RichText, Ui};
use fault_db::{FaultAction, FaultDetail, FaultState, FaultSummary, Id, RepairRecord, ToWithdraw};

use super::closing::{Chosen, Closing};

use crate::messages::Written;
use crate::parts::{ActionPlace, field, name_edit, note_edit, typed};
use crate::request::Request;
use crate::{PageContext, Palette};
use ptu_report::naming::PartNames;
use ptu_report::words::{Words, fill};
use ptu_runs::clock::now_us;

/// States a person can bring a fault to.
const TOWARDS: [FaultState; 5] = [
    FaultState::Acknowledged,
    FaultState::Repaired,
    FaultState::Verified,
    FaultState::Closed,
    FaultState::Open,
];

/// Room for the names of the fields, and how wide these are, points.
const NAMES: f32 = 200.0;
const NARROWEST: f32 = 120.0;
const WIDEST: f32 = 420.0;

/// The form, and what becomes of it.
#[derive(Default)]
pub struct Change {
    form: Form,
    /// Answers with the fault that was changed, and when.
    under_way: Request<Written>,
    /// What is being recorded, as its button says it.
    what: &'static str,
    /// Whether what is being recorded takes a closing back, so that no undo is offered for it.
    takes_back: bool,
}

/// What is written about one fault.
#[derive(Default)]
struct Form {
    of: Option<Id>,
    note: String,
    serial_old: String,
    serial_new: String,
    /// The dialog is open.
    closing: Option<Closing>,
}

impl Form {
    fn about(of: Id) -> Self {
        Self {
            of: Some(of),
            ..Self::default()
        }
    }

    /// What has to be written before a person brings the fault to a state: why it is verified without a run, or which
    /// part was put in or what was done instead.
    fn missing_reason(&self, to: FaultState, words: &Words) -> Option<&'static str> {
        let nothing = |text: &String| text.trim().is_empty();
        if !nothing(&self.note) {
            return None;
        }
        match to {
            FaultState::Verified => Some(words.faults.verify_reason),
            FaultState::Repaired if nothing(&self.serial_old) && nothing(&self.serial_new) => {
                Some(words.faults.repair_reason)
            }
            _ => None,
        }
    }
}

impl Change {
    /// The fault a change of which has just been stored.
    pub fn poll(&mut self, context: &mut PageContext<'_>) -> Option<Id> {
        if !self.under_way.poll() {
            return None;
        }
        match std::mem::take(&mut self.under_way) {
            Request::Failed(why) => {
                context
                    .messages
                    .trouble(context.words.faults.not_changed, why.clone());
                None
            }
            Request::Ready(changed) => {
                let said = fill(context.words.faults.recorded, &[("what", &self.what)]);
                match std::mem::take(&mut self.takes_back) {
                    true => context.messages.note(said),
                    false => context.messages.note_written(said, changed),
                }
                if self.form.of == Some(changed.fault) {
                    self.form = Form::about(changed.fault);
                }
                Some(changed.fault)
            }
            Request::Idle | Request::Pending(_) => None,
        }
    }

    /// Shows it: only what the fault's state allows, and nothing while that state is being read again. Of a closed fault that
    /// was seen again since, nothing.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        context: &mut PageContext<'_>,
        (detail, parts): (&FaultDetail, &PartNames),
        (is_stale, seen_since): (bool, bool),
    ) {
        let words = context.words;
        let fault = &detail.fault;
        if let Some(why) = context.only_reads() {
            ui.label(RichText::new(why).color(Palette::of(ui).quiet));
            return;
        }
        if self.form.of != Some(fault.id) {
            // What was begun about another fault is not meant for this one.
            self.form = Form::about(fault.id);
        }
        let wide = (ui.available_width() - NAMES).clamp(NARROWEST, WIDEST);
        Grid::new("change").num_columns(2).show(ui, |ui| {
            field(ui, words.common.note, note_edit(&mut self.form.note, wide));
            if fault.state.next(FaultAction::Repair).is_ok() {
                let (old, new) = (&mut self.form.serial_old, &mut self.form.serial_new);
                field(ui, words.faults.serial_old, name_edit(old, wide));
                field(ui, words.faults.serial_new, name_edit(new, wide));
            }
        });
        let who = context.settings.operator.trim().to_owned();
        if who.is_empty() {
            ui.label(words.case.name_first);
        }
        let may = !who.is_empty() && self.under_way.is_idle() && !is_stale;
        let place = ActionPlace::new(ui, "fault", (fault.id, fault.state.as_str()));
        ui.add_enabled_ui(may, |ui| {
            ui.horizontal_wrapped(|ui| {
                for state in TOWARDS {
                    // What closed it is taken back while nothing rests on that.
                    let reopens = (fault.state, state) == (FaultState::Closed, FaultState::Open);
                    let taken_back = reopens && was_closed_last(detail) && !seen_since;
                    if fault.state.next(FaultAction::towards(state)).is_err() && !taken_back {
                        continue;
                    }
                    let reason = self.form.missing_reason(state, words);
                    let button = ui.add_enabled(reason.is_none(), Button::new(name(state, words)));
                    let button = button.on_disabled_hover_text(reason.unwrap_or_default());
                    if place.clicked(&button) {
                        match state {
                            FaultState::Closed => self.form.closing = Some(Closing::default()),
                            _ => self.bring(context, fault, state, &who),
                        }
                    }
                }
                let written = !self.form.note.trim().is_empty();
                let add = ui.add_enabled(written, Button::new(words.faults.add_note));
                if place.clicked(&add) {
                    self.what = words.faults.add_note;
                    let (id, who, note) = (fault.id, who.clone(), self.form.note.clone());
                    self.under_way = Request::Pending(context.queries.run(move |paths| {
                        let at_us = now_us();
                        paths.open()?.add_note(id, &who, &note, at_us)?;
                        Ok(Written { fault: id, at_us })
                    }));
                }
            });
        });
        let closes =
            may && !context.settings.locked && fault.state.next(FaultAction::Close).is_ok();
        let dialog = self.form.closing.as_mut().filter(|_| closes);
        match dialog.and_then(|dialog| dialog.show(ui, (words, parts), detail)) {
            Some(Chosen::Close(note)) => {
                self.form.note = note;
                self.bring(context, fault, FaultState::Closed, &who);
                self.form.closing = None;
            }
            Some(Chosen::Cancel) => self.form.closing = None,
            None => {}
        }
    }

    fn bring(
        &mut self,
        context: &PageContext<'_>,
        fault: &FaultSummary,
        state: FaultState,
        who: &str,
    ) {
        self.what = match state {
            FaultState::Closed => context.words.common.closed,
            _ => name(state, context.words),
        };
        let was_closed = fault.state == FaultState::Closed;
        self.takes_back = was_closed;
        let undone = context.words.faults.reopen;
        let repair = RepairRecord {
            part: fault.cause().to_owned(),
            serial_old: typed(&self.form.serial_old),
            serial_new: typed(&self.form.serial_new),
            note: self.form.note.clone(),
        };
        let (id, who, note) = (fault.id, who.to_owned(), self.form.note.clone());
        self.under_way = Request::Pending(context.queries.run(move |paths| {
            let (store, at_us) = (paths.open()?, now_us());
            if was_closed {
                let why = if note.is_empty() { undone } else { &*note };
                store.withdraw(id, ToWithdraw::default(), &who, why, at_us)?;
            } else if state == FaultState::Repaired {
                store.repair_case(id, &repair, &who, at_us)?;
            } else {
                store.set_case_state(id, state, &who, &note, at_us)?;
            }
            Ok(Written { fault: id, at_us })
        }));
    }
}

/// What a person wrote last about it is that it is closed.
fn was_closed_last(detail: &FaultDetail) -> bool {
    let mut written = detail.events.iter().rev();
    let last = written.find(|event| !event.who.is_empty());
    last.is_some_and(|event| event.kind == "closed")
}

fn name(state: FaultState, words: &Words) -> &'static str {
    match state {
        FaultState::Acknowledged => words.faults.acknowledge,
        FaultState::Repaired => words.faults.repair,
        FaultState::Verified => words.faults.verify,
        FaultState::Closed => words.faults.close,
        FaultState::Open => words.faults.reopen,
    }
}
