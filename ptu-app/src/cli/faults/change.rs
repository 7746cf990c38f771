//! Changes to a fault that people make: `ptu faults state`, `repair` and `note`.

use clap::Args;
use fault_db::{FaultState, RepairRecord, Store};

use crate::cli::print_out;
use ptu_bench::clock::now_us;
use ptu_bench::failure::{Exit, Failure, did_you_mean};
use ptu_bench::stdio;

/// Change a fault's state: open, acknowledged, repaired, verified, closed
#[derive(Debug, Args)]
pub struct StateArguments {
    /// The fault
    id: String,
    /// The new state
    state: FaultState,
    /// Who decides
    #[arg(long, default_value = "")]
    who: String,
    /// Why
    #[arg(long, default_value = "")]
    note: String,
}

/// Record a repair
#[derive(Debug, Args)]
pub struct RepairArguments {
    /// The fault
    id: String,
    /// Part changed or worked on
    #[arg(long)]
    part: String,
    /// Serial number of the part taken out
    #[arg(long, value_name = "TEXT")]
    old: Option<String>,
    /// Serial number of the part put in
    #[arg(long, value_name = "TEXT")]
    new: Option<String>,
    /// What was done
    #[arg(long, default_value = "")]
    note: String,
    /// Who did it
    #[arg(long, default_value = "")]
    who: String,
}

/// Add a note to a fault; its state stays
#[derive(Debug, Args)]
pub struct NoteArguments {
    /// The fault
    id: String,
    /// What is to be said
    text: String,
    /// Who says it
    #[arg(long, default_value = "")]
    who: String,
}

impl StateArguments {
    pub fn change(&self, store: &Store) -> Result<Exit, Failure> {
        let id = store.resolve_fault(&self.id)?;
        let state = store.set_state(id, self.state, &self.who, &self.note, now_us())?;
        print_out(&format!("fault {} is {}", id.short(), state.as_str()))
    }
}

impl RepairArguments {
    pub fn record(&self, store: &Store) -> Result<Exit, Failure> {
        if self.part.trim().is_empty() {
            return Err(Failure::usage("a repair is of a part; name it with --part"));
        }
        let id = store.resolve_fault(&self.id)?;
        let note = self.of_unknown_part(store)?;
        let repair = RepairRecord {
            part: self.part.clone(),
            serial_old: self.old.clone(),
            serial_new: self.new.clone(),
            note: self.note.clone(),
        };
        let state = store.record_repair(id, &repair, &self.who, now_us())?;
        if let Some(note) = note {
            stdio::note(&note);
        }
        print_out(&format!("fault {} is {}", id.short(), state.as_str()))
    }

    /// What to say of a part that nothing knows by this name, while another has nearly the same: a unit has
    /// more parts than faults ever named, so the repair is recorded all the same.
    fn of_unknown_part(&self, store: &Store) -> Result<Option<String>, Failure> {
        let known = store.known_parts()?;
        let part = self.part.trim().to_lowercase();
        if known
            .iter()
            .any(|known| known.trim().to_lowercase() == part)
        {
            return Ok(None);
        }
        let hint = did_you_mean(&part, known.iter().map(String::as_str));
        let note = format!(
            "note: no fault and no earlier repair names a part \"{}\"{hint}; recorded as it is",
            self.part
        );
        Ok((!hint.is_empty()).then_some(note))
    }
}

impl NoteArguments {
    pub fn note(&self, store: &Store) -> Result<Exit, Failure> {
        let text = self.text.trim();
        if text.is_empty() {
            return Err(Failure::usage("a note says something"));
        }
        let id = store.resolve_fault(&self.id)?;
        store.add_note(id, self.who.trim(), text, now_us())?;
        print_out(&format!("noted on fault {}", id.short()))
    }
}
