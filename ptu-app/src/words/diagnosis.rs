//! Parts to replace.

use super::wordings;

wordings! {
    /// Parts to replace.
    Diagnosis {
        title: "Diagnosis", "진단";
    }
}
