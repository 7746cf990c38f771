//! A run that isolates a fault by itself: after every step it works out which check gives the most
//! information, and runs that next. Dictionary and strategy are of `diagnosis`; here they drive a bench.

use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::mpsc::{self, Receiver};
use std::thread::Scope;

use btu_rig::procedure::RunOptions;
use diagnosis::{Model, Strategy};

use super::bench_setup::Connected;
use super::event::SessionEvent;
use super::observe::ObservationBuilder;
use super::plan::{Adaptive, ProcedureStream, RunPlan, Task, stream};
use crate::stop::Stop;

/// Starts the search on a thread of its own; procedures come as the search chooses them.
pub fn start<'scope>(
    scope: &'scope Scope<'scope, '_>,
    plan: &'scope RunPlan,
    adaptive: &'scope Adaptive,
    connected: &'scope mut Connected,
    stop: &'scope Stop,
) -> Receiver<ProcedureStream> {
    let (procedures, receiver) = mpsc::channel();
    scope.spawn(move || {
        let model = Model::new(
            &adaptive.dictionary,
            &adaptive.settings,
            &adaptive.lru_factors,
        );
        isolate(&model, &plan.tasks, &mut |task, saw, go_on| {
            let (sender, events) = stream();
            if procedures.send((task.procedure.clone(), events)).is_err() {
                return false;
            }
            if !stop.may_begin() {
                // The stream of events ends empty: the collector counts this procedure as due and not
                // run.
                return false;
            }
            let mut sink = |event| {
                saw(&event);
                // The collector listens until the stream ends, so that sending cannot fail.
                drop(sender.send(event));
            };
            connected.run(task, stop, &mut sink, go_on);
            true
        });
    });
    receiver
}

/// Runs a task: each event goes to the first function, and after each step the second says whether to go on. False where the
/// whole search is over.
pub type Perform<'a> =
    dyn FnMut(&Task, &mut dyn FnMut(&SessionEvent), &dyn Fn() -> bool) -> bool + 'a;

/// Lets `perform` run the tasks that tell most, each as far as it tells something, until the question is answered.
/// Returns the bench time of the tasks, s.
pub fn isolate(model: &Model<'_>, tasks: &[Task], perform: &mut Perform<'_>) -> f64 {
    let named = tasks.iter().map(|task| (task.procedure.id.as_str(), task));
    let named: BTreeMap<&str, &Task> = named.collect();
    let may: BTreeSet<String> = named.keys().map(|id| (*id).to_owned()).collect();
    let mut strategy = Strategy::new(model, Some(may));
    while let Some(next) = strategy.begin() {
        let Some(task) = named.get(next.procedure.as_str()) else {
            break;
        };
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
        let mut saw = |event: &SessionEvent| {
            if let Some(step) = observation.take(event)
                && !strategy.saw(step)
            {
                enough.set(true);
            }
        };
        if !perform(&task, &mut saw, &|| !enough.get()) {
            break;
        }
        if !enough.get() {
            strategy.ended(&next.procedure);
        }
    }
    strategy.time_s()
}
