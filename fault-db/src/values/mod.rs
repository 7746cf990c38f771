//! The values that are recorded, and the words for them in the database.

pub(crate) mod event;
pub(crate) mod fault_state;
pub(crate) mod record;
pub(crate) mod step_counts;
pub(crate) mod text_enum;
pub(crate) mod trace_place;
pub(crate) mod withdrawal_error;
