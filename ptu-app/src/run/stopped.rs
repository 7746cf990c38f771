//! What a run comes to that was stopped between its procedures, when none was under way to say so.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use btu_rig::procedure::{Procedure, Runner, loader};
use btu_rig::rig::Rig;
use fault_db::Store;
use protocol::Instant;

use super::{
    Attendant, Began, BenchSetup, Listener, Outcome, RunPlan, SessionEvent, Suite, Task, run,
    run_on,
};
use crate::clock;
use crate::data::ScriptsDirectory;
use crate::diagnosis;
use crate::failure::Exit;
use crate::gui::UnitChoice;
use crate::link::Endpoint;
use crate::stop::Stop;

const PASSES: &str =
    "procedure(title = \"Wait\", suspect = \"-\")\nstep(\"waits\", do = [wait(ms(200))])\n";
const FAILS: &str = "procedure(title = \"Alarm\", suspect = \"-\")\n\
     step(\"sounds\", expect = [becomes(alarm, True, within = ms(200))])\n";

/// Counts the scans of all procedures, and presses stop before one of them.
#[derive(Default)]
struct Presser {
    count: Mutex<Count>,
    /// Before this scan, counted from 1.
    at: Option<usize>,
    stop: Stop,
}

#[derive(Default)]
struct Count {
    scans: usize,
    now: Instant,
    /// Scans before each bench made anew.
    before: Vec<usize>,
}

impl Attendant for Presser {
    fn see(&self, now: Instant, _: &Rig) {
        let mut count = self.count.lock().expect("no thread panics with it");
        if now < count.now {
            let scans = count.scans;
            count.before.push(scans);
        }
        count.now = now;
    }

    fn direct(&self, _: &mut Runner) {
        let mut count = self.count.lock().expect("no thread panics with it");
        count.scans += 1;
        // The scan has asked for a stop already: this one is heeded by what comes after it.
        if Some(count.scans) == self.at {
            self.stop.press();
        }
    }
}

struct Deaf;

impl Listener for Deaf {
    fn hear(&mut self, _: &Procedure, _: &SessionEvent) {}
}

fn directory() -> ScriptsDirectory {
    let scripts = concat!(env!("CARGO_MANIFEST_DIR"), "/../scripts");
    ScriptsDirectory::find(Some(scripts.as_ref())).expect("scripts")
}

fn setup() -> BenchSetup {
    let choice = UnitChoice::default().named().expect("the embedded unit");
    choice.setup(&directory()).expect("its configuration")
}

/// A database of its own and the folder that holds it.
fn store() -> (tempfile::TempDir, Store) {
    let folder = tempfile::tempdir().expect("a folder");
    let store = Store::open(&folder.path().join("history.db"), clock::open_options());
    (folder, store.expect("a database"))
}

fn plan(procedures: impl IntoIterator<Item = Arc<Procedure>>) -> RunPlan {
    let task = |procedure| Task {
        procedure,
        options: Default::default(),
    };
    RunPlan {
        tasks: procedures.into_iter().map(task).collect(),
        jobs: 1,
        stop_on_fail: false,
        operator: String::new(),
        train: String::new(),
        scripts_sha256: String::new(),
        adaptive: None,
    }
}

/// Procedures of these texts, in their order.
fn plan_of(texts: &[&str]) -> RunPlan {
    let setup = setup();
    let named = |(place, text): (usize, &&str)| (format!("{place}.star"), (*text).to_owned());
    let texts: BTreeMap<_, _> = texts.iter().enumerate().map(named).collect();
    let (config, line) = (&setup.config.content, &setup.line.content);
    let loaded = loader::load(&texts, config, line, &setup.train);
    assert!(loaded.errors.is_empty(), "{:?}", loaded.errors);
    plan(loaded.procedures)
}

/// Runs it with somebody at the bench; what it came to, and the verdict that is stored.
fn run_with(
    presser: &Arc<Presser>,
    plan: &RunPlan,
    mut setup: BenchSetup,
) -> (Outcome, fault_db::Verdict) {
    setup.attendant = Some(presser.clone());
    let mut connected = setup.connect(&presser.stop).expect("the embedded unit");
    let (_folder, store) = store();
    let (began, stop) = (Began::now(), &presser.stop);
    let ran = run_on(&mut connected, &began, plan, &setup, store, stop, &mut Deaf);
    let (store, outcome) = ran.expect("it is recorded");
    let stored = store.run(outcome.id, &|_| true).expect("the run").run;
    (outcome, stored.verdict.expect("it is over"))
}

/// The last scan of each procedure, counted in a run that nobody stops; in virtual time they are the same
/// in every run.
fn ends(plan: &RunPlan) -> Vec<usize> {
    let counter = Arc::new(Presser::default());
    run_with(&counter, plan, setup());
    let count = counter.count.lock().expect("no thread panics with it");
    let ends = [&count.before[..], &[count.scans]].concat();
    // A search may come back to one.
    assert!(ends.len() >= plan.tasks.len(), "all of them were run");
    ends
}

/// Stop pressed in this scan.
fn stopped_at(scan: usize, plan: &RunPlan) -> (Outcome, fault_db::Verdict) {
    let presser = Arc::new(Presser {
        at: Some(scan),
        ..Presser::default()
    });
    let came_to = run_with(&presser, plan, setup());
    assert_eq!(presser.stop.presses(), 1);
    came_to
}

/// Stop pressed in the last scan of the procedure with this place: too late for it, and before the next.
fn stopped_after(place: usize, plan: &RunPlan) -> (Outcome, fault_db::Verdict) {
    stopped_at(ends(plan)[place], plan)
}

#[test]
fn a_run_stopped_before_its_first_procedure_is_aborted() {
    let presser = Arc::new(Presser::default());
    presser.stop.press();
    let (outcome, stored) = run_with(&presser, &plan_of(&[PASSES]), setup());
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

/// What nothing was left out of has its own verdict, and so has a run that was to end there by itself.
#[test]
fn a_stop_that_comes_too_late_changes_no_verdict() {
    let plan = plan_of(&[PASSES, PASSES]);
    assert_eq!(stopped_after(1, &plan).1, fault_db::Verdict::Passed);
    let mut plan = plan_of(&[FAILS, PASSES]);
    let at = ends(&plan)[0];
    plan.stop_on_fail = true;
    let (_, stored) = stopped_at(at, &plan);
    assert_eq!(stored, fault_db::Verdict::Failed);
}

/// Goal: a search for a part that was stopped is not taken for one that found nothing more. Method: an
/// adaptive run on a good unit, which it leaves after the last procedure only, stopped after the first.
#[test]
fn a_search_stopped_between_two_procedures_is_aborted() {
    let setup = setup();
    let two = ["atp/limit_speed", "door/interlocks"].map(str::to_owned);
    let suite = Suite::load(&directory(), &two, &setup).expect("the suite");
    assert_eq!(suite.procedures.len(), 2);
    let mut plan = plan(suite.procedures);
    for task in &mut plan.tasks {
        task.options.one_by_one = true;
    }
    let choice = UnitChoice::default();
    let bench = diagnosis::Bench {
        unit_config_sha256: &setup.config.sha256,
        line: &choice.line,
        train: &choice.train,
    };
    let serial = setup.expected_serial();
    let (_folder, store) = store();
    let adaptive = diagnosis::adaptive(&store, &directory(), &serial, &bench);
    plan.adaptive = Some(adaptive.expect("the shipped dictionary"));
    let (outcome, stored) = stopped_after(0, &plan);
    assert_eq!(stored, fault_db::Verdict::Aborted);
    assert_eq!(outcome.exit, Exit::Aborted);
}

/// Goal: who gives up reaching a unit has not found an error. Method: a port that is there, nobody on it,
/// and stop pressed before it is asked.
#[test]
fn a_run_stopped_before_its_unit_was_reached_is_aborted() {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = format!("tcp:{}", listener.local_addr().expect("its address"));
    let mut setup = setup();
    setup.endpoint = address.parse::<Endpoint>().expect("an address");
    let stop = Stop::default();
    stop.press();
    let (folder, store) = store();
    let plan = plan_of(&[PASSES]);
    let Err(failure) = run(&plan, setup, store, &stop, &mut Deaf) else {
        panic!("there is no unit")
    };
    assert_eq!(failure.exit, Exit::Aborted, "{}", failure.message);
    let store = Store::open_read_only(&folder.path().join("history.db")).expect("the database");
    let runs = store
        .runs(&fault_db::RunFilter::default(), &|_| true)
        .expect("runs");
    let verdicts: Vec<_> = runs.iter().map(|run| run.verdict).collect();
    assert_eq!(verdicts, [Some(fault_db::Verdict::Aborted)]);
}
