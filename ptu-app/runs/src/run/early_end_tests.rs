//! The verdict of a run that ends early: stopped between its procedures, when none was under way to say so,
//! ended by its first failure, or by a database that takes no more.

mod repetitions;
mod searches;

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use btu_rig::procedure::{Procedure, Runner, loader};
use btu_rig::rig::Rig;
use fault_db::Store;
use protocol::Instant;

use super::{
    BenchSetup, Connected, Listener, Outcome, RunControl, RunPlan, RunStart, SessionEvent, Suite,
    run, run_on,
};
use crate::clock;
use crate::failure::Exit;
use crate::link::Endpoint;
use crate::run_diagnosis;
use crate::stop::Stop;
use crate::test_support::{scripts, setup};

const PASSES: &str = "procedure(title = \"Wait\", suspect = \"-\")\nstep(\"waits\", do = [wait(ms(200))], measure = value(\"v\", speed))\n";
const FAILS: &str = "procedure(title = \"Alarm\", suspect = \"-\")\n\
     step(\"sounds\", expect = [becomes(alarm, True, within = ms(200))])\n";

/// Counts the scans of all procedures, and presses stop before one of them.
#[derive(Default)]
struct StopBeforeScan {
    count: Mutex<Count>,
    /// Before this scan, counted from 1.
    at: Option<usize>,
    stop: Stop,
}

#[derive(Default)]
struct Count {
    scans: usize,
    now: Instant,
    /// Scans before each new bench.
    before: Vec<usize>,
}

impl RunControl for StopBeforeScan {
    fn after_cycle(&self, now: Instant, _: &Rig) {
        let mut count = self.count.lock().expect("no thread panics with it");
        if now < count.now {
            let scans = count.scans;
            count.before.push(scans);
        }
        count.now = now;
    }

    fn before_scan(&self, _: &mut Runner) {
        let mut count = self.count.lock().expect("no thread panics with it");
        count.scans += 1;
        // The scan has asked for a stop already: this one is heeded by what comes after it.
        if Some(count.scans) == self.at {
            self.stop.press();
        }
    }
}

/// A database of its own and the folder that holds it.
fn store() -> (tempfile::TempDir, Store) {
    let folder = tempfile::tempdir().expect("a folder");
    let store = Store::open(&folder.path().join("history.db"), clock::open_options());
    (folder, store.expect("a database"))
}

/// Procedures of these texts, in their order.
fn plan_of(texts: &[&str]) -> RunPlan {
    let setup = setup(&[]);
    let named = |(place, text): (usize, &&str)| (format!("{place}.star"), (*text).to_owned());
    let texts: BTreeMap<_, _> = texts.iter().enumerate().map(named).collect();
    let (config, line) = (&setup.config.content, &setup.line.content);
    let loaded = loader::load(&texts, config, line, &setup.train);
    assert!(loaded.errors.is_empty(), "{:?}", loaded.errors);
    RunPlan::of(loaded.procedures)
}

/// Runs the plan under a run control; the outcome and the stored run.
fn run_with(
    presser: &Arc<StopBeforeScan>,
    plan: &RunPlan,
    setup: BenchSetup,
) -> (Outcome, fault_db::Verdict) {
    let (outcome, detail) = recorded(presser, plan, setup);
    (outcome, detail.run.verdict.expect("it is over"))
}

/// Runs the plan under a run control; the outcome and all that is stored of the run.
fn recorded(
    presser: &Arc<StopBeforeScan>,
    plan: &RunPlan,
    mut setup: BenchSetup,
) -> (Outcome, fault_db::RunDetail) {
    setup.run_control = Some(presser.clone());
    let mut connected = setup.connect(&presser.stop).expect("the embedded unit");
    let (_folder, store) = store();
    let (began, stop) = (RunStart::now(), &presser.stop);
    let ran = run_on(&mut connected, &began, plan, &setup, store, stop, &mut ());
    let (store, outcome) = ran.expect("it is recorded");
    let detail = store.run(outcome.id).expect("the run");
    (outcome, detail)
}

/// The last scan of each procedure, counted in a run that is not stopped; in virtual time they are the same
/// in every run.
fn ends(plan: &RunPlan) -> Vec<usize> {
    let counter = Arc::new(StopBeforeScan::default());
    run_with(&counter, plan, setup(&[]));
    let count = counter.count.lock().expect("no thread panics with it");
    let ends = [&count.before[..], &[count.scans]].concat();
    // A search may come back to one.
    assert!(ends.len() >= plan.tasks.len(), "all of them were run");
    ends
}

/// Stop pressed in this scan.
fn stopped_at(scan: usize, plan: &RunPlan) -> (Outcome, fault_db::Verdict) {
    let presser = Arc::new(StopBeforeScan {
        at: Some(scan),
        ..StopBeforeScan::default()
    });
    let came_to = run_with(&presser, plan, setup(&[]));
    assert_eq!(presser.stop.presses(), 1);
    came_to
}

/// Stop pressed in the last scan of the procedure with this place: too late for it, and before the next.
fn stopped_after(place: usize, plan: &RunPlan) -> (Outcome, fault_db::Verdict) {
    stopped_at(ends(plan)[place], plan)
}

#[test]
fn a_run_stopped_before_its_first_procedure_is_aborted() {
    let presser = Arc::new(StopBeforeScan::default());
    presser.stop.press();
    let (outcome, stored) = run_with(&presser, &plan_of(&[PASSES]), setup(&[]));
    assert_eq!(stored, fault_db::Verdict::Aborted);
    assert_eq!(outcome.exit, Exit::Aborted);
    assert_eq!(presser.count.lock().expect("alone").scans, 0);
}

#[test]
fn a_run_stopped_between_two_procedures_is_aborted_whatever_came_before() {
    for first in [PASSES, FAILS] {
        let plan = plan_of(&[first, PASSES]);
        let (outcome, stored) = stopped_after(0, &plan);
        assert_eq!(stored, fault_db::Verdict::Aborted, "{first}");
        assert_eq!(outcome.exit, Exit::Aborted, "{first}");
    }
}

/// What was due and not begun is recorded, however many procedures that are; in a run that ends with its first failure
/// nothing after that is due.
#[test]
fn a_stopped_run_keeps_the_procedures_that_it_did_not_begin() {
    let mut plan = plan_of(&[PASSES, FAILS, PASSES, PASSES]);
    let at = ends(&plan);
    let kept = |at: usize, plan: &RunPlan| {
        let presser = Arc::new(StopBeforeScan {
            at: Some(at),
            ..StopBeforeScan::default()
        });
        let (_, run) = recorded(&presser, plan, setup(&[]));
        let said = |step: &fault_db::StepRecord| {
            (
                step.procedure.clone(),
                step.name.clone(),
                step.verdict.as_str(),
            )
        };
        run.steps.iter().map(said).collect::<Vec<_>>()
    };
    let of = |place: &str, name: &str, verdict| (place.to_owned(), name.to_owned(), verdict);
    let expected = [
        of("0", "waits", "passed"),
        of("1", "not begun", "aborted"),
        of("2", "not begun", "aborted"),
        of("3", "not begun", "aborted"),
    ];
    assert_eq!(kept(at[0], &plan), expected);
    plan.jobs = 3;
    assert_eq!(kept(1, &plan).last(), expected.last());
    plan.jobs = 1;
    plan.stop_on_fail = true;
    let expected = [of("0", "waits", "passed"), of("1", "sounds", "failed")];
    assert_eq!(kept(at[1], &plan), expected);
}

/// What nothing was left out of has its own verdict and exit code, and so has a run that was to end there by
/// itself.
#[test]
fn a_stop_after_the_last_procedure_changes_no_verdict() {
    let plan = plan_of(&[PASSES, PASSES]);
    let (outcome, stored) = stopped_after(1, &plan);
    assert_eq!(stored, fault_db::Verdict::Passed);
    assert_eq!(outcome.exit, Exit::Passed);
    let mut plan = plan_of(&[FAILS, PASSES]);
    let at = ends(&plan)[0];
    plan.stop_on_fail = true;
    let (outcome, stored) = stopped_at(at, &plan);
    assert_eq!(stored, fault_db::Verdict::Failed);
    assert_eq!(outcome.exit, Exit::Failed);
}

/// Goal: where a run ends with its first failure, that is decided before the next procedure begins, and its
/// record does not depend on who is quicker, nor on how many benches work side by side. Method: many times, on
/// one bench and on three, with all processors kept busy and somebody slow who looks on.
#[test]
fn a_run_ends_with_its_first_failure_however_busy_the_computer_is() {
    const TIMES: usize = 25;
    let mut plan = plan_of(&[PASSES, FAILS, FAILS, PASSES]);
    plan.stop_on_fail = true;
    let (_folder, mut store) = store();
    let (over, setup) = (AtomicBool::new(false), setup(&[]));
    std::thread::scope(|scope| {
        for _ in 0..crate::pool::cores() {
            scope.spawn(|| {
                while !over.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            });
        }
        for turn in 0..2 * TIMES {
            plan.jobs = [1, 3][turn % 2];
            let mut connected = setup.connect(&Stop::default()).expect("the embedded unit");
            let begun = Arc::new(StopBeforeScan::default());
            let setup = BenchSetup {
                run_control: Some(begun.clone()),
                ..setup.clone()
            };
            if let Connected::Sim(bench) = &mut connected {
                **bench = setup.clone();
            }
            let (began, mut slow) = (RunStart::now(), SlowListener(turn % 3));
            let ran = run_on(
                &mut connected,
                &began,
                &plan,
                &setup,
                store,
                &begun.stop,
                &mut slow,
            );
            let (kept, outcome) = ran.expect("it is recorded");
            let run = kept.run(outcome.id).expect("the run");
            store = kept;
            let steps: Vec<_> = run.steps.iter().map(|s| s.procedure.as_str()).collect();
            assert_eq!(steps, ["0", "1"], "turn {turn}");
            assert_eq!(run.run.verdict, Some(fault_db::Verdict::Failed));
            assert_eq!(outcome.exit, Exit::Failed);
            if plan.jobs == 1 {
                let benches = 1 + begun.count.lock().expect("alone").before.len();
                assert_eq!(benches, 2, "no third procedure is begun, turn {turn}");
            }
        }
        over.store(true, Ordering::Relaxed);
    });
}

/// Looks on, and is slow about it.
struct SlowListener(usize);

impl Listener for SlowListener {
    fn on_event(&mut self, _: &Procedure, event: &SessionEvent) {
        if matches!(event, SessionEvent::Ended { .. }) {
            std::thread::sleep(Duration::from_millis(3 * self.0 as u64));
        }
    }
}

/// Goal: a unit is not driven for a run that its history does not hold, however late the listener hears of it, and what was
/// measured is kept. Method: a history with room for the first steps only, then a step that takes ten minutes, on a bench in
/// virtual time that takes two milliseconds for each scan; who looks on hears nothing until the bench is stopped.
#[test]
fn a_full_disk_stops_the_bench_and_is_no_pass() {
    const LONG: u64 = 60_000;
    let steps = "procedure(title = \"Long\", suspect = \"-\")\n\
        for n in range(2000):\n    step(\"%d: a name that takes some room on the disk\" % n, measure = value(\"v\", speed))\n\
        step(\"waits\", do = [wait(s(600))], measure = value(\"v\", speed))\n";
    let mut plan = plan_of(&[steps]);
    let (folder, first) = store();
    first.close().expect("closed");
    let file = folder.path().join("history.db");
    let database = rusqlite::Connection::open(&file).expect("the database");
    let pages: u32 = database
        .query_row("PRAGMA page_count", [], |row| row.get(0))
        .expect("a number");
    let options = clock::open_options().max_pages(pages + 20);
    let store = Store::open(&file, options).expect("the database");
    let slowly = Arc::new(SlowClock::default());
    let mut setup = setup(&[]);
    setup.run_control = Some(slowly.clone());
    let stop = Stop::default();
    let mut busy = Busy {
        until: stop.clone(),
        at_most: slowly.clone(),
    };
    let kept = run(&mut plan, setup, store, &stop, &mut busy);
    let (kept, outcome) = kept.unwrap_or_else(|failure| panic!("{failure}"));
    let lost = outcome.lost.expect("told").to_string();
    assert!(lost.contains("no room"), "{lost}");
    assert_ne!(outcome.exit, Exit::Passed);
    let steps = kept.run(outcome.id).expect("kept").steps.len();
    assert!(steps >= 2000, "{steps} steps");
    let scans = slowly.0.load(Ordering::Relaxed);
    assert!(scans < LONG / 4, "{scans} scans");
}

/// Takes its time for each scan.
#[derive(Default)]
struct SlowClock(AtomicU64);

impl RunControl for SlowClock {
    fn after_cycle(&self, _: Instant, _: &Rig) {}

    fn before_scan(&self, _: &mut Runner) {
        self.0.fetch_add(1, Ordering::Relaxed);
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Looks on, and hears nothing more when the last step has begun, until the bench is stopped.
struct Busy {
    until: Stop,
    at_most: Arc<SlowClock>,
}

impl Listener for Busy {
    fn on_event(&mut self, _: &Procedure, event: &SessionEvent) {
        use btu_rig::procedure::RunEvent::StepStarted;
        let SessionEvent::Run(StepStarted { name, .. }) = event else {
            return;
        };
        while name == "waits"
            && self.until.presses() == 0
            && self.at_most.0.load(Ordering::Relaxed) < 20_000
        {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

/// Goal: who gives up reaching a unit has not found an error. Method: a port that is there, no unit on it,
/// and stop pressed before it is asked.
#[test]
fn a_run_stopped_before_its_unit_was_reached_is_aborted() {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = format!("tcp:{}", listener.local_addr().expect("its address"));
    let mut setup = setup(&[]);
    setup.endpoint = address.parse::<Endpoint>().expect("an address");
    let stop = Stop::default();
    stop.press();
    let (folder, store) = store();
    let mut plan = plan_of(&[PASSES]);
    let (_, outcome) = run(&mut plan, setup, store, &stop, &mut ()).expect("a recorded run");
    assert_eq!(outcome.exit, Exit::Aborted);
    assert!(outcome.prevented.is_some(), "there is no unit");
    let store = Store::open_read_only(&folder.path().join("history.db")).expect("the database");
    let runs = store.runs(&fault_db::RunFilter::default()).expect("runs");
    let verdicts: Vec<_> = runs.iter().map(|run| run.verdict).collect();
    assert_eq!(verdicts, [Some(fault_db::Verdict::Aborted)]);
}
