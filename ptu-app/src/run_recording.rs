//! `ptu run --mcap`: all signals and events of a run in an MCAP file.

use std::path::{Path, PathBuf};

use btu_rig::procedure::Procedure;

use ptu_report::trace_io::RunMcap;
use ptu_runs::clock::now_us;
use ptu_runs::failure::Failure;
use ptu_runs::new_file::{NewFile, cannot_write, kind};
use ptu_runs::run::{Outcome, SessionEvent};

/// Recording of a run. The file appears, complete, only when the run has ended.
pub struct RunRecording {
    place: PathBuf,
    /// The file; a failed write ends the recording, not the run.
    file: Result<RunMcap<NewFile>, Failure>,
}

impl RunRecording {
    /// # Errors
    /// The file cannot be written.
    pub fn begin(place: &Path) -> Result<Self, Failure> {
        let file = RunMcap::begin(NewFile::begin(place, kind::MCAP)?, now_us());
        let file = file.map_err(|error| cannot_write(place, &error))?;
        Ok(Self {
            place: place.to_owned(),
            file: Ok(file),
        })
    }

    pub fn event(&mut self, procedure: &Procedure, event: &SessionEvent) {
        if let Ok(file) = &mut self.file
            && let Err(error) = file.event(procedure, event)
        {
            self.file = Err(cannot_write(&self.place, &error));
        }
    }

    /// Ends the recording; if the run has an outcome, writes the outcome as the last line.
    ///
    /// # Errors
    /// A part of the recording could not be written; then no file is left.
    pub fn finish(self, outcome: Option<&Outcome>) -> Result<(), Failure> {
        let file = self.file?.finish(outcome);
        file.map_err(|error| cannot_write(&self.place, &error))?
            .finish()
    }
}
