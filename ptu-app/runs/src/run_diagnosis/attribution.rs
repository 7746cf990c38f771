//! Attributes the faults of a run that failed to the part that its diagnosis found.

use fault_db::{CauseRecord, Store, Verdict};

use super::Answer;
use crate::clock::now_us;
use crate::failure::Failure;

impl Answer {
    /// Stores what each fault of the run comes from. Nothing is stored of a run that did not fail, nor where the
    /// diagnosis has a warning, or found no part; a fault that a person has attributed stays as it is.
    ///
    /// # Errors
    /// The database does not take it.
    pub fn attribute(&self, store: &Store) -> Result<(), Failure> {
        if self.run.run.verdict != Some(Verdict::Failed) || !self.warnings.is_empty() {
            return Ok(());
        }
        if let Some((cause, faults)) = &self.cause {
            let record = CauseRecord {
                part: cause.lru.to_string(),
                run: Some(self.run.run.id.to_string()),
                probability: Some(cause.probability),
                note: String::new(),
            };
            store.attribute_diagnosed(faults, &record, now_us())?;
        }
        Ok(())
    }
}
