//! A text in both languages.

use diagnosis::CheckName;

use super::super::content;

/// A text in English and in Korean.
pub(super) type Both = [String; 2];

/// Procedure and step.
pub(super) fn checked(check: &CheckName) -> Both {
    let korean = content::korean(&check.step);
    [check.to_string(), format!("{}: {korean}", check.procedure)]
}
