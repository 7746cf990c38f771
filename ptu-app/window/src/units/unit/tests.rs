//! Orders on a bench that is held up.

use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use super::*;
use ptu_report::words::Language;
use ptu_runs::bench_worker::LiveState;
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::run::{RunPlan, Suite};

/// Longest time anything here takes to come about.
const PATIENCE: Duration = Duration::from_secs(300);

fn scripts() -> ScriptsDirectory {
    let scripts = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scripts");
    ScriptsDirectory::find(Some(scripts.as_ref())).expect("scripts")
}

/// Blocks the bench thread, once it shows an idle unit, until it is released.
#[derive(Default)]
struct BlockedBench(OnceLock<Arc<LiveState>>, OnceLock<()>);

impl BlockedBench {
    fn look(&self) {
        let on_bench = std::thread::current().name() == Some("bench");
        let idle = |live_state: &Arc<LiveState>| live_state.read().phase == Phase::Idle;
        if on_bench && self.0.get().is_some_and(idle) {
            self.1.wait();
        }
    }
}

/// Lets it go also when the test fails: a unit waits for its bench's thread.
struct ReleaseOnDrop(Arc<BlockedBench>);

impl Drop for ReleaseOnDrop {
    fn drop(&mut self) {
        let _ = self.0.1.set(());
    }
}

fn order(database: &std::path::Path, setup: &BenchSetup) -> RunOrder {
    let chosen = ["door/interlocks".to_owned()];
    let suite = Suite::load(&scripts(), &chosen, setup).expect("the suite");
    RunOrder {
        plan: RunPlan {
            scripts_sha256: suite.sha256,
            ..RunPlan::of(suite.procedures)
        },
        store: fault_db::Store::open(database, ptu_runs::clock::open_options())
            .expect("a database"),
        realtime: false,
    }
}

/// Goal: one click is one run. Method: a bench that is held up and takes its orders late; what is
/// ordered meanwhile is refused, until the run is over.
#[test]
fn a_run_that_a_bench_has_not_begun_yet_is_not_ordered_again() {
    let held_up = Arc::<BlockedBench>::default();
    let wake = {
        let held_up = held_up.clone();
        Arc::new(move || held_up.look())
    };
    let mut unit = Unit::new(0, BenchChoice::default(), wake).expect("a thread");
    let let_go = ReleaseOnDrop(held_up.clone());
    assert!(held_up.0.set(unit.bench.live_state().clone()).is_ok());
    let setup = unit.choice.setup(&scripts()).expect("its configuration");
    unit.bench.connect(setup.clone());
    let began = Instant::now();
    let until = |unit: &mut Unit, holds: &dyn Fn(&Unit) -> bool| {
        let mut messages = Messages::default();
        while !holds(unit) {
            assert!(began.elapsed() < PATIENCE, "waited in vain");
            let mut said = UnitMessages {
                unit: None,
                messages: &mut messages,
            };
            unit.poll(Language::English.words(), &mut said);
            std::thread::sleep(Duration::from_millis(5));
        }
    };
    until(&mut unit, &|unit| unit.phase() == Phase::Idle);
    assert!(unit.may_run());

    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("history.db");
    assert!(unit.begin(order(&database, &setup), false));
    // As far as anybody sees, nothing has begun.
    assert_eq!(unit.phase(), Phase::Idle);
    assert!(!unit.may_run());
    assert!(!unit.begin(order(&database, &setup), false));

    drop(let_go);
    // The time left is told as what it takes at most, which never grows.
    let left_s = std::cell::Cell::new(f64::INFINITY);
    until(&mut unit, &|unit| {
        let now_s = unit.run.as_ref().map_or(0.0, Progress::left_s);
        assert!(now_s <= left_s.replace(now_s));
        unit.may_run()
    });
    assert_eq!(left_s.get(), 0.0);
    assert_eq!(unit.runs_ended, 1);
    assert!(unit.run.as_ref().is_some_and(|run| run.id().is_some()));
    assert!(
        unit.begin(order(&database, &setup), false),
        "and then again"
    );
    until(&mut unit, &|unit| unit.may_run());
    assert_eq!(unit.runs_ended, 2);
}

/// Goal: a run is not continued on another unit. Method: one broke off, and another unit answers at its port, then the same again.
#[test]
fn a_run_that_broke_off_can_only_be_ended_once_another_unit_is_connected() {
    let mut unit = Unit::new(0, BenchChoice::default(), Arc::new(|| {})).expect("a thread");
    let setup = unit.choice.setup(&scripts()).expect("its configuration");
    let folder = tempfile::tempdir().expect("a folder");
    let plan = order(&folder.path().join("history.db"), &setup).plan;
    let mut messages = Messages::default();
    let mut connected = |unit: &mut Unit, serial: &str| {
        let serial = serial.to_owned();
        let mut said = UnitMessages {
            unit: None,
            messages: &mut messages,
        };
        let words = Language::English.words();
        unit.on_event(BenchEvent::Connected { serial }, words, &mut said);
    };
    (unit.run, unit.waits) = (Some(Progress::new(&plan, "A-1".into())), true);
    connected(&mut unit, "B-2");
    assert!(unit.is_other && unit.run.is_some());
    connected(&mut unit, "A-1");
    assert!(!unit.is_other && unit.run.is_some());
    connected(&mut unit, "B-2");
    unit.end_run();
    assert!(!unit.is_other && unit.run.is_none());
}
