//! `ptu run --json` and `--events FILE`: each event of a run as a JSON line, on standard output or in a file.

use std::fmt;
use std::fs::OpenOptions;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver, SyncSender, TrySendError};
use std::thread::JoinHandle;

use btu_rig::procedure::Procedure;

use ptu_report::event_lines::EventLines;
use ptu_runs::failure::{Asked, Failure, FileTrouble, Why};
use ptu_runs::new_file::{NewFile, kind};
use ptu_runs::run::{Outcome, SessionEvent};
use ptu_runs::stdio;

/// Most lines that wait for a reader. A reader that falls further behind ends the stream, not the run.
const WAITING: usize = 65_536;

#[derive(Clone, Debug)]
pub enum StreamTarget {
    /// Standard output, which then carries nothing else.
    Stdout,
    File(PathBuf),
}

impl fmt::Display for StreamTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stdout => f.write_str("--json: standard output"),
            Self::File(file) => write!(f, "--events: {}", file.display()),
        }
    }
}

pub struct EventStream {
    lines: EventLines,
    to: Option<SyncSender<String>>,
    thread: JoinHandle<std::io::Result<()>>,
    place: StreamTarget,
    is_cut: bool,
}

impl EventStream {
    /// # Errors
    /// The file cannot be written.
    pub fn begin(place: StreamTarget) -> Result<Self, Failure> {
        let cannot = |error: &dyn fmt::Display| {
            Failure::usage(FileTrouble::Unwritten(place.to_string(), Why::of(error)))
        };
        let mut event_lines = EventLines::default();
        let first = event_lines.started();
        let mut is_begun = false;
        let out: Box<dyn Write + Send> = match &place {
            StreamTarget::Stdout => Box::new(stdio::stdout()),
            // A pipe or device is written to directly.
            StreamTarget::File(file) if std::fs::metadata(file).is_ok_and(|of| !of.is_file()) => {
                let opened = OpenOptions::new().write(true).open(file);
                Box::new(opened.map_err(|error| cannot(&error))?)
            }
            // The file appears at its place with its first line: other programs read it while it grows.
            StreamTarget::File(file) => {
                let begun = NewFile::begin(file, kind::EVENTS);
                let mut file = begun.map_err(|why| why.because_of(Asked::Option("--events")))?;
                writeln!(file, "{first}").map_err(|error| cannot(&error))?;
                file.appear()?;
                is_begun = true;
                Box::new(file)
            }
        };
        let (to, lines) = mpsc::sync_channel(WAITING);
        let thread = std::thread::Builder::new()
            .name("events".into())
            .spawn(move || match write(&lines, out) {
                // A reader that has closed the pipe wants no more lines: no failure.
                Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
                written => written,
            });
        let thread = thread.map_err(|error| cannot(&error))?;
        let mut stream = Self {
            lines: event_lines,
            to: Some(to),
            thread,
            place,
            is_cut: false,
        };
        if !is_begun {
            stream.put(first);
        }
        Ok(stream)
    }

    pub fn event(&mut self, procedure: &Procedure, event: &SessionEvent) {
        if self.to.is_some()
            && let Some(line) = self.lines.event(procedure, event)
        {
            self.put(line);
        }
    }

    fn put(&mut self, line: String) {
        let sent = self.to.as_ref().map(|to| to.try_send(line));
        if let Some(Err(error)) = sent {
            // If the queue is full the stream ends, so that no line is missing between two others. If the thread has
            // ended, `finish` says why.
            self.is_cut = matches!(error, TrySendError::Full(_));
            self.to = None;
        }
    }

    /// Ends the stream; if the run has an outcome, writes the outcome as the last line.
    ///
    /// # Errors
    /// A part of the stream could not be written.
    pub fn finish(mut self, outcome: Option<&Outcome>) -> Result<(), Failure> {
        if let Some(outcome) = outcome {
            let last = self.lines.finished(outcome);
            self.put(last);
        }
        drop(self.to.take());
        let written = self.thread.join();
        let failed = |why| Failure::bench(Asked::NotAllEvents(self.place.to_string(), why));
        match written {
            Ok(Ok(())) if self.is_cut => Err(failed(Why::SlowReader)),
            Ok(Ok(())) => Ok(()),
            Ok(Err(error)) => Err(failed(Why::of(error))),
            Err(_) => Err(failed(Why::ThreadEnded)),
        }
    }
}

/// Writes lines as they come, and flushes whenever no further line waits.
fn write(lines: &Receiver<String>, out: impl Write) -> std::io::Result<()> {
    let mut out = BufWriter::new(out);
    while let Ok(line) = lines.recv() {
        writeln!(out, "{line}")?;
        while let Ok(line) = lines.try_recv() {
            writeln!(out, "{line}")?;
        }
        out.flush()?;
    }
    Ok(())
}
