//! Recorded values, and their words.

pub(crate) mod event;
pub(crate) mod fault_state;
pub(crate) mod record;
pub(crate) mod step_counts;
pub(crate) mod text_enum;
pub(crate) mod trace_place;
pub(crate) mod withdrawal_error;
