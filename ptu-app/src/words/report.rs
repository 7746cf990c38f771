//! Test sheet.

use super::wordings;

wordings! {
    /// Test sheet.
    Report {
        title: "Report", "시험 성적서";
    }
}
