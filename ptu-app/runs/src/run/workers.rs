//! Runs the tasks of a plan: side by side on embedded units built for each, or one after the other on the unit on a
//! port.

use std::sync::mpsc::{self, Receiver, SyncSender};
use std::sync::{Arc, Mutex};
use std::thread::Scope;

use btu_rig::rig::UnitLink;
use protocol::Instant;

use super::bench_setup::{BenchSetup, Connected, SWITCHED_OFF};
use super::event::SessionEvent;
use super::fault_watch::FaultSeen;
use super::first_failure::FirstFailure;
use super::plan::{ProcedureStream, RunPlan, Task, stream};
use super::session::Session;
use super::settle::{READY_WITHIN, between_procedures, settled};
use crate::link::keep_time;
use crate::stop::Stop;

/// Procedures that may be begun before those in front of them have ended; each keeps room for its events.
const STREAMS_AHEAD: usize = 32;

/// Starts the workers. Gives each procedure with its stream, in the order of the tasks, when it is begun or due.
pub(super) fn start<'scope>(
    scope: &'scope Scope<'scope, '_>,
    plan: &'scope RunPlan,
    connected: &'scope mut Connected,
    first_failure: &'scope FirstFailure,
    stop: &'scope Stop,
) -> Receiver<ProcedureStream> {
    let (procedures, receiver) = mpsc::sync_channel(STREAMS_AHEAD);
    let work = Arc::new(Mutex::new(Work {
        tasks: plan.tasks.iter().enumerate(),
        procedures,
    }));
    let work_off = move |connected: &mut Connected| {
        let may_begin = |place: usize| stop.may_begin() && first_failure.admits(place);
        // The stream of a procedure that is due and not begun ends without an event.
        while let Some((place, task, sender)) = take(&work).filter(|due| may_begin(due.0)) {
            first_failure.run_noting_failure(place, sender, |sink, go_on| {
                connected.run(task, stop, sink, go_on);
            });
        }
    };
    match connected {
        Connected::Sim(setup) => {
            for _ in 0..plan.jobs.clamp(1, plan.tasks.len().max(1)) {
                let (work_off, mut own) = (work_off.clone(), Connected::Sim(setup.clone()));
                scope.spawn(move || work_off(&mut own));
            }
        }
        port @ Connected::Port(..) => drop(scope.spawn(move || work_off(port))),
    }
    receiver
}

/// Tasks not begun yet, and where their streams go.
struct Work<'a> {
    tasks: std::iter::Enumerate<std::slice::Iter<'a, Task>>,
    procedures: SyncSender<ProcedureStream>,
}

/// The next task, its place and its stream, which is handed on in the order of the tasks: a worker that is
/// too far ahead of those before it waits here.
fn take<'a>(work: &Mutex<Work<'a>>) -> Option<(usize, &'a Task, SyncSender<SessionEvent>)> {
    let mut work = work.lock().ok()?;
    let (place, task) = work.tasks.next()?;
    let (sender, events) = stream();
    work.procedures
        .send((task.procedure.clone(), events))
        .ok()?;
    Some((place, task, sender))
}

impl Connected {
    /// Runs a task as long as `go_on` says so after a step, telling `sink` what happens: on an embedded unit made for the
    /// task, or on the unit on the port.
    pub(super) fn run(
        &mut self,
        task: &Task,
        stop: &Stop,
        sink: &mut dyn FnMut(SessionEvent),
        go_on: &dyn Fn() -> bool,
    ) {
        match self {
            Self::Sim(setup) => run_on_fresh(setup, task, stop, sink, go_on),
            Self::Port(session, _, found) => {
                keep_time();
                let began = session.now();
                found.extend(between_procedures(session));
                let found = std::mem::take(found);
                run_task(session, task, found, began, sink, go_on);
            }
        }
    }
}

/// For a task of which every step is run.
pub const TO_THE_END: fn() -> bool = || true;

/// Runs a task on an embedded unit made for it as long as `go_on` says so after a step, telling `sink` what happens.
pub fn run_on_fresh(
    setup: &BenchSetup,
    task: &Task,
    stop: &Stop,
    sink: &mut dyn FnMut(SessionEvent),
    go_on: &dyn Fn() -> bool,
) {
    let mut session = setup.sim_session(&task.procedure.id, stop);
    let (_, faults) = session.judge_bring_up(SWITCHED_OFF + READY_WITHIN, settled());
    run_task(&mut session, task, faults, Instant::ZERO, sink, go_on);
}

pub(super) fn run_task<L: UnitLink>(
    session: &mut Session<L>,
    task: &Task,
    found: Vec<FaultSeen>,
    began: Instant,
    sink: &mut dyn FnMut(SessionEvent),
    go_on: &dyn Fn() -> bool,
) {
    session.run(&task.procedure, task.options.clone(), found, sink, go_on);
    let bench_time = session.now().since(began);
    sink(SessionEvent::Ended { bench_time });
}

#[cfg(test)]
mod tests;
