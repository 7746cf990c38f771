//! Longest texts that are stored, checked in one place for the window, the command line and the wire.
//!
//! A longer text from a user or a file is refused before anything is done with it. A longer message of the
//! program about a unit under test is truncated: refusing it would lose the measurement.

use std::borrow::Cow;

use crate::error::StoreError;
use crate::values::record::{CauseRecord, RepairRecord, RunRecord, StepRecord};

/// Longest name, in characters: of a person, a train, a part, a serial number, a step, a data file.
pub const MOST_NAME: usize = 255;
/// Longest note or message, in characters.
pub const MOST_TEXT: usize = 4_000;
/// Longest path of a script, place of a unit or list of injected faults, in characters.
pub const MOST_LIST: usize = 16_000;

/// Refuses a name longer than [`MOST_NAME`]; `what` is, for instance, "the operator's name".
///
/// # Errors
/// The name is too long.
pub fn name(what: &'static str, text: &str) -> Result<(), StoreError> {
    most(what, text, MOST_NAME)
}

/// Refuses a note longer than [`MOST_TEXT`]; `what` is, for instance, "the note".
///
/// # Errors
/// The note is too long.
pub fn note(what: &'static str, text: &str) -> Result<(), StoreError> {
    most(what, text, MOST_TEXT)
}

/// Refuses a list, such as paths or a query, longer than [`MOST_LIST`].
///
/// # Errors
/// The list is too long.
pub fn list(what: &'static str, text: &str) -> Result<(), StoreError> {
    most(what, text, MOST_LIST)
}

fn most(what: &'static str, text: &str, most: usize) -> Result<(), StoreError> {
    // No text has more characters than bytes, and most are short.
    let length = match text.len() {
        short if short <= most => return Ok(()),
        _ => text.chars().count(),
    };
    match length > most {
        true => Err(StoreError::TextTooLong { what, length, most }),
        false => Ok(()),
    }
}

/// A message, cut to [`MOST_TEXT`] characters if it is longer, then ending in `…`.
pub(crate) fn cut(message: &str) -> Cow<'_, str> {
    let mut letters = message.char_indices();
    match (letters.nth(MOST_TEXT - 1), letters.next()) {
        (Some((end, _)), Some(_)) => Cow::Owned(format!("{}…", &message[..end])),
        _ => Cow::Borrowed(message),
    }
}

impl RunRecord {
    /// Checks the lengths of a run's texts, before a unit is touched.
    ///
    /// # Errors
    /// One of them is too long.
    pub fn check(&self) -> Result<(), StoreError> {
        name("the unit's serial number", &self.unit.serial)?;
        name("the unit's kind", &self.unit.kind)?;
        name("the unit configuration's name", &self.unit.config_name)?;
        for (part, version) in &self.unit.sw_versions {
            name("the name of a part of the unit", part)?;
            name("a software version", version)?;
        }
        name("the line's name", &self.line)?;
        name("the train's name", &self.train)?;
        name("the operator's name", &self.operator)?;
        list("the unit's place", &self.source)?;
        name(
            "the unit's connection",
            self.connection.as_deref().unwrap_or_default(),
        )?;
        name("the symptom", self.symptom.as_deref().unwrap_or_default())?;
        let injected = self.injected.as_deref().unwrap_or_default();
        list("the list of injected faults", injected)?;
        for script in &self.scripts {
            list("a script's path", &script.path)?;
        }
        Ok(())
    }
}

impl RepairRecord {
    /// Checks the texts of a repair.
    ///
    /// # Errors
    /// One of them is too long.
    pub fn check(&self) -> Result<(), StoreError> {
        name("the part's name", &self.part)?;
        for serial in [&self.serial_old, &self.serial_new].into_iter().flatten() {
            name("the part's serial number", serial)?;
        }
        note("the note", &self.note)
    }
}

impl CauseRecord {
    /// Checks the texts of an attribution.
    ///
    /// # Errors
    /// One of them is too long.
    pub(crate) fn check(&self) -> Result<(), StoreError> {
        name("the part's name", &self.part)?;
        note("the note", &self.note)
    }
}

impl StepRecord {
    /// Checks the names of a step.
    pub(crate) fn check(&self) -> Result<(), StoreError> {
        list("the procedure's name", &self.procedure)?;
        // The name in the script, with the number of the repetition.
        most("the step's name", &self.name, 2 * MOST_NAME)?;
        for measured in &self.measurements {
            name("the measurement's name", &measured.name)?;
        }
        let measured = self.measurements.iter().map(|m| &m.limit_source);
        for source in measured.chain([&self.limit_source]).flatten() {
            list("the source of a limit", source)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_measured_in_characters() {
        assert!(name("the name", &"가".repeat(MOST_NAME)).is_ok());
        let error = name("the operator's name", &"가".repeat(MOST_NAME + 1)).expect_err("too long");
        assert_eq!(
            error.to_string(),
            "the operator's name has 256 characters, and at most 255 are kept; shorten it"
        );
    }

    #[test]
    fn a_message_is_cut_and_says_so() {
        let exact = "é".repeat(MOST_TEXT);
        assert_eq!(cut(&exact), exact);
        let longer = format!("{exact}x");
        let longer = cut(&longer);
        assert_eq!(longer.chars().count(), MOST_TEXT);
        assert!(longer.ends_with('…'));
        assert_eq!(cut("short"), "short");
    }
}
