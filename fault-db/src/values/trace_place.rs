//! A place in a trace.

use serde::Serialize;

use crate::id::Id;

/// Where in which trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct TracePlace {
    /// The trace.
    pub trace: Id,
    /// Time from its trigger, or from its first row where it has none.
    pub at_us: i64,
}
