//! Changes to a fault: state, repairs and notes.

use eframe::egui::{RichText, Ui};
use fault_db::{FaultAction, FaultDetail, FaultState, FaultSummary, Id, RepairRecord, ToWithdraw};

use super::asked::{Asked, Chosen};
use crate::messages::Written;
use crate::parts::{ActionPlace, Face, Look, note_edit, typed};
use crate::request::Request;
use crate::{PageContext, Palette};
use ptu_report::naming::PartNames;
use ptu_report::words::{Words, fill};
use ptu_runs::clock::now_us;

/// States a person can bring a fault to.
const TOWARDS: [FaultState; 5] = [
    FaultState::Acknowledged,
    FaultState::Verified,
    FaultState::Closed,
    FaultState::Open,
    FaultState::Repaired,
];

/// The form for a change, and the change that is being stored.
#[derive(Default)]
pub struct Change {
    /// The fault that the form is about.
    of: Option<Id>,
    note: String,
    asked: Option<Asked>,
    /// Response: the fault that was changed, and when.
    under_way: Request<Written>,
    /// Change under way, as its button names it.
    what: &'static str,
    /// The change under way withdraws a closing; no undo is offered for a withdrawal.
    takes_back: bool,
}

impl Change {
    /// Takes the response: the fault whose change has just been stored.
    pub fn poll(&mut self, context: &mut PageContext<'_>) -> Option<Id> {
        let words = &context.words.faults;
        let changed = self.under_way.take(words.not_changed, context.messages)?;
        let said = fill(words.recorded, &[("what", &self.what)]);
        match std::mem::take(&mut self.takes_back) {
            true => context.messages.note(said),
            false => context.messages.note_written(said, changed),
        }
        if self.of == Some(changed.fault) {
            (self.note, self.asked) = Default::default();
        }
        Some(changed.fault)
    }

    /// Shows the changes that the fault's state allows. `is_stale`: the state is being read again, none is possible.
    /// `seen_since`: the closed fault was seen again, so its closing cannot be withdrawn.
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
        if self.of != Some(fault.id) {
            // Text typed about another fault is not meant for this one.
            (self.of, self.note, self.asked) = (Some(fault.id), String::new(), None);
        }
        let who = context.settings.operator.trim().to_owned();
        let place = ActionPlace::new(ui, "fault", (fault.id, fault.state.as_str()));
        let busy = (!self.under_way.is_idle() || is_stale).then_some(words.common.loading);
        let unnamed = who.is_empty().then_some(words.case.name_first);
        let written = !self.note.trim().is_empty();
        ui.horizontal(|ui| {
            let label = ui.label(words.common.note);
            let add = Face::new(Look::Secondary, words.faults.add_note);
            let missing = (!written).then_some(words.faults.note_first);
            let add = add.because(unnamed.or(busy).or(missing));
            let wide = ui.available_width() - add.wide(ui) - ui.spacing().item_spacing.x;
            let note = ui.add(note_edit(&mut self.note, wide));
            note.labelled_by(label.id);
            if place.clicked(&add.show(ui)) {
                self.what = words.faults.add_note;
                let (id, who, note) = (fault.id, who.clone(), self.note.clone());
                self.under_way = Request::Pending(context.queries.run(move |paths| {
                    let at_us = now_us();
                    paths.open()?.add_note(id, &who, &note, at_us)?;
                    Ok(Written { fault: id, at_us })
                }));
            }
        });
        if let Some(why) = unnamed {
            ui.label(RichText::new(why).color(Palette::of(ui).quiet));
        }
        ui.horizontal_wrapped(|ui| {
            for state in TOWARDS {
                // Reopening withdraws the closing, as long as nothing recorded later depends on the closing.
                let reopens = (fault.state, state) == (FaultState::Closed, FaultState::Open);
                let taken_back = reopens && was_closed_last(detail) && !seen_since;
                if fault.state.next(FaultAction::towards(state)).is_err() && !taken_back {
                    continue;
                }
                let look = match state {
                    FaultState::Repaired => Look::Primary,
                    _ => Look::Secondary,
                };
                let reason = state == FaultState::Verified && !written;
                let reason = reason.then_some(words.faults.verify_reason);
                let face = Face::new(look, name(state, words)).because(unnamed.or(busy).or(reason));
                if place.clicked(&face.show(ui)) {
                    match state {
                        FaultState::Closed | FaultState::Repaired => {
                            self.asked = Some(Asked::new(state, &self.note));
                        }
                        _ => self.bring(context, fault, (state, self.note.clone()), &who),
                    }
                }
            }
        });
        let may = unnamed.is_none() && busy.is_none() && !context.settings.is_locked();
        let can = |asked: &&mut Asked| fault.state.next(FaultAction::towards(asked.to)).is_ok();
        let Some(asked) = self.asked.as_mut().filter(can).filter(|_| may) else {
            return;
        };
        let to = asked.to;
        match asked.show(ui, (words, parts), detail) {
            Some(Chosen::Write(note)) => self.bring(context, fault, (to, note), &who),
            Some(Chosen::Cancel) => self.asked = None,
            None => {}
        }
    }

    fn bring(
        &mut self,
        context: &PageContext<'_>,
        fault: &FaultSummary,
        (state, note): (FaultState, String),
        who: &str,
    ) {
        let words = context.words;
        self.what = match state {
            FaultState::Closed | FaultState::Repaired => words.fault_state(state),
            _ => name(state, words),
        };
        let was_closed = fault.state == FaultState::Closed;
        self.takes_back = was_closed;
        let undone = words.faults.reopen;
        // The typed text stays until it is stored.
        let asked = self.asked.as_ref();
        let repair = RepairRecord {
            part: fault.cause().to_owned(),
            serial_old: asked.and_then(|asked| typed(&asked.serial_old)),
            serial_new: asked.and_then(|asked| typed(&asked.serial_new)),
            note: note.clone(),
        };
        let (id, who) = (fault.id, who.to_owned());
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

/// Whether the last entry by a person closed the fault.
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
