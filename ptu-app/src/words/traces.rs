//! Recorded traces.

use super::wordings;

wordings! {
    /// Recorded traces.
    Traces {
        title: "Traces", "트레이스";
    }
}
