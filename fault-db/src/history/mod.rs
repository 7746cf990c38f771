//! Writes a history: runs as they happen, and what people say of their faults.

pub(crate) mod cases;
mod compression;
pub(crate) mod conflicts;
pub(crate) mod dictionaries;
pub(crate) mod event_graph;
pub(crate) mod fault_event;
mod fault_log;
pub(crate) mod graph_sql;
pub(crate) mod insert;
pub(crate) mod instruments;
pub mod limits;
pub(crate) mod recording;
pub(crate) mod recurrence;
pub(crate) mod run_notes;
pub(crate) mod run_writer;
pub(crate) mod verify;
pub(crate) mod withdrawal;
