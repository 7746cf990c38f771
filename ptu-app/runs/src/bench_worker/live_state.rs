//! The state that the bench thread shares with the window: the latest cycle, the rows before it, and the operator's
//! requests to a run (pause, single step, answers).

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard};
use std::time;

use btu_rig::procedure::Runner;
use btu_rig::procedure::plan::Connection;
use btu_rig::recorder::{Ring, Row, rows_of};
use btu_rig::rig::Rig;
use protocol::message::{Identity, SelfTestItem};
use protocol::signal::Sample;
use protocol::{Duration, Instant};

use super::link_quality::LinkQuality;
use super::waking::{Wake, Waking, Watched};
use crate::pool::held;
use crate::run::RunControl;

/// Rows are kept for this long.
pub const HISTORY: Duration = Duration::from_ms(120_000);

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Phase {
    /// No unit is connected.
    #[default]
    Offline,
    /// A unit is being connected.
    Connecting,
    /// A unit is connected and monitored.
    Idle,
    /// Procedures run.
    Running,
    /// Outputs are being made safe.
    MakingSafe,
}

/// The bench after its latest cycle.
#[derive(Debug, Default)]
pub struct LiveData {
    pub phase: Phase,
    /// Bench time.
    pub now: Instant,
    /// Value of every signal.
    pub sample: Sample,
    /// The unit's answer to the identity request.
    pub identity: Option<Identity>,
    /// How the unit is reached, once that is known.
    pub connection: Option<Connection>,
    /// Share of frames received over the last seconds.
    pub link: LinkQuality,
    /// Results of the last requested self-test, as far as they came.
    pub self_test: Vec<SelfTestItem>,
    /// Restarts of the unit since it was connected.
    pub restarts: u32,
    /// Counts how often the bench was rebuilt or made safe; manual orders of an earlier epoch are not executed.
    pub bench_epoch: u64,
    /// The latest rows, one per 50 ms; cleared when the bench is rebuilt.
    pub rows: Ring<{ rows_of(HISTORY) }>,
}

/// The operator's requests to the present run.
#[derive(Debug, Default)]
struct OperatorRequests {
    paused: bool,
    single_steps: u32,
    answer: Option<bool>,
}

/// Shared between the bench thread, which writes it, and the window.
pub struct LiveState {
    live: Mutex<LiveData>,
    requests: Mutex<OperatorRequests>,
    pending: Mutex<Pending>,
    /// What the window shows, as an index into [`Watched::ALL`].
    watched: AtomicUsize,
    began: time::Instant,
    wake: Wake,
}

/// Used by the bench thread only: rows that could not be published yet, and what the window was last woken for.
#[derive(Default)]
struct Pending {
    rows: Vec<Row>,
    waking: Waking,
}

impl LiveState {
    /// Without a unit; `wake` is called after each change.
    pub fn new(wake: Wake) -> Self {
        Self {
            live: Mutex::default(),
            requests: Mutex::default(),
            pending: Mutex::default(),
            began: time::Instant::now(),
            watched: AtomicUsize::new(Watched::All as usize),
            wake,
        }
    }

    /// Names what the window shows: a change of anything else does not wake the window.
    pub fn watch(&self, watched: Watched) {
        self.watched.store(watched as usize, Ordering::Relaxed);
    }

    fn watched(&self) -> Watched {
        let place = self.watched.load(Ordering::Relaxed);
        Watched::ALL.get(place).copied().unwrap_or_default()
    }

    /// Locks the latest cycle; the bench thread publishes nothing meanwhile.
    pub fn read(&self) -> MutexGuard<'_, LiveData> {
        held(&self.live)
    }

    /// Pauses or resumes the run before its next step.
    pub fn pause(&self, paused: bool) {
        let mut requests = held(&self.requests);
        requests.paused = paused;
        requests.single_steps = 0;
    }

    pub fn paused(&self) -> bool {
        held(&self.requests).paused
    }

    /// Runs one step of a paused run.
    pub fn single_step(&self) {
        held(&self.requests).single_steps += 1;
    }

    /// The answer to the present prompt.
    pub fn answer(&self, yes: bool) {
        held(&self.requests).answer = Some(yes);
    }

    /// Drops requests to an earlier run.
    pub(super) fn clear_requests(&self) {
        *held(&self.requests) = OperatorRequests::default();
    }

    pub(super) fn enter(&self, phase: Phase) {
        {
            let mut live = held(&self.live);
            live.phase = phase;
            if phase == Phase::Offline {
                let bench_epoch = live.bench_epoch + 1;
                *live = LiveData {
                    bench_epoch,
                    ..LiveData::default()
                };
            }
        }
        (self.wake)();
    }

    /// Enters [`Phase::Idle`] together with the identity, so that an idle unit is never shown without it.
    pub(super) fn enter_idle(&self, rig: &Rig) {
        {
            let mut live = held(&self.live);
            live.phase = Phase::Idle;
            live.identity = rig.identity().copied();
            live.connection = rig.connection();
        }
        (self.wake)();
    }

    /// Invalidates manual orders that were given before: the bench was rebuilt or made safe.
    pub(super) fn invalidate_orders(&self) {
        held(&self.live).bench_epoch += 1;
    }

    pub(super) fn wake(&self) {
        (self.wake)();
    }
}

impl RunControl for LiveState {
    fn after_cycle(&self, now: Instant, rig: &Rig) {
        let mut pending = held(&self.pending);
        pending.rows.push(Row {
            at: now,
            sample: rig.sample().clone(),
        });
        // The window is reading: the row is published with the next cycle.
        let Ok(mut live) = self.live.try_lock() else {
            return;
        };
        for row in pending.rows.drain(..) {
            live.rows.push(row);
        }
        live.now = now;
        live.sample.clone_from(rig.sample());
        live.identity = rig.identity().copied();
        live.connection = rig.connection();
        live.link.note(now, rig.counters());
        live.self_test.clear();
        live.self_test.extend(rig.self_test_items());
        live.restarts = rig.unit_restarts();
        drop(live);
        let at = self.began.elapsed();
        if pending.waking.is_due(at, self.watched(), rig.sample()) {
            (self.wake)();
        }
    }

    fn before_scan(&self, runner: &mut Runner) {
        let Ok(mut requests) = self.requests.try_lock() else {
            return;
        };
        if requests.paused {
            runner.pause();
            (0..std::mem::take(&mut requests.single_steps)).for_each(|_| runner.single_step());
        } else {
            runner.resume();
        }
        if let Some(answer) = requests.answer.take() {
            runner.answer(answer);
        }
    }
}
