//! Changes to a fault that people make: `ptu faults state`, `repair`, `cause` and `note`.

use clap::Args;
use fault_db::{CaseFault, CauseRecord, FaultState, RepairRecord, Store};

use super::part;
use crate::cli::{ScriptsOption, print_out};
use ptu_report::words::{Words, fill};
use ptu_runs::clock::now_us;
use ptu_runs::failure::{Asked, Exit, Failure};

/// Change the state of a fault and of its case: open, acknowledged, repaired, verified, closed
///
/// The other faults of the case that are in the same state change with it.
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

/// Record a repair of a fault, and of the other faults of its case, which come from the same part
#[derive(Debug, Args)]
pub struct RepairArguments {
    /// The fault
    id: String,
    /// Part changed or worked on, see `ptu catalog parts`
    #[arg(long, value_name = "PART", required_unless_present = "other_part")]
    part: Option<String>,
    /// Instead of --part: a part that the catalogue lacks
    #[arg(long, value_name = "NAME", conflicts_with = "part")]
    other_part: Option<String>,
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
    #[command(flatten)]
    scripts: ScriptsOption,
}

/// Say which part a fault comes from; no diagnosis changes this cause afterwards
#[derive(Debug, Args)]
pub struct CauseArguments {
    /// The fault
    id: String,
    /// The part that explains the fault, see `ptu catalog parts`; `none`: the fault belongs to no case
    #[arg(required_unless_present = "other_part")]
    part: Option<String>,
    /// Instead of PART: a part that the catalogue lacks
    #[arg(long, value_name = "NAME", conflicts_with = "part")]
    other_part: Option<String>,
    /// Who says it
    #[arg(long, value_name = "TEXT", default_value = "")]
    who: String,
    /// Why
    #[arg(long, value_name = "TEXT", default_value = "")]
    note: String,
    #[command(flatten)]
    scripts: ScriptsOption,
}

/// Add a note to a fault; the fault's state stays as it is
#[derive(Debug, Args)]
pub struct NoteArguments {
    /// The fault
    id: String,
    /// Text of the note
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
        let part = self.part.as_deref().unwrap_or_default();
        if part.trim().is_empty() && self.other_part.is_none() {
            return Err(Failure::usage(Asked::RepairWithoutPart));
        }
        let id = store.resolve_fault(&self.id)?;
        let part = match &self.other_part {
            Some(other) => part::other(store, &self.scripts, other)?,
            None => part::named(store, &self.scripts, part)?,
        };
        let repair = RepairRecord {
            part,
            serial_old: self.old.clone(),
            serial_new: self.new.clone(),
            note: self.note.clone(),
        };
        let (who, at_us) = (&self.who, now_us());
        print_out(&match self.only {
            true => is_now(&id.short(), store.record_repair(id, &repair, who, at_us)?),
            false => changed(&store.repair_case(id, &repair, who, at_us)?),
        })
    }
}

impl CauseArguments {
    pub fn attribute(&self, store: &Store) -> Result<Exit, Failure> {
        let id = store.resolve_fault(&self.id)?;
        let asked = self.part.as_deref().unwrap_or_default().trim();
        let part = match (&self.other_part, asked) {
            (Some(other), _) => part::other(store, &self.scripts, other)?,
            (None, "none" | "-") => String::new(),
            (None, asked) => part::named(store, &self.scripts, asked)?,
        };
        let cause = CauseRecord {
            part: part.clone(),
            note: self.note.trim().to_owned(),
            ..CauseRecord::default()
        };
        store.set_cause(id, &cause, self.who.trim(), now_us())?;
        let terminal = &Words::shown().terminal;
        let said = match part.as_str() {
            "" => terminal.stands_alone,
            _ => terminal.comes_from,
        };
        print_out(&fill(said, &[("fault", &id.short()), ("part", &part)]))
    }
}

impl NoteArguments {
    pub fn note(&self, store: &Store) -> Result<Exit, Failure> {
        let text = self.text.trim();
        if text.is_empty() {
            return Err(Failure::usage(Asked::EmptyNote));
        }
        let id = store.resolve_fault(&self.id)?;
        store.add_note(id, self.who.trim(), text, now_us())?;
        let said = Words::shown().terminal.noted_on_fault;
        print_out(&fill(said, &[("fault", &id.short())]))
    }
}

fn is_now(fault: &str, state: FaultState) -> String {
    let words = Words::shown();
    let state = words.fault_state(state);
    fill(
        words.terminal.is_now,
        &[("fault", &fault), ("state", &state)],
    )
}

/// Says the new state of the named fault, and lists the other faults of its case that changed with it.
pub fn changed((named, rest): &(CaseFault, Vec<CaseFault>)) -> String {
    let mut text = is_now(&named.id.short(), named.state);
    for fault in rest {
        let of = [
            ("fault", &fault.id.short() as _),
            ("part", &fault.lru as _),
            ("name", &fault.code_name as _),
        ];
        text += &format!("\n  {}", fill(Words::shown().terminal.of_case, &of));
    }
    text
}
