//! `ptu run --mcap`: all signals and events of a run in an MCAP file.

use std::path::{Path, PathBuf};

use btu_rig::procedure::Procedure;

use ptu_report::trace_io::RunMcap;
use ptu_runs::clock::now_us;
use ptu_runs::failure::Failure;
use ptu_runs::new_file::{NewFile, cannot_write, kind};
use ptu_runs::run::{LinePrinter, Listener, Outcome, SessionEvent};

/// A listener that records and passes every event on. The file is there once the run has ended, whole.
pub struct RunRecording<L> {
    pub listener: L,
    recording: Option<Recording>,
}

struct Recording {
    place: PathBuf,
    /// The file; a failed write ends the recording, not the run.
    file: Result<RunMcap<NewFile>, Failure>,
}

impl<L: Listener> RunRecording<L> {
    /// Begins the recording, if one is asked for.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(listener: L, place: Option<&Path>) -> Result<Self, Failure> {
        let begin = |place: &Path| {
            let file = RunMcap::begin(NewFile::begin(place, kind::MCAP)?, now_us());
            let file = file.map_err(|error| cannot_write(place, &error))?;
            Ok::<_, Failure>(Recording {
                place: place.to_owned(),
                file: Ok(file),
            })
        };
        Ok(Self {
            listener,
            recording: place.map(begin).transpose()?,
        })
    }

    /// Ends the recording: with the run's last line, if it ended.
    ///
    /// # Errors
    /// Some of it could not be written; no file is left then.
    pub fn finish(self, outcome: Option<&Outcome>) -> (L, Result<(), Failure>) {
        let ended = self.recording.map_or(Ok(()), |recording| {
            let cannot = |error: &dyn std::fmt::Display| cannot_write(&recording.place, error);
            let file = recording.file?.finish(outcome);
            file.map_err(|error| cannot(&error))?.finish()
        });
        (self.listener, ended)
    }
}

impl<L: Listener> Listener for RunRecording<L> {
    fn on_event(&mut self, procedure: &Procedure, event: &SessionEvent) {
        if let Some(Recording { place, file }) = &mut self.recording
            && let Ok(recording) = file
            && let Err(error) = recording.event(procedure, event)
        {
            *file = Err(cannot_write(place, &error));
        }
        self.listener.on_event(procedure, event);
    }

    fn line(&self, procedure: &Procedure, event: &SessionEvent) -> Option<String> {
        self.listener.line(procedure, event)
    }

    fn line_printer(&self) -> Option<LinePrinter> {
        self.listener.line_printer()
    }
}
