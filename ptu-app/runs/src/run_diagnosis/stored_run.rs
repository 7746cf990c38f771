//! What a diagnosis reads of a stored run.

use fault_db::{Id, RunDetail, RunOccurrence, Store};

use crate::failure::{DiagnosisTrouble, Failure};
use crate::replay::{Original, first_traces};

/// A stored run with its faults and the traces that can be repeated.
pub(super) struct StoredRun {
    pub run: RunDetail,
    pub occurrences: Vec<RunOccurrence>,
    pub traces: Vec<Original>,
}

impl StoredRun {
    pub fn read(store: &Store, id: Id) -> Result<Self, Failure> {
        let run = store.run(id)?;
        let occurrences = store.run_occurrences(id)?;
        Ok(Self {
            traces: first_traces(store, &occurrences),
            run,
            occurrences,
        })
    }

    /// Refuses another run that is no evidence about the same unit.
    ///
    /// # Errors
    /// It is of another unit, or this very run.
    pub fn same_unit(&self, other: &Self) -> Result<(), Failure> {
        let (this, that) = (&self.run.run, &other.run.run);
        if this.id == that.id {
            return Err(Failure::usage(DiagnosisTrouble::RunTwice(that.id)));
        }
        if this.unit_serial != that.unit_serial
            || this.unit_config_sha256 != that.unit_config_sha256
        {
            return Err(Failure::usage(DiagnosisTrouble::OtherUnit(
                that.id,
                that.unit_serial.clone(),
                that.unit_config_name.clone(),
                this.unit_serial.clone(),
                this.unit_config_name.clone(),
            )));
        }
        Ok(())
    }
}
