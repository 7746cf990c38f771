//! Widgets that several pages use.

pub mod bars;
mod chip;
mod deliberate;
mod edit;
mod file;
pub mod lane;
mod limit_bar;
mod link;
pub mod look_back;
mod memory;
mod named;
mod open_file;
mod rows;
mod run_list;
mod run_note;
mod serial_link;
mod share_bar;
mod split;
mod unit_filter;

pub use chip::{chip, verdict_chip};
pub use deliberate::ActionPlace;
pub use edit::{field, go_on, name_edit, note_edit, typed};
pub use file::usual_folder;
pub use limit_bar::{limit_bar, value_text};
pub use link::link;
pub use memory::{MemoryReader, Stored};
pub use named::named_combo;
pub use open_file::open_file;
pub use rows::rows;
pub use run_list::RunList;
pub use run_note::RunNoteForm;
pub use serial_link::{repair_line, serial_link};
pub use share_bar::share_bar;
pub use split::FirstHalf;
pub use unit_filter::UnitFilter;
