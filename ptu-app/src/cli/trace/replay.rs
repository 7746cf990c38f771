//! `ptu trace replay`: repeats the recorded stimuli of a trace on a unit.

use btu_rig::rig::{Harness, check_places};
use clap::Args;
use fault_db::limits;
use ptu_report::words::{Words, fill};
use serde_json::json;

use super::explained::{compared, deviations_json, deviations_text};
use crate::cli::reports::ReportOption;
use crate::cli::{Database, Json, ScriptsOption, answered};
use ptu_runs::failure::{Exit, Failure, RunTrouble};
use ptu_runs::link::Endpoint;
use ptu_runs::replay::{Original, ReplayMatch, Rerun, Rerunning, rerun};
use ptu_runs::run::check_bench_faults;
use ptu_runs::stop::Stop;

/// Repeat the stimuli of a trace on the simulated unit or one on a port, and compare the responses
///
/// The replay is stored as a run with a trace of its own. The answer is `reproduced` if the unit responds as in the
/// trace, else `not reproduced`, with whether it responds as the good twin (a sound unit with the same stimuli). The
/// verdict is on the unit: passed if it responds as the good twin.
///
/// Examples:
///   ptu trace replay latest                                on a sound simulated unit
///   ptu trace replay latest --inject eb_relay.slow         is it this fault?
///   ptu trace replay 59c2ce97 --unit serial:/dev/ttyUSB0   the unit on the bench
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct ReplayArguments {
    /// The trace
    id: String,
    /// The unit: sim, serial:PATH[@BAUD], tcp:HOST:PORT or lockstep:PATH
    #[arg(long, value_name = "UNIT", default_value = "sim")]
    unit: Endpoint,
    /// Faults to inject into the simulated unit, or into the train around any unit, see `ptu catalog faults`
    #[arg(long, value_name = "FAULT[,FAULT]", value_delimiter = ',')]
    inject: Vec<String>,
    /// Who tests
    #[arg(long, value_name = "TEXT", default_value = "")]
    who: String,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    reports: ReportOption,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl ReplayArguments {
    pub fn run(self, database: &Database) -> Result<Exit, Failure> {
        let directory = self.scripts.find()?;
        let faults = directory.chosen_faults(&self.inject)?;
        if self.unit != Endpoint::Sim && faults.iter().any(|fault| fault.place.in_unit()) {
            return Err(Failure::usage(RunTrouble::InjectElsewhere));
        }
        self.reports.check()?;
        limits::name("the operator's name", &self.who)?;
        // Opened for reading first: a trace that does not exist must not make a database.
        let store = database.open_read_only()?;
        let original = Original::read(&store, store.resolve_trace(&self.id)?)?;
        drop(store);
        let setup = original.made.setup(&directory)?;
        let by_numbers = setup.waveforms.is_none() && setup.harness != Harness::None;
        check_bench_faults(&faults, by_numbers)?;
        check_places(&faults, &setup.train)
            .map_err(|wrong| Failure::usage(RunTrouble::Misplaced(wrong.to_string())))?;
        let store = database.open()?;
        let stop = Stop::default();
        stop.listen();
        let rerunning = Rerunning {
            endpoint: self.unit.clone(),
            faults,
            operator: self.who.clone(),
        };
        let rerun = rerun(&store, &directory, &original, &rerunning, &stop)?;
        let detail = store.run(rerun.run_id)?;
        let document = || rerun_json(&original, &rerun);
        let told = self.json.answer(document, || text(&original, &rerun));
        self.reports.write(&store, &directory, &detail)?;
        store.close()?;
        answered(told, rerun.exit)
    }
}

fn text(original: &Original, rerun: &Rerun) -> String {
    let words = Words::shown();
    let traces = &words.traces;
    let mut lines = vec![
        fill(
            traces.of_trace,
            &[
                ("trace", &original.id.short()),
                ("procedure", &original.procedure),
                ("source", &original.made.source),
            ],
        ),
        fill(
            traces.replayed,
            &[
                ("trace", &rerun.trace_id.short()),
                ("run", &rerun.run_id.short()),
                ("unit", &rerun.serial),
            ],
        ),
        words.told(&rerun.likeness),
        compared(rerun.from_original.window_s, words),
    ];
    if let (ReplayMatch::Otherwise, Some((signal, again))) = (rerun.likeness, &rerun.first_again) {
        let said = if *again {
            traces.again
        } else {
            traces.not_again
        };
        lines.push(fill(said, &[("signal", &words.signal(signal))]));
    }
    if let Some(why) = &rerun.cut_short {
        lines.push(fill(traces.broken_off, &[("why", why)]));
    }
    if !rerun.refused.is_empty() {
        lines.push(fill(traces.refused, &[("what", &rerun.refused.join("; "))]));
    }
    if matches!(rerun.likeness, ReplayMatch::AsTwin | ReplayMatch::Otherwise) {
        let of = (traces.of_replay, traces.of_original);
        lines.push(deviations_text(&rerun.from_original, of.0, of.1));
    }
    if matches!(
        rerun.likeness,
        ReplayMatch::Reproduced | ReplayMatch::Otherwise
    ) {
        let of = (traces.of_replay, traces.good_twin);
        lines.push(deviations_text(&rerun.from_twin, of.0, of.1));
    }
    lines.join("\n").trim_end().to_owned()
}

fn rerun_json(original: &Original, rerun: &Rerun) -> serde_json::Value {
    json!({
        "trace": original.id.to_string(),
        "procedure": original.procedure,
        "run": rerun.run_id.to_string(),
        "replay_trace": rerun.trace_id.to_string(),
        "unit": rerun.serial,
        "result": rerun.likeness.key(),
        "first_deviation": rerun.first_again.as_ref().map(|(signal, _)| signal),
        "first_deviates_again": rerun.first_again.as_ref().map(|(_, again)| again),
        "from_s": rerun.from_original.window_s.0,
        "to_s": rerun.from_original.window_s.1,
        "cut_short": rerun.cut_short,
        "refused": rerun.refused,
        "from_trace": deviations_json(&rerun.from_original),
        "from_twin": deviations_json(&rerun.from_twin),
    })
}
