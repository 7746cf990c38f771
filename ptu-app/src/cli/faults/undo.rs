//! `ptu faults undo`: takes back what a person wrote last about a fault.

use clap::Args;
use fault_db::{Store, ToWithdraw};

use super::change::changed;
use crate::cli::print_out;
use protocol::display_text::line;
use ptu_report::words::{Words, fill};
use ptu_runs::clock::{local, now_us};
use ptu_runs::failure::{Exit, Failure};

/// Take back what a person last wrote about a fault, and about the other faults of its case at the same time
///
/// The history keeps the entry and its withdrawal; state, cause, repairs and counts are as if it had never been written.
/// What a run found cannot be taken back, nor an entry on which a later run or another person's entry depends: correct
/// these by a new state or a note.
#[derive(Debug, Args)]
pub struct UndoArguments {
    /// The fault
    id: String,
    /// Who takes it back
    #[arg(long, value_name = "TEXT", default_value = "")]
    who: String,
    /// Why
    #[arg(long, value_name = "TEXT", default_value = "")]
    note: String,
    /// Only the entry of this fault, not the entries of the others of its case
    #[arg(long)]
    only: bool,
}

impl UndoArguments {
    pub fn undo(&self, store: &Store) -> Result<Exit, Failure> {
        let id = store.resolve_fault(&self.id)?;
        let what = ToWithdraw {
            only: self.only,
            ..ToWithdraw::default()
        };
        let withdrawn = store.withdraw(id, what, self.who.trim(), self.note.trim(), now_us())?;
        let words = Words::shown();
        let by = match &*withdrawn.who {
            "" => String::new(),
            who => fill(words.counts.by_whom, &[("who", &line(who))]),
        };
        let kind = words.event_kind(&withdrawn.kind);
        let of = [
            ("kind", &kind as _),
            ("at", &local(withdrawn.at_us) as _),
            ("by", &by as _),
        ];
        let head = fill(words.counts.withdrawn, &of);
        let mut faults = withdrawn.faults.into_iter();
        let said = faults
            .next()
            .map(|named| changed(&(named, faults.collect())));
        print_out(&format!("{head}\n{}", said.unwrap_or_default()))
    }
}
