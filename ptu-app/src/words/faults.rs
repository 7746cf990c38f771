//! Fault history.

use super::wordings;

wordings! {
    /// Fault history.
    Faults {
        title: "Faults", "고장 이력";
    }
}
