//! `ptu db sync`: exchanges this laptop's history with a server.

use std::time::Instant;

use clap::Args;
use fault_db::{Address, Store, StoreError, SyncOptions, SyncOutcome, SyncPhase, SyncProgress};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use super::maintenance::{rivals, told_refused};
use crate::cli::{Database, Json, answered};
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::platform::computer_name;
use ptu_runs::stop::Stop;
use ptu_runs::{clock, stdio};

/// Send this laptop's history to a server, and receive what others recorded about its faults
///
/// The laptop's file is complete at all times. The next sync continues one that broke off.
///
/// Exit codes: 0 done, 2 wrong address, 3 no server, or something is damaged or differs, 130 stopped.
#[derive(Debug, Args)]
pub struct SyncArguments {
    /// The server, as postgres://USER@HOST/DATABASE; write a password into ~/.pgpass
    #[arg(value_name = "ADDRESS")]
    server: String,
    /// Leave samples for a later sync
    #[arg(long)]
    no_traces: bool,
    /// The file is a copy or a backup with which this laptop continues: it gets a name of its own
    #[arg(long)]
    as_copy: bool,
    #[command(flatten)]
    json: Json,
}

impl SyncArguments {
    pub(super) fn run(&self, database: &Database) -> Result<Exit, Failure> {
        let begun = Instant::now();
        // Not while the command line is read: what is wrong there is shown as it stands, password and all.
        let address: Address = self.server.parse()?;
        // A name that was mistyped would be synced as a new, empty history.
        let path = database.file()?;
        if !path.exists() {
            return Err(StoreError::Missing { path }.into());
        }
        let file = database.open_file()?;
        let server = Store::connect(&address, clock::ids())?;
        let stop = Stop::default();
        let asked = stop.clone();
        // A server that has fallen silent ends no batch: a second press does not wait for it.
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
        let document = || as_json(&outcome, &server, took_s);
        let told = (self.json).answer(document, || text(&outcome, &server, took_s));
        for warning in warnings(&outcome) {
            stdio::note(&warning);
        }
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

fn text(outcome: &SyncOutcome, server: &Store, took_s: f64) -> String {
    let mut text = format!(
        "{}\nsent      {} runs, {} occurrences, {} events, {} notes, {} traces\nreceived  {} events on {} faults",
        server.path().display(),
        outcome.runs,
        outcome.occurrences,
        outcome.events,
        outcome.notes,
        outcome.traces,
        outcome.events_received,
        outcome.faults_changed,
    );
    if outcome.already_there > 0 {
        text += &format!(
            "\nknown     {} entries were there already",
            outcome.already_there
        );
    }
    if outcome.waiting > 0 {
        text += &format!("\nwaiting   {} entries for the next sync", outcome.waiting);
    }
    text + &format!("\n{:.1} MB in {took_s:.1} s", outcome.bytes as f64 / 1e6)
}

/// What a person should know, with the next move.
fn warnings(outcome: &SyncOutcome) -> Vec<String> {
    let mut all = Vec::new();
    if outcome.stopped {
        all.push("stopped; the next sync goes on from here".to_owned());
    }
    if outcome.clocks_differ() {
        let way = if outcome.clock_offset_us > 0 {
            "ahead of"
        } else {
            "behind"
        };
        all.push(format!(
            "this computer's clock is {} {way} the server's; set it, or its times will puzzle people",
            span(outcome.clock_offset_us.unsigned_abs())
        ));
    }
    for different in &outcome.different {
        all.push(match different.what {
            "chain" => format!(
                "of database {}, whose runs came here, the server knows another history: one of them is a copy that went on by itself; look with `ptu db check`",
                different.id.short()
            ),
            what => format!(
                "{what} {} does not say the same here and on the server; both were left as they are: look with `ptu db check`",
                different.id
            ),
        });
    }
    for trace in &outcome.damaged_traces {
        all.push(format!(
            "trace {trace} is damaged and was not sent; look with `ptu db check`"
        ));
    }
    all.extend(told_refused(&outcome.refused));
    all.extend(
        outcome
            .conflicts
            .iter()
            .map(|conflict| rivals(conflict).trim().to_owned()),
    );
    all
}

/// A length of time in the words of a person.
fn span(us: u64) -> String {
    let s = us / 1_000_000;
    match s {
        0..120 => format!("{s} s"),
        120..7_200 => format!("{} min", s / 60),
        7_200..172_800 => format!("{} h", s / 3_600),
        _ => format!("{} days", s / 86_400),
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
        let what = match progress.phase {
            SyncPhase::Sending => "sending runs and events",
            SyncPhase::SendingTraces => "sending traces",
            SyncPhase::Receiving => "receiving events",
        };
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
        if !stdio::draws() {
            stdio::note(what);
            return;
        }
        let style = match progress.total {
            0 => "{pos}  {elapsed}  {msg}",
            _ => "{bar:30} {pos}/{len}  {elapsed} (left {eta})  {msg}",
        };
        let style =
            ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::new(progress.total)
            .with_style(style)
            .with_message(what);
        self.bar = Some(bar);
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_difference_is_given_as_text() {
        let off_by = |clock_offset_us| {
            let outcome = SyncOutcome {
                clock_offset_us,
                ..SyncOutcome::default()
            };
            warnings(&outcome).concat()
        };
        assert_eq!(off_by(-2_900_000), "");
        for (us, words) in [
            (4_000_000, "4 s ahead of"),
            (-600_000_000, "10 min behind"),
            (10_800_000_000, "3 h ahead of"),
            (-31_536_000_000_000, "365 days behind"),
        ] {
            let said = off_by(us);
            assert!(said.contains(words), "{said}");
        }
    }
}
