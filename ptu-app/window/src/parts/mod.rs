//! Widgets that several pages use.

pub mod bars;
mod card;
mod chip;
mod deliberate;
mod dialog;
mod edit;
mod face;
mod file;
#[cfg(test)]
mod gallery;
mod job;
pub mod lane;
mod limit_bar;
mod link;
pub mod look_back;
mod memory;
mod menu;
mod open_file;
mod pick;
mod progress;
mod rows;
mod run_list;
mod run_note;
mod saved_questions;
mod segments;
mod serial_link;
mod share_bar;
mod sheet_view;
mod side;
mod stepper;
mod table;
mod unit_filter;

pub use card::{Card, choice, empty, fact, ground, title};
pub use chip::{chip, verdict_chip, verdict_look};
pub use deliberate::{ActionPlace, key_pressed};
pub use dialog::{dialog, dialog_is_open, last_row, over_page};
pub use edit::{
    caption, field, find_edit, go_on, name_edit, name_input, note_edit, path_edit, typed,
};
pub use face::{Face, Look, dashed_outline, focus_ring, selectable};
pub use file::{file_place, usual_folder};
pub use job::{Done, Job, Told};
pub use limit_bar::{limit_bar, limit_scale, limits_within, value_text};
pub use link::link;
pub use memory::{MemoryReader, Stored};
pub use menu::{before_more, menu, more};
pub use open_file::open_file;
pub use pick::{named_combo, names, pick};
pub use progress::{progress, progress_text, running_text};
pub use rows::rows;
pub use run_list::RunList;
pub use run_note::{NoteOn, RunNoteForm};
pub use saved_questions::{SavedQuestion, SavedSaid, saved_questions};
pub use segments::segments;
pub use serial_link::{repair_line, serial_link};
pub use share_bar::share_bar;
pub use sheet_view::{drawings, show_drawings, show_sheet};
pub use side::{FORM, Side, foot, form};
pub use stepper::Step;
pub use table::{Cell, Column, Table};
pub use unit_filter::UnitFilter;
