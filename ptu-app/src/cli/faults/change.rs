//! Changes to a fault that people make: `ptu faults state`, `repair`, `cause` and `note`.

use clap::Args;
use fault_db::{CauseRecord, ChangedFault, FaultState, RepairRecord, Store};

use crate::cli::print_out;
use ptu_runs::clock::now_us;
use ptu_runs::failure::{Exit, Failure, did_you_mean};
use ptu_runs::stdio;

/// Change a fault's state: open, acknowledged, repaired, verified, closed; and that of its case
///
/// The other faults that come from the same part and are in the same state follow.
#[derive(Debug, Args)]
pub struct StateArguments {
    /// The fault
    id: String,
    /// The new state
    state: FaultState,
    /// Who decides
    #[arg(long, value_name = "TEXT", default_value = "")]
    who: String,
    /// Why
    #[arg(long, value_name = "TEXT", default_value = "")]
    note: String,
    /// This fault alone, not the others of its case
    #[arg(long)]
    only: bool,
}

/// Record a repair of a fault and of the others that come from the same part: its case
#[derive(Debug, Args)]
pub struct RepairArguments {
    /// The fault
    id: String,
    /// Part changed or worked on
    #[arg(long, value_name = "PART")]
    part: String,
    /// Serial number of the part taken out
    #[arg(long, value_name = "TEXT")]
    old: Option<String>,
    /// Serial number of the part put in
    #[arg(long, value_name = "TEXT")]
    new: Option<String>,
    /// What was done
    #[arg(long, value_name = "TEXT", default_value = "")]
    note: String,
    /// Who did it
    #[arg(long, value_name = "TEXT", default_value = "")]
    who: String,
    /// This fault alone, not the others of its case
    #[arg(long)]
    only: bool,
}

/// Say which part a fault comes from; no diagnosis changes it afterwards
#[derive(Debug, Args)]
pub struct CauseArguments {
    /// The fault
    id: String,
    /// The part that explains it; `none`: the fault stands alone
    part: String,
    /// Who says it
    #[arg(long, value_name = "TEXT", default_value = "")]
    who: String,
    /// Why
    #[arg(long, value_name = "TEXT", default_value = "")]
    note: String,
}

/// Add a note to a fault; its state stays
#[derive(Debug, Args)]
pub struct NoteArguments {
    /// The fault
    id: String,
    /// What is to be said
    text: String,
    /// Who says it
    #[arg(long, value_name = "TEXT", default_value = "")]
    who: String,
}

impl StateArguments {
    pub fn change(&self, store: &Store) -> Result<Exit, Failure> {
        let id = store.resolve_fault(&self.id)?;
        let (who, note, at_us) = (&self.who, &self.note, now_us());
        print_out(&match self.only {
            true => is_now(
                &id.short(),
                store.set_state(id, self.state, who, note, at_us)?,
            ),
            false => changed(&store.set_case_state(id, self.state, who, note, at_us)?),
        })
    }
}

impl RepairArguments {
    pub fn record(&self, store: &Store) -> Result<Exit, Failure> {
        if self.part.trim().is_empty() {
            return Err(Failure::usage("a repair is of a part; name it with --part"));
        }
        let id = store.resolve_fault(&self.id)?;
        let note = of_unknown_part(store, &self.part)?;
        let repair = RepairRecord {
            part: self.part.clone(),
            serial_old: self.old.clone(),
            serial_new: self.new.clone(),
            note: self.note.clone(),
        };
        let (who, at_us) = (&self.who, now_us());
        let said = match self.only {
            true => is_now(&id.short(), store.record_repair(id, &repair, who, at_us)?),
            false => changed(&store.repair_case(id, &repair, who, at_us)?),
        };
        if let Some(note) = note {
            stdio::note(&note);
        }
        print_out(&said)
    }
}

impl CauseArguments {
    pub fn attribute(&self, store: &Store) -> Result<Exit, Failure> {
        let id = store.resolve_fault(&self.id)?;
        let part = match self.part.trim() {
            "none" | "-" => "",
            part => part,
        };
        let note = match part {
            "" => None,
            part => of_unknown_part(store, part)?,
        };
        let cause = CauseRecord {
            part: part.to_owned(),
            note: self.note.trim().to_owned(),
            ..CauseRecord::default()
        };
        store.set_cause(id, &cause, self.who.trim(), now_us())?;
        if let Some(note) = note {
            stdio::note(&note);
        }
        print_out(&match part {
            "" => format!("fault {} stands alone", id.short()),
            part => format!("fault {} comes from {part}", id.short()),
        })
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

/// What to say of a part that nothing knows by this name, while another has nearly the same: a unit has
/// more parts than faults ever named, so it is recorded all the same.
fn of_unknown_part(store: &Store, asked: &str) -> Result<Option<String>, Failure> {
    let known = store.known_parts()?;
    let part = asked.trim().to_lowercase();
    if known
        .iter()
        .any(|known| known.trim().to_lowercase() == part)
    {
        return Ok(None);
    }
    let hint = did_you_mean(&part, known.iter().map(String::as_str));
    let note = format!(
        "note: no fault and no earlier repair names a part \"{asked}\"{hint}; recorded as it is"
    );
    Ok((!hint.is_empty()).then_some(note))
}

fn is_now(fault: &str, state: FaultState) -> String {
    format!("fault {fault} is {}", state.as_str())
}

/// The fault that was named, and what was settled with it.
pub fn changed((named, rest): &(ChangedFault, Vec<ChangedFault>)) -> String {
    let mut text = is_now(&named.id.short(), named.state);
    for fault in rest {
        let (id, name) = (fault.id.short(), &fault.code_name);
        text += &format!("\n  and {id} of the same case, {name} {}", fault.lru);
    }
    text
}
