//! Widgets that several pages use.

mod chip;
mod deliberate;
mod edit;
mod file;
pub mod lane;
mod limit_bar;
mod memory;
mod named;
mod run_list;
mod run_note;
mod share_bar;

pub use chip::{chip, verdict_chip};
pub use deliberate::ActionPlace;
pub use edit::{name_edit, note_edit};
pub use file::usual_folder;
pub use limit_bar::{limit_bar, value_text};
pub use memory::{MemoryReader, Stored};
pub use named::{named_cell, named_combo};
pub use run_list::RunList;
pub use run_note::RunNoteForm;
pub use share_bar::share_bar;
