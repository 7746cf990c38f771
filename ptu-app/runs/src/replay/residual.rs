//! The first deviation of a trace from that of a sound unit: the evidence that diagnosis takes from traces.

use std::collections::BTreeSet;

use btu_rig::recorded::StimulusPlayer;
use btu_rig::recorder::RecordedWindow;
use diagnosis::Observation;
use fault_db::{Id, RunOccurrence, Store, TraceData};

use super::{Original, Rule, compare, good_twin};
use crate::data::ScriptsDirectory;
use crate::run::trace_data::trace_data;
use crate::run::{BenchSetup, RecordedStimuli, Window};
use crate::stop::Stop;

/// The first signal of a window that leaves a sound unit's on the bench of `setup`, which is given the same stimuli; none
/// where all are the same, or it was stopped.
pub fn first_deviation(
    setup: &BenchSetup,
    procedure: &str,
    (cut, stimuli): (&RecordedWindow, &RecordedStimuli),
    stop: &Stop,
) -> Option<String> {
    let sound = BenchSetup {
        faults: Vec::new(),
        ..setup.clone()
    };
    let window = Window {
        from: cut.rows.first()?.at,
        trigger: cut.rows.get(cut.trigger_row)?.at,
        until: cut.rows.last()?.at,
    };
    let player = StimulusPlayer::new(&stimuli.record, 0);
    let mut session = sound.sim_session(procedure, stop);
    let twin = session.play(player, window, &mut Vec::new())?;
    first(&trace_data(cut), &twin, &Rule::exact())
}

/// Adds the residual of the first trace of each procedure of a stored run, as far as the traces can
/// be made again.
pub fn add_residuals(
    seen: &mut Observation,
    (store, directory): (&Store, &ScriptsDirectory),
    occurrences: &[RunOccurrence],
) {
    let mut procedures = BTreeSet::new();
    let mut traces: Vec<Id> = occurrences.iter().filter_map(|one| one.trace_id).collect();
    traces.dedup();
    // Traces of one procedure come one after the other: its first is the first to be asked for.
    for trace in traces {
        let procedure = store.recording(trace).ok().flatten();
        let procedure = procedure.map(|recording| recording.procedure);
        if !procedure.is_some_and(|procedure| procedures.insert(procedure)) {
            continue;
        }
        let Ok(original) = Original::read(store, trace) else {
            continue;
        };
        let twin = good_twin(&original, directory);
        let first = twin
            .ok()
            .and_then(|(twin, rule)| first(&original.trace, &twin, &rule));
        seen.residuals.extend(first);
    }
}

fn first(came: &TraceData, twin: &TraceData, rule: &Rule) -> Option<String> {
    let comparison = compare(came, twin, rule, &[]).ok()?;
    let first = comparison.deviations.into_iter().next()?;
    Some(first.signal)
}
