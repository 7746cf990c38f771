//! The first deviation of a trace from that of a sound unit: the evidence that diagnosis takes from traces.

use std::collections::BTreeSet;

use btu_rig::recorded::StimulusPlayer;
use btu_rig::recorder::RecordedWindow;
use fault_db::{Id, RunOccurrence, Store, TraceData};

use super::{Original, Rule, compare, good_twin};
use crate::data::ScriptsDirectory;
use crate::pool;
use crate::run::trace_data::trace_data;
use crate::run::{BenchSetup, RecordedStimuli, Window};
use crate::stop::Stop;

/// The first signal of a window that deviates from a sound unit's, on the bench of `setup` and under the same stimuli;
/// none where no signal deviates, or after a stop.
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

/// The first trace of each procedure of a stored run, as far as its stimuli can be repeated.
pub fn first_traces(store: &Store, occurrences: &[RunOccurrence]) -> Vec<Original> {
    let mut procedures = BTreeSet::new();
    let mut traces: Vec<Id> = occurrences.iter().filter_map(|one| one.trace_id).collect();
    traces.dedup();
    // Traces of one procedure come one after the other: its first is the first to be asked for.
    traces.retain(|trace| {
        let recording = store.recording(*trace).ok().flatten();
        recording.is_some_and(|recording| procedures.insert(recording.procedure))
    });
    let read = |trace| Original::read(store, trace).ok();
    traces.into_iter().filter_map(read).collect()
}

/// The first deviating signal of each trace that deviates from its good twin; after a stop no trace is begun.
pub fn residuals(traces: &[Original], directory: &ScriptsDirectory, stop: &Stop) -> Vec<String> {
    let first_of = |i: usize| {
        let (twin, rule) = good_twin(&traces[i], directory).ok()?;
        first(&traces[i].trace, &twin, &rule)
    };
    let found = pool::run(traces.len(), pool::cores(), stop, &mut |_| {}, first_of);
    found.into_iter().filter_map(|(_, first)| first).collect()
}

fn first(came: &TraceData, twin: &TraceData, rule: &Rule) -> Option<String> {
    let comparison = compare(came, twin, rule, &[]).ok()?;
    let first = comparison.deviations.into_iter().next()?;
    Some(first.signal)
}
