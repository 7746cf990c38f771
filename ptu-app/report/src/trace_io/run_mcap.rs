//! A whole run as MCAP, written while it goes on: rows of all signals under the topic `signals`, and the events of
//! `docs/commands.md` under `events`.
//!
//! A message's time is the time at which the run began plus the bench time since, so that procedures whose units were
//! switched on one after the other follow each other.

use std::io::{Seek, Write};

use btu_rig::procedure::Procedure;
use fault_db::Channel;
use mcap::{McapError, Writer};
use protocol::signal::Signal;
use protocol::{Duration, Instant};

use super::mcap_write::{Topic, keys, options, put_row, schema};
use crate::event_lines::{EventLines, SCHEMA};
use ptu_runs::run::{Outcome, SessionEvent, channel, in_steps};

/// Topics of the run's rows and events.
pub(super) const SIGNALS: &str = "signals";
pub(super) const EVENTS: &str = "events";

/// The recording of one run.
pub struct RunMcap<W: Write + Seek> {
    file: Writer<W>,
    channels: Vec<Channel>,
    keys: Vec<String>,
    signals: Topic,
    events: Topic,
    lines: EventLines,
    /// Microseconds since 1970 at the beginning.
    t0_us: i64,
    /// Bench time of the procedures before the present one.
    before: Duration,
    /// Bench time of what was written last, in the present procedure.
    last: Instant,
}

impl<W: Write + Seek> RunMcap<W> {
    /// Begins the file; the run begins at `t0_us`, microseconds since 1970.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(out: W, t0_us: i64) -> Result<Self, McapError> {
        let mut file = options().create(out)?;
        let channels: Vec<_> = Signal::ALL.iter().map(|signal| channel(*signal)).collect();
        let signals = Topic::add(&mut file, SIGNALS, &schema(&channels).to_string())?;
        let events = Topic::add(&mut file, EVENTS, SCHEMA)?;
        let mut recording = Self {
            file,
            keys: keys(&channels),
            channels,
            signals,
            events,
            lines: EventLines::default(),
            t0_us,
            before: Duration::ZERO,
            last: Instant::ZERO,
        };
        let first = recording.lines.started();
        recording.put_line(&first)?;
        Ok(recording)
    }

    /// Adds an event, or rows.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn event(&mut self, procedure: &Procedure, event: &SessionEvent) -> Result<(), McapError> {
        if let SessionEvent::Rows(rows) = event {
            let mut message = Vec::new();
            for row in rows {
                self.last = row.at;
                message.clear();
                let samples = Signal::ALL.iter().map(|of| in_steps(*of, row.value(*of)));
                put_row(&mut message, &self.channels, &self.keys, samples)?;
                let at_us = self.now_us();
                self.signals.put(&mut self.file, at_us, &message)?;
            }
            return Ok(());
        }
        if let Some(line) = self.lines.event(procedure, event) {
            self.put_line(&line)?;
        }
        if let SessionEvent::Ended { bench_time } = event {
            self.before += *bench_time;
            self.last = Instant::ZERO;
        }
        Ok(())
    }

    /// Ends the file; returns the writer that was given to `begin`.
    ///
    /// # Errors
    /// A part of the file could not be written.
    pub fn finish(mut self, outcome: Option<&Outcome>) -> Result<W, McapError> {
        if let Some(outcome) = outcome {
            let last = self.lines.finished(outcome);
            self.put_line(&last)?;
        }
        self.file.finish()?;
        Ok(self.file.into_inner())
    }

    fn put_line(&mut self, line: &str) -> Result<(), McapError> {
        let at_us = self.now_us();
        self.events.put(&mut self.file, at_us, line.as_bytes())
    }

    fn now_us(&self) -> i64 {
        let bench_us = self.before.as_us() + self.last.as_us();
        self.t0_us.saturating_add_unsigned(bench_us)
    }
}
