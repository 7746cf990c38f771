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
    /// The run that is asked about, then those of the same unit that are evidence, too.
    ///
    /// # Errors
    /// There is no such run, or one is no evidence about the same unit.
    pub fn read_all(store: &Store, asked: Id, with: &[Id]) -> Result<Vec<Self>, Failure> {
        let mut runs = vec![Self::read(store, asked)?];
        for id in with {
            let other = Self::read(store, *id)?;
            runs[0].same_unit(&other)?;
            runs.push(other);
        }
        Ok(runs)
    }

    fn read(store: &Store, id: Id) -> Result<Self, Failure> {
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
    fn same_unit(&self, other: &Self) -> Result<(), Failure> {
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
