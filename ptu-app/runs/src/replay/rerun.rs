//! Plays recorded stimuli again, on the embedded unit or one on a port: the situation of a fault is set up on the
//! bench, and the replay is kept as a run of its own.

use fault_db::{Id, RunEnd, RunRecord, RunWriter, StepRecord, Store, TraceData, Verdict};
use protocol::Instant;
use protocol::injection::FaultMode;

use super::replay_embedded::{EmbeddedReplay, from_here, on_embedded};
use super::{Comparison, Original, compare, good_twin};
use crate::clock;
use crate::data::ScriptsDirectory;
use crate::failure::{Exit, Failure, RunTrouble};
use crate::link::Endpoint;
use crate::run::{BenchContents, BenchSetup, Connected};
use crate::stop::Stop;
use crate::stored::{from_stored, new_run};
use crate::words::{Say, TextStyle};

/// Settings of a replay.
#[derive(Clone, Debug)]
pub struct Rerunning {
    pub endpoint: Endpoint,
    /// Faults injected into the embedded unit, and into the train around any.
    pub faults: Vec<FaultMode>,
    /// Name of the tester.
    pub operator: String,
}

protocol::labelled! {
    /// How closely a replay follows the recorded trace.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum ReplayMatch: key {
        /// The original and its good twin are the same, and so is the replay.
        Sound = "sound",
        /// The replay deviates as the original did: the fault shows again.
        Reproduced = "reproduced",
        /// The replay equals the good twin: the fault does not show.
        AsTwin = "as_good_twin",
        Otherwise = "otherwise",
    }
}

impl Say for ReplayMatch {
    fn say(&self, how: TextStyle) -> String {
        let both = match self {
            Self::Sound => [
                "reproduced, and as the good twin: the trace shows no fault",
                "재현됨. 정상 비교 장치와 같음: 신호 기록에 고장이 없음",
            ],
            Self::Reproduced => ["reproduced", "재현됨"],
            Self::AsTwin => [
                "not reproduced: as the good twin",
                "재현되지 않음: 정상 비교 장치와 같음",
            ],
            Self::Otherwise => [
                "not reproduced: neither as the trace nor as the good twin",
                "재현되지 않음: 신호 기록과도 정상 비교 장치와도 다름",
            ],
        };
        how.choose(both).to_owned()
    }
}

impl ReplayMatch {
    /// The verdict on the unit: it is good when it does as the good twin.
    fn verdict(self) -> Verdict {
        match self {
            Self::Sound | Self::AsTwin => Verdict::Passed,
            Self::Reproduced | Self::Otherwise => Verdict::Failed,
        }
    }
}

/// The result of a replay.
#[derive(Debug)]
pub struct Rerun {
    /// Run as which the replay was recorded.
    pub run_id: Id,
    pub trace_id: Id,
    /// Serial number of the unit.
    pub serial: String,
    pub likeness: ReplayMatch,
    /// First deviating signal of the original, and whether it deviates again.
    pub first_again: Option<(String, bool)>,
    /// The replay against the original.
    pub from_original: Comparison,
    /// The replay against the good twin.
    pub from_twin: Comparison,
    /// Stimuli this bench refused.
    pub refused: Vec<String>,
    /// Why the replay is not whole: stopped before its end, or the bench could not be made safe.
    pub cut_short: Option<String>,
    /// Exit code.
    pub exit: Exit,
}

/// Runs the stimuli of a stored trace again and records what comes.
///
/// # Errors
/// A file the bench was built from is no longer available, the unit cannot be reached or is another one, or the
/// database fails.
pub fn rerun(
    store: &Store,
    directory: &ScriptsDirectory,
    original: &Original,
    rerunning: &Rerunning,
    stop: &Stop,
) -> Result<Rerun, Failure> {
    let (twin, rule) = good_twin(original, directory)?;
    let expected = compare(&original.trace, &twin, &rule, &[])?;
    let mut setup = original.made.setup(directory)?;
    setup.faults.clone_from(&rerunning.faults);
    setup.endpoint = rerunning.endpoint.clone();
    let began = std::time::Instant::now();
    let started_at_us = clock::now_us();
    let (again, serial, cut_short) = play(original, &mut setup, stop)?;
    let from_original = compare(&again.trace, &original.trace, &again.rule, &[])?;
    let from_twin = compare(&again.trace, &twin, &again.rule, &[])?;
    let likeness = likeness(&from_original, &from_twin);
    let first_again = first_again(&expected, &from_twin);
    let record = run_record(original, &setup, &serial, rerunning, started_at_us);
    let mut writer = RunWriter::begin(store, &record)?;
    let verdict = match cut_short {
        Some(_) if stop.presses() > 0 => Verdict::Aborted,
        Some(_) => Verdict::Error,
        None => likeness.verdict(),
    };
    let connection = original.made.connection();
    let again_made = BenchContents::of(&setup, serial.clone(), connection);
    let trace_id = write(
        &mut writer,
        original,
        &again_made,
        &again,
        verdict,
        likeness,
    )?;
    let wall_time_us = i64::try_from(began.elapsed().as_micros()).unwrap_or(i64::MAX);
    writer.finish(&RunEnd {
        verdict,
        finished_at_us: started_at_us.saturating_add(wall_time_us),
        bench_time_us: bench_time_us(&again.trace),
        wall_time_us,
    })?;
    Ok(Rerun {
        run_id: writer.id(),
        trace_id,
        serial,
        likeness,
        first_again,
        from_original,
        from_twin,
        refused: again.refused,
        cut_short,
        exit: from_stored(verdict).into(),
    })
}

/// Judges by the deviations that are evidence. A replay that differs from its good twin in counts of frames alone,
/// as its original does, has reproduced that.
fn likeness(from_original: &Comparison, from_twin: &Comparison) -> ReplayMatch {
    match (from_original.evidence(), from_twin.evidence()) {
        (0, 0) if from_original.deviations.is_empty() && !from_twin.deviations.is_empty() => {
            ReplayMatch::Reproduced
        }
        (0, 0) => ReplayMatch::Sound,
        (0, _) => ReplayMatch::Reproduced,
        (_, 0) => ReplayMatch::AsTwin,
        _ => ReplayMatch::Otherwise,
    }
}

/// The signal that deviated first in the original, and whether it deviates from the good twin in the replay, too,
/// whatever else does.
fn first_again(original: &Comparison, replay: &Comparison) -> Option<(String, bool)> {
    let first = &original.deviations.first()?.signal;
    let again = replay
        .deviations
        .iter()
        .any(|deviation| deviation.signal == *first);
    Some((first.clone(), again))
}

/// Plays the original on the bench asked for; gives the unit's serial number, and why the replay
/// was cut short, if it was.
fn play(
    original: &Original,
    setup: &mut BenchSetup,
    stop: &Stop,
) -> Result<(EmbeddedReplay, String, Option<String>), Failure> {
    let port = setup.endpoint != Endpoint::Sim;
    if port {
        // Any unit of this configuration will do: that is what a bench is for.
        setup.serial = None;
    }
    let stopped = |again: &EmbeddedReplay| {
        let stopped = (stop.presses() > 0).then(|| "stopped by the operator".to_owned());
        stopped.filter(|_| again.trace.partial)
    };
    match setup.connect(stop)? {
        Connected::Sim(setup) => {
            let again = on_embedded(original, &setup, stop)?;
            let cut_short = stopped(&again);
            Ok((again, setup.expected_serial(), cut_short))
        }
        connected @ Connected::Port(..) => {
            let serial = connected.serial();
            let Connected::Port(mut session, ..) = connected else {
                return Err(Failure::bench(RunTrouble::PortGone));
            };
            let played = from_here(original, &mut session);
            let safe = session.make_safe();
            let again = played?;
            let unsafe_ = (!safe).then(|| {
                session.link_error().map_or_else(
                    || "the outputs are not confirmed safe".to_owned(),
                    |why| why.to_string(),
                )
            });
            let cut_short = unsafe_.or_else(|| stopped(&again));
            Ok((again, serial, cut_short))
        }
    }
}

fn run_record(
    original: &Original,
    setup: &BenchSetup,
    serial: &str,
    rerunning: &Rerunning,
    started_at_us: i64,
) -> RunRecord {
    let config_name = setup.config.content.name.clone();
    let source = format!("replay of {} on {}", original.id.short(), setup.endpoint);
    RunRecord {
        line: setup.line.content.name.clone(),
        seed: setup.seed,
        operator: rerunning.operator.clone(),
        // No script is run.
        unit_config_sha256: setup.config.sha256.clone(),
        injected: setup.injected(),
        ..new_run(serial.to_owned(), config_name, source, started_at_us)
    }
}

/// Writes one step that says how the replay compares, the trace, and the stimuli that were played.
fn write(
    writer: &mut RunWriter<'_>,
    original: &Original,
    made: &BenchContents,
    again: &EmbeddedReplay,
    verdict: Verdict,
    likeness: ReplayMatch,
) -> Result<Id, Failure> {
    let mut trace = again.trace.clone();
    trace.t0_us = clock::now_us() - bench_time_us(&trace);
    let began_us = again.recorded.began.since(Instant::ZERO).as_us() as i64;
    let name = format!("replay of trace {}", original.id.short());
    writer.step(StepRecord {
        verdict,
        started_bench_us: began_us,
        bench_time_us: (trace.t0_bench_us + bench_time_us(&trace) - began_us).max(0),
        message: likeness.say(TextStyle::COMMAND_LINE),
        ..StepRecord::passed(0, &original.procedure, name)
    })?;
    let id = writer.trace(&[], &trace)?;
    let recording = made.recording(&original.procedure, &again.recorded);
    writer.recording(
        &fault_db::RecordingRecord {
            ordinal: 1,
            ..recording
        },
        &[id],
    )?;
    Ok(id)
}

fn bench_time_us(trace: &TraceData) -> i64 {
    trace.rows() as i64 * trace.period_us
}
