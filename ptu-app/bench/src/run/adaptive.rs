//! A run that isolates a fault by itself: after every step it works out which check gives the most
//! information, and runs that next. Dictionary and strategy are of `diagnosis`; here they drive a bench.

use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::Scope;

use btu_rig::procedure::RunOptions;
use diagnosis::{Dictionary, Model, Settings, Strategy};
use protocol::LruId;

use super::bench_setup::Connected;
use super::observe::ObservationBuilder;
use super::workers::Worker;
use super::{ProcedureStream, RunPlan, Task, stream};
use crate::stop::Stop;

/// What an adaptive run decides by.
pub struct Adaptive {
    /// What each fault does to each check.
    pub dictionary: Dictionary,
    /// Priors and thresholds.
    pub settings: Settings,
    /// What the unit's history says of its parts.
    pub lru_factors: BTreeMap<LruId, f64>,
}

/// Starts the worker; procedures come as it chooses them.
pub fn start<'scope>(
    scope: &'scope Scope<'scope, '_>,
    plan: &'scope RunPlan,
    adaptive: &'scope Adaptive,
    connected: &'scope mut Connected,
    stop: &'scope Stop,
) -> Receiver<ProcedureStream> {
    let (procedures, receiver) = mpsc::channel();
    scope.spawn(move || {
        let mut worker = Worker::new(connected, stop);
        isolate(plan, adaptive, &mut worker, stop, &procedures);
    });
    receiver
}

fn isolate(
    plan: &RunPlan,
    adaptive: &Adaptive,
    worker: &mut Worker<'_>,
    stop: &Stop,
    procedures: &Sender<ProcedureStream>,
) {
    let tasks = plan
        .tasks
        .iter()
        .map(|task| (task.procedure.id.as_str(), task));
    let tasks: BTreeMap<&str, &Task> = tasks.collect();
    let may: BTreeSet<String> = tasks.keys().map(|id| (*id).to_owned()).collect();
    let Adaptive {
        dictionary,
        settings,
        lru_factors,
    } = adaptive;
    let model = Model::new(dictionary, settings, lru_factors);
    let mut strategy = Strategy::new(&model, Some(may));
    while let Some(next) = strategy.begin() {
        let Some(task) = tasks.get(next.procedure.as_str()) else {
            return;
        };
        let (sender, events) = stream();
        if procedures.send((task.procedure.clone(), events)).is_err() {
            return;
        }
        if !stop.may_begin() {
            // Its stream ends without a word: it was due.
            return;
        }
        // A step waits until the strategy has judged the one before.
        let task = Task {
            procedure: task.procedure.clone(),
            options: RunOptions {
                one_by_one: true,
                ..task.options.clone()
            },
        };
        let mut observation = ObservationBuilder::new(&task.procedure.id);
        let enough = Cell::new(false);
        let mut sink = |event| {
            if let Some(step) = observation.take(&event)
                && !strategy.saw(step)
            {
                enough.set(true);
            }
            // The collector listens until the stream ends, so that sending cannot fail.
            drop(sender.send(event));
        };
        worker.run(&task, &mut sink, &|| !enough.get());
        if !enough.get() {
            strategy.ended(&next.procedure);
        }
    }
}
