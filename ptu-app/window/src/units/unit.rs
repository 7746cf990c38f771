//! One unit under test: its bench, its log and its current or last run.

use std::collections::VecDeque;

use btu_rig::procedure::UnitEvent;
use btu_rig::procedure::plan::Connection;
use btu_rig::stimulus::Stimulus;
use protocol::message::Identity;
use protocol::signal::Signal;

use crate::messages::{About, Messages};
use crate::query_worker::QueryWorker;
use crate::request::Request;
use ptu_report::coverage_text;
use ptu_report::words::{Words, fill};
use ptu_runs::bench_worker::{BenchEvent, BenchWorker, Phase, Progress, RunOrder, Wake};
use ptu_runs::failure::Failure;
use ptu_runs::run::{BenchChoice, BenchSetup, SessionEvent, unit_text};

/// Entries of a unit's log that are shown.
const LOG: usize = 500;

pub struct Unit {
    /// Its own number in this window, never used again for another.
    pub id: u64,
    pub choice: BenchChoice,
    pub bench: BenchWorker,
    /// What its bench is made of, once it was asked to connect.
    pub setup: Request<BenchSetup>,
    /// What it and TCMS logged outside runs, oldest first.
    pub log: VecDeque<UnitEvent>,
    /// Its present or last run.
    pub run: Option<Progress>,
    /// Its case asked for that run.
    is_run_of_case: bool,
    pub(super) runs_ended: usize,
    /// The person knows that it cannot be reached.
    lost: bool,
    /// Everything is being stopped, and it is not known to be safe yet.
    pub stopping: bool,
    /// Nothing is begun: no name has been given.
    pub(super) locked: bool,
    /// It was let go without its outputs being confirmed safe.
    pub(super) not_safe: bool,
}

impl Unit {
    pub(super) fn new(id: u64, choice: BenchChoice, wake: Wake) -> Result<Self, Failure> {
        Ok(Self {
            id,
            choice,
            bench: BenchWorker::new(wake)?,
            setup: Request::Idle,
            log: VecDeque::new(),
            run: None,
            is_run_of_case: false,
            runs_ended: 0,
            lost: false,
            stopping: false,
            locked: false,
            not_safe: false,
        })
    }

    /// What its bench's thread is at.
    pub fn phase(&self) -> Phase {
        match self.setup {
            Request::Pending(_) => Phase::Connecting,
            _ => self.bench.live().phase,
        }
    }

    /// A unit is there, run or not.
    pub fn is_connected(&self) -> bool {
        matches!(self.phase(), Phase::Idle | Phase::Running)
    }

    /// A unit is there and waits for a run: nothing is run, nor ordered and not begun yet. A bench that is
    /// held up takes seconds to begin what it was told.
    pub fn may_run(&self) -> bool {
        !self.locked
            && self.phase() == Phase::Idle
            && !self.run.as_ref().is_some_and(Progress::is_running)
    }

    pub fn identity(&self) -> Option<Identity> {
        self.bench.live().identity
    }

    /// Its serial number, once it has told it.
    pub fn serial(&self) -> Option<String> {
        self.identity().as_ref().map(unit_text::serial)
    }

    /// What it is called: its serial number, or where it is.
    pub fn name(&self) -> String {
        self.serial()
            .unwrap_or_else(|| self.choice.endpoint.clone())
    }

    pub fn connect(&mut self, queries: &QueryWorker) {
        if self.locked {
            return;
        }
        let choice = self.choice.clone().with_offered_faults();
        self.setup = Request::Pending(queries.run(move |paths| choice.setup(&paths.scripts)));
    }

    /// Lets it go, or gives up reaching it.
    pub fn disconnect(&mut self) {
        if matches!(self.setup, Request::Pending(_)) {
            self.setup = Request::Idle;
        }
        self.bench.disconnect();
    }

    /// Stops its run, takes every stimulus away and disarms.
    pub(super) fn stop_all(&mut self) {
        self.stopping = self.is_connected();
        self.bench.stop_all();
    }

    /// Begins a run, perhaps one of the unit's case, if nothing else has the bench; whether it did.
    pub fn begin(&mut self, order: RunOrder, of_case: bool) -> bool {
        if !self.may_run() {
            return false;
        }
        self.run = Some(Progress::new(&order.plan, self.name()));
        self.is_run_of_case = of_case;
        self.bench.run(order);
        true
    }

    /// Its present or last run, if that is one of its case: a run that another page asked for says nothing of the case.
    pub fn run_of_case(&self) -> Option<&Progress> {
        self.run.as_ref().filter(|_| self.is_run_of_case)
    }

    /// Answers what the run's script asks; it asks nothing more then.
    pub fn answer(&mut self, yes: bool) {
        if let Some(present) = self.run.as_mut().and_then(|run| run.present.as_mut())
            && present.prompt.take().is_some()
        {
            self.bench.live_state().answer(yes);
        }
    }

    /// How it is reached: as was found out, or as far as is known before.
    pub fn connection(&self) -> Connection {
        let found = self.bench.live().connection;
        found.unwrap_or_else(|| self.choice.connection())
    }

    pub fn is_armed(&self) -> bool {
        self.bench.live().sample.get(Signal::Armed) == Some(1.0)
    }

    /// Takes test signals away and disarms, unless a run has the bench.
    pub(super) fn disarm(&mut self) {
        if self.is_armed() && self.bench.permits(&Stimulus::PtuDisarm).is_ok() {
            // Refused only while a run has the bench.
            let _ = self.bench.apply(Stimulus::PtuDisarm);
        }
    }

    /// Takes what happened since the last time, and tells the person what matters.
    pub(super) fn poll(&mut self, words: &Words, said: &mut UnitMessages<'_>) {
        let connection = About::Connection(self.id);
        if self.setup.poll() {
            said.messages.over(connection);
            match &self.setup {
                Request::Ready(setup) => self.bench.connect(setup.clone()),
                Request::Failed(why) => {
                    said.trouble(connection, words.frame.cannot_connect, why.clone());
                }
                _ => {}
            }
        }
        let events: Vec<_> = self.bench.events().collect();
        for event in events {
            self.on_event(event, words, said);
        }
    }

    fn on_event(&mut self, event: BenchEvent, words: &Words, said: &mut UnitMessages<'_>) {
        let frame = &words.frame;
        let (connection, this_run) = (About::Connection(self.id), About::Run(self.id));
        if ends_stop(&event) {
            self.stopping = false;
        }
        match event {
            BenchEvent::Connected { serial } => {
                self.log.clear();
                self.lost = false;
                self.not_safe = false;
                // The run shown belongs to another unit.
                if self.run.as_ref().is_some_and(|run| run.unit != serial) {
                    self.run = None;
                }
                said.note(connection, fill(frame.is_connected, &[("unit", &serial)]));
            }
            BenchEvent::NotConnected(why) => said.trouble(connection, frame.cannot_connect, why),
            BenchEvent::Disconnected { safe: true } => {
                said.note(connection, frame.is_disconnected);
            }
            BenchEvent::Disconnected { safe: false } | BenchEvent::NotSafe => {
                self.not_safe = true;
                said.trouble(None, frame.not_safe, "");
            }
            BenchEvent::StopEnded => {}
            BenchEvent::LinkLost(why) => self.lose(why, words, said),
            BenchEvent::Broken => {
                self.not_safe = true;
                said.trouble(None, frame.broken, "");
                if let Some(run) = self.run.as_mut().filter(|run| run.is_running()) {
                    run.end(None);
                }
            }
            BenchEvent::UnitRestarted => said.trouble(None, frame.unit_restarted, ""),
            BenchEvent::NotDone { asked, why } => {
                said.trouble(None, fill(frame.not_done, &[("what", &asked)]), why);
            }
            BenchEvent::Logged(entry) => {
                if self.log.len() == LOG {
                    self.log.pop_front();
                }
                self.log.push_back(entry);
            }
            BenchEvent::Run { procedure, event } => {
                if let SessionEvent::LinkLost(why) = &event {
                    self.lose(why.clone(), words, said);
                }
                if let Some(run) = &mut self.run {
                    run.on_event(&procedure, &event);
                }
            }
            BenchEvent::RunEnded(outcome) => {
                self.runs_ended += 1;
                let verdict = words.common.verdict(outcome.verdict);
                let mut ended = fill(frame.run_ended, &[("verdict", &verdict)]);
                let coverage = self.run.as_ref().map(Progress::coverage);
                if let Some(part) = coverage.and_then(|coverage| coverage_text(&coverage, words)) {
                    ended += &format!(" ({part})");
                }
                said.note(this_run, ended);
                if let Some(run) = &mut self.run {
                    run.end(Some(outcome));
                }
            }
            BenchEvent::RunFailed(why) => {
                self.runs_ended += 1;
                said.trouble(this_run, frame.run_failed, why);
                if let Some(run) = &mut self.run {
                    run.end(None);
                }
            }
        }
    }

    /// Said once, though every procedure of a run finds it out for itself.
    fn lose(&mut self, why: String, words: &Words, said: &mut UnitMessages<'_>) {
        self.stopping = false;
        if !std::mem::replace(&mut self.lost, true) {
            said.trouble(About::Connection(self.id), words.frame.link_lost, why);
        }
    }
}

/// Whether what was being stopped is stopped, or cannot be stopped any more.
fn ends_stop(event: &BenchEvent) -> bool {
    matches!(
        event,
        BenchEvent::Disconnected { .. }
            | BenchEvent::NotSafe
            | BenchEvent::StopEnded
            | BenchEvent::Broken
            | BenchEvent::RunEnded(_)
            | BenchEvent::RunFailed(_)
    )
}

/// Messages that say which unit they are about when there are several.
pub(super) struct UnitMessages<'a> {
    pub unit: Option<String>,
    pub messages: &'a mut Messages,
}

impl UnitMessages<'_> {
    fn named(&self, text: impl Into<String>) -> String {
        let text = text.into();
        match &self.unit {
            Some(unit) => format!("{unit}: {text}"),
            None => text,
        }
    }

    fn trouble(
        &mut self,
        about: impl Into<Option<About>>,
        text: impl Into<String>,
        detail: impl Into<String>,
    ) {
        let text = self.named(text);
        self.messages.trouble_about(about, text, detail);
    }

    fn note(&mut self, about: impl Into<Option<About>>, text: impl Into<String>) {
        let text = self.named(text);
        self.messages.note_about(about, text);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, OnceLock};
    use std::time::{Duration, Instant};

    use super::*;
    use ptu_report::words::Language;
    use ptu_runs::bench_worker::LiveState;
    use ptu_runs::data::ScriptsDirectory;
    use ptu_runs::run::{RunPlan, Suite, Task};

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
        let task = |procedure| Task {
            procedure,
            options: Default::default(),
        };
        RunOrder {
            plan: RunPlan {
                tasks: suite.procedures.into_iter().map(task).collect(),
                jobs: 1,
                stop_on_fail: false,
                operator: String::new(),
                train: String::new(),
                symptom: None,
                scripts_sha256: suite.sha256,
                adaptive: None,
                continues: None,
                measuring: Default::default(),
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
        until(&mut unit, &|unit| unit.may_run());
        assert_eq!(unit.runs_ended, 1);
        assert!(unit.run.as_ref().is_some_and(|run| run.id().is_some()));
        assert!(
            unit.begin(order(&database, &setup), false),
            "and then again"
        );
        until(&mut unit, &|unit| unit.may_run());
        assert_eq!(unit.runs_ended, 2);
    }
}
