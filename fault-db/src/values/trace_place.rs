//! A place in a trace.

use serde::Serialize;

use crate::id::Id;

/// A place in a trace, to which a note may refer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct TracePlace {
    /// The trace.
    pub trace: Id,
    /// Time from the trace's trigger, or from its first row if it has no trigger, µs.
    pub at_us: i64,
}
