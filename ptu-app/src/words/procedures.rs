//! Choosing and running procedures.

use super::wordings;

wordings! {
    /// Choosing and running procedures.
    Procedures {
        title: "Procedures", "시험 절차";
    }
}
