//! A text in both languages.

use diagnosis::CheckName;

use super::super::content;

/// A text in English and in Korean.
pub(super) type Both = [String; 2];

pub(super) fn both<const N: usize>(texts: [(&str, &str); N]) -> [Both; N] {
    texts.map(|(english, korean)| [english.to_owned(), korean.to_owned()])
}

/// Procedure and step.
pub(super) fn checked(check: &CheckName) -> Both {
    let korean = content::korean(&check.step);
    [check.to_string(), format!("{}: {korean}", check.procedure)]
}
