//! `ptu db sync`: exchanges this laptop's history with a server.

use std::time::Instant;

use clap::Args;
use fault_db::{Address, Store, StoreError, SyncOptions, SyncOutcome, SyncPhase, SyncProgress};
use indicatif::ProgressBar;
use serde_json::json;

use crate::cli::{Database, Json, answered};
use ptu_report::care::{self, Said};
use ptu_report::words::{Words, fill};
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::platform::computer_name;
use ptu_runs::stop::Stop;
use ptu_runs::{clock, progress, stdio};

/// Send this laptop's history to a server, and receive what others recorded about its faults
///
/// The laptop's file is complete at all times. A sync that broke off is continued by the next sync.
///
/// Exit codes: 0 done, 2 wrong address, 3 no server, or something is damaged or differs, 130 stopped.
#[derive(Debug, Args)]
pub struct SyncArguments {
    /// The server, as postgres://USER@HOST/DATABASE; write a password into ~/.pgpass
    #[arg(value_name = "ADDRESS")]
    server: String,
    /// Leave the samples of traces for a later sync
    #[arg(long)]
    no_traces: bool,
    /// The file is a copy or a backup with which this laptop continues: the file gets an identity of its own
    #[arg(long)]
    as_copy: bool,
    #[command(flatten)]
    json: Json,
}

impl SyncArguments {
    pub(super) fn run(&self, database: &Database) -> Result<Exit, Failure> {
        let begun = Instant::now();
        // Not parsed by clap, whose error would show a wrong address with its password.
        let address: Address = self.server.parse()?;
        // A mistyped name must not be synced as a new, empty history.
        let path = database.file()?;
        if !path.exists() {
            return Err(StoreError::Missing(path).into());
        }
        let file = database.open_file()?;
        let server = Store::connect(&address, clock::ids())?;
        let stop = Stop::default();
        let asked = stop.clone();
        // A batch does not end while the server is silent: a second Ctrl-C ends the program at once.
        stop.listen_and(move || {
            if asked.presses() > 1 {
                std::process::exit(Exit::Aborted.code().into());
            }
        });
        let mut shown = ProgressLine::default();
        let outcome = file.sync(
            &server,
            &mut SyncOptions {
                laptop: &computer_name(),
                traces: !self.no_traces,
                as_copy: self.as_copy,
                now_us: &clock::now_us,
                go_on: &mut |progress| {
                    shown.tell(progress);
                    stop.presses() == 0
                },
            },
        );
        drop(shown);
        let outcome = outcome?;
        file.close()?;
        let took_s = begun.elapsed().as_secs_f64();
        let words = Words::shown();
        let Said { text, notes } = care::synced(&outcome, words);
        let document = || as_json(&outcome, &server, took_s);
        let text = || {
            let mb = format!("{:.1}", outcome.bytes as f64 / 1e6);
            let s = format!("{took_s:.1}");
            let took = fill(words.care.took, &[("mb", &mb), ("s", &s)]);
            format!("{}\n{text}\n{took}", server.path().display())
        };
        let told = self.json.answer(document, text);
        notes.iter().for_each(|note| stdio::note(note));
        let exit = if outcome.stopped {
            Exit::Aborted
        } else if outcome.different.is_empty()
            && outcome.damaged_traces.is_empty()
            && outcome.refused.is_empty()
        {
            Exit::Passed
        } else {
            Exit::Bench
        };
        answered(told, exit)
    }
}

fn as_json(outcome: &SyncOutcome, server: &Store, took_s: f64) -> serde_json::Value {
    json!({
        "server": server.path().to_string_lossy(),
        "sent": {
            "runs": outcome.runs,
            "occurrences": outcome.occurrences,
            "events": outcome.events,
            "notes": outcome.notes,
            "traces": outcome.traces,
        },
        "received": {
            "events": outcome.events_received,
            "faults": outcome.faults_changed,
        },
        "already_there": outcome.already_there,
        "waiting": outcome.waiting,
        "bytes": outcome.bytes,
        "took_s": took_s,
        "clock_offset_s": outcome.clock_offset_us as f64 / 1e6,
        "conflicts": outcome.conflicts,
        "different": outcome.different,
        "damaged_traces": outcome.damaged_traces,
        "refused": outcome.refused,
        "stopped": outcome.stopped,
    })
}

/// Progress on stderr: a bar on a terminal, a line for each phase elsewhere.
#[derive(Default)]
struct ProgressLine {
    phase: Option<SyncPhase>,
    bar: Option<ProgressBar>,
}

impl ProgressLine {
    fn tell(&mut self, progress: SyncProgress) {
        if self.phase != Some(progress.phase) {
            self.phase = Some(progress.phase);
            self.begin(progress);
        }
        if let Some(bar) = &self.bar {
            bar.set_position(progress.done);
        }
    }

    fn begin(&mut self, progress: SyncProgress) {
        let what = Words::shown().care.phase(progress.phase);
        self.bar = None;
        if !stdio::draws() {
            stdio::note(what);
            return;
        }
        let form = match progress.total {
            0 => "{pos}  {elapsed}  {msg}",
            _ => "{bar:30} {pos}/{len}  {elapsed}  {msg}",
        };
        self.bar = Some(progress::bar(progress.total, form).with_message(what));
    }
}
