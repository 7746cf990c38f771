//! A whole run: the unit is reached, the plan is worked through, and everything is recorded.

use std::panic::{AssertUnwindSafe, catch_unwind};

use btu_rig::procedure::Finding;
use btu_rig::procedure::plan::Connection;
use fault_db::{Instrument, RunRecord, Store, Verdict};

use super::adaptive;
use super::bench_contents::BenchContents;
use super::bench_setup::{BenchSetup, Connected};
use super::collector::{Collector, Listener, Outcome};
use super::evidence::Evidence;
use super::first_failure::FirstFailure;
use super::instruments;
use super::plan::{Adaptive, ProcedureStream, RunPlan, Task, different_steps};
use super::repaired::trace_repaired;
use super::run_start::RunStart;
use super::store_thread::RunStore;
use super::workers;
use crate::failure::{Exit, Failure, RunTrouble};
use crate::stop::Stop;
use crate::stored::{new_run, stored};

/// Runs the plan and records it, also where the unit cannot be reached; the store comes back for the report.
///
/// # Errors
/// The database fails; what was recorded stays.
pub fn run(
    plan: &mut RunPlan,
    setup: BenchSetup,
    store: Store,
    stop: &Stop,
    listener: &mut dyn Listener,
) -> Result<(Store, Outcome), Failure> {
    run_as_prepared(plan, setup, store, stop, listener, |_, _, _| Ok(()))
}

/// Runs an adaptive run. `adaptive` makes its settings for the unit that was reached.
///
/// # Errors
/// The unit has no dictionary, or the database fails; what was recorded stays.
pub fn search(
    plan: &mut RunPlan,
    setup: BenchSetup,
    store: Store,
    stop: &Stop,
    listener: &mut dyn Listener,
    adaptive: impl FnOnce(&Store, &str, Connection) -> Result<Adaptive, Failure>,
) -> Result<(Store, Outcome), Failure> {
    let prepare = |plan: &mut RunPlan, store: &Store, connected: &mut Connected| {
        let connection = connected.connection();
        plan.adaptive = Some(adaptive(store, &connected.serial(), connection)?);
        Ok(())
    };
    run_as_prepared(plan, setup, store, stop, listener, prepare)
}

/// Reaches the unit, lets `prepare` complete the plan for the unit that was reached, and runs the plan.
fn run_as_prepared(
    plan: &mut RunPlan,
    setup: BenchSetup,
    store: Store,
    stop: &Stop,
    listener: &mut dyn Listener,
    prepare: impl FnOnce(&mut RunPlan, &Store, &mut Connected) -> Result<(), Failure>,
) -> Result<(Store, Outcome), Failure> {
    let began = RunStart::now();
    let (reached, store) = reach(plan, &setup, store, stop, &began, listener)?;
    let mut connected = match reached {
        Ok(connected) => connected,
        Err(over) => return Ok((store, *over)),
    };
    trace_repaired(&mut plan.tasks, &store, &connected.serial())?;
    if plan.measuring.guard_band {
        instruments::guard_band(&mut plan.tasks, &store)?;
    }
    prepare(plan, &store, &mut connected)?;
    run_on(&mut connected, &began, plan, &setup, store, stop, listener)
}

/// The unit that was reached, or the outcome of the run that could not reach it.
type Reached = Result<Connected, Box<Outcome>>;

/// Reaches the unit; a run that cannot reach it is recorded and ended.
fn reach(
    plan: &RunPlan,
    setup: &BenchSetup,
    store: Store,
    stop: &Stop,
    began: &RunStart,
    listener: &mut dyn Listener,
) -> Result<(Reached, Store), Failure> {
    let serial = setup.expected_serial();
    run_record(plan, setup, serial.clone(), began.at_us).check()?;
    let usable = instruments::of_run(&store, setup, plan.measuring.uncalibrated);
    let failure = match usable.and_then(|_| setup.connect(stop)) {
        Ok(connected) => return Ok((Ok(connected), store)),
        Err(failure) => failure,
    };
    let made = BenchContents::of(setup, serial.clone(), Connection::Btu);
    let used = instruments::of_run(&store, setup, true)?;
    let record = RunRecord {
        evidence: Some(plan.evidence(made.clone(), used).text()),
        ..run_record(plan, setup, serial, began.at_us)
    };
    let run_store = RunStore::begin(store, record, listener.line_printer(), stop)?;
    let id = run_store.id;
    let due = (different_steps(&plan.tasks), false);
    let mut collector = Collector::new(run_store, *began, listener, made, due);
    collector.prevented(&failure);
    let (run_store, mut over) = collector.finish(id, None);
    let (store, lost) = run_store.finish(began.end(stored(over.verdict), 0))?;
    (over.exit, over.lost, over.prevented) = (failure.exit, lost, Some(failure.message));
    Ok((Err(Box::new(over)), store))
}

impl RunPlan {
    /// Evidence of the plan's results on a bench of this content, with these instruments.
    fn evidence(&self, made: BenchContents, used: Vec<Instrument>) -> Evidence {
        Evidence {
            is_part: self.tasks.iter().any(|task| task.options.chosen.is_some()),
            ..Evidence::now(made, used, self.measuring, different_steps(&self.tasks))
        }
    }
}

/// Runs the plan on a unit that has been reached and stays so.
///
/// # Errors
/// The database fails; what was recorded stays.
pub fn run_on(
    connected: &mut Connected,
    began: &RunStart,
    plan: &RunPlan,
    setup: &BenchSetup,
    store: Store,
    stop: &Stop,
    listener: &mut dyn Listener,
) -> Result<(Store, Outcome), Failure> {
    connected.set_stop(stop);
    let connection = connected.connection();
    let made = BenchContents::of(setup, connected.serial(), connection);
    let used = instruments::of_run(&store, setup, plan.measuring.uncalibrated)?;
    let planned = different_steps(&plan.tasks);
    let record = RunRecord {
        connection: Some(connection.word().into()),
        evidence: Some(plan.evidence(made.clone(), used).text()),
        ..run_record(plan, setup, connected.serial(), began.at_us)
    };
    let run_store = RunStore::begin(store, record, listener.line_printer(), stop)?;
    let id = run_store.id;
    let due = (planned, plan.adaptive.is_some());
    let mut collector = Collector::new(run_store, *began, listener, made, due);
    let first_failure = FirstFailure::new(plan.stop_on_fail && plan.adaptive.is_none());
    let worked = catch_unwind(AssertUnwindSafe(|| {
        std::thread::scope(|scope| {
            // No procedure of a search is due before the search has chosen it.
            let (procedures, due) = match &plan.adaptive {
                Some(adaptive) => {
                    let chosen = adaptive::start(scope, plan, adaptive, connected, stop);
                    (chosen, &plan.tasks[..0])
                }
                None => {
                    let all = workers::start(scope, plan, connected, &first_failure, stop);
                    (all, &plan.tasks[..])
                }
            };
            collect(procedures, &mut collector, &first_failure, due, stop);
        });
    }));
    if worked.is_err() {
        collector.broken_off(Finding::ProgramFailed);
    }
    let left_out = stop.left_out().map(|(verdict, _)| verdict);
    let (run_store, mut outcome) = collector.finish(id, left_out);
    let end = began.end(stored(outcome.verdict), outcome.bench_time.as_us() as i64);
    if worked.is_err() {
        // What was recorded stays, and the run is no pass.
        run_store.finish(began.end(Verdict::Error, outcome.bench_time.as_us() as i64))?;
        return Err(Failure::bench(RunTrouble::ProgramFailed(id)));
    }
    let (store, lost) = run_store.finish(end)?;
    if lost.is_some() {
        outcome.exit = Exit::Bench;
    }
    outcome.lost = lost;
    Ok((store, outcome))
}

/// Takes the procedures' streams one after the other, and steers no bench, because a bench has gone on when its events are
/// taken here. Procedures that were `due` and are in no stream, because the run was stopped, are recorded as not begun.
fn collect(
    procedures: impl IntoIterator<Item = ProcedureStream>,
    collector: &mut Collector<'_>,
    first_failure: &FirstFailure,
    due: &[Task],
    stop: &Stop,
) {
    let mut places = 0;
    let not_begun = |collector: &mut Collector<'_>| {
        if let Some((verdict, why)) = stop.left_out() {
            collector.not_begun(verdict, why);
        }
    };
    for (place, (procedure, stream)) in procedures.into_iter().enumerate() {
        if !first_failure.admits(place) {
            return;
        }
        places = place + 1;
        collector.begin(&procedure);
        let mut events = stream.into_iter().peekable();
        if events.peek().is_none() {
            not_begun(collector);
        }
        events.for_each(|event| collector.take(event));
    }
    for (place, task) in due.iter().enumerate().skip(places) {
        if first_failure.admits(place) && stop.presses() > 0 {
            collector.begin(&task.procedure);
            not_begun(collector);
        }
    }
}

fn run_record(plan: &RunPlan, setup: &BenchSetup, serial: String, started_at_us: i64) -> RunRecord {
    let config_name = setup.config.content.name.clone();
    RunRecord {
        line: setup.line.content.name.clone(),
        train: plan.train.clone(),
        seed: setup.seed,
        operator: plan.operator.clone(),
        scripts_sha256: plan.scripts_sha256.clone(),
        unit_config_sha256: setup.config.sha256.clone(),
        injected: setup.injected(),
        continues: plan.continues,
        symptom: plan.symptom.clone(),
        scripts: plan
            .tasks
            .iter()
            .map(|task| fault_db::ScriptRecord {
                path: task.procedure.path.clone(),
                sha256: task.procedure.sha256.clone(),
            })
            .collect(),
        ..new_run(
            serial,
            config_name,
            setup.endpoint.to_string(),
            started_at_us,
        )
    }
}
