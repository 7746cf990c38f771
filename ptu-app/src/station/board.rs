//! What a bench shows: its latest cycle, the rows before it, and what its operator wishes of a run.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time;

use btu_rig::procedure::Runner;
use btu_rig::rig::Rig;
use protocol::message::Identity;
use protocol::signal::{Sample, Signal};
use protocol::{CYCLE, Duration, Instant};

use super::{LinkQuality, Wake};
use crate::run::Attendant;

/// Rows are kept for this long.
pub const HISTORY: Duration = Duration::from_ms(120_000);
const ROWS: usize = (HISTORY.as_us() / CYCLE.as_us()) as usize;
/// Whoever looks on is woken at most this often …
const OFTEN: time::Duration = time::Duration::from_millis(33);
/// … and at least this often while nothing changes but the time and counts.
const SELDOM: time::Duration = time::Duration::from_secs(1);
/// … or this often, when only the connection bar shows the unit.
const RARELY: time::Duration = time::Duration::from_secs(5);
/// Counts that run on while a unit does nothing: not worth waking anybody.
const COUNTS: [Signal; 2] = [Signal::TwcReceived, Signal::TwcAnswers];
/// What the connection bar shows, whatever page is in front.
const ALWAYS_SHOWN: [Signal; 2] = [Signal::Armed, Signal::MaintenanceKey];

/// What the bench's thread is at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Phase {
    /// No unit.
    #[default]
    Offline,
    /// A unit is being reached.
    Connecting,
    /// A unit is connected and nothing is run.
    Idle,
    /// A run has the bench.
    Running,
    /// Outputs are being made safe, then the unit is let go.
    MakingSafe,
}

/// Every signal at the end of one cycle.
#[derive(Clone, Debug)]
pub struct Row {
    /// When, on the bench.
    pub at: Instant,
    values: [f64; Signal::COUNT],
}

impl Row {
    /// A signal's value; NaN when it was not known.
    pub fn value(&self, signal: Signal) -> f64 {
        self.values[signal.index()]
    }
}

/// A bench as it is now.
#[derive(Debug, Default)]
pub struct Live {
    /// What the thread is at.
    pub phase: Phase,
    /// Time on the bench.
    pub now: Instant,
    /// Every signal.
    pub sample: Sample,
    /// Who the unit is.
    pub identity: Option<Identity>,
    /// How well frames come through.
    pub link: LinkQuality,
    /// Times the unit was started again.
    pub restarts: u32,
    /// Counts benches made anew and made safe: what was given by hand before is gone.
    pub generation: u64,
    /// The latest rows, oldest first, one per 50 ms; they begin anew with each bench.
    pub rows: VecDeque<Row>,
}

/// What the operator wishes of a run.
#[derive(Debug, Default)]
struct Direction {
    paused: bool,
    single_steps: u32,
    answer: Option<bool>,
}

/// Shared between the bench's thread and who looks on.
pub struct Board {
    live: Mutex<Live>,
    direction: Mutex<Direction>,
    pending: Mutex<Pending>,
    /// Its signals are looked at.
    watched: AtomicBool,
    wake: Wake,
}

/// The bench's own side: rows that could not be shown yet.
struct Pending {
    rows: Vec<Row>,
    woken: time::Instant,
    shown: [u64; Signal::COUNT],
}

impl Board {
    /// An empty board; `wake` is called when it changes.
    pub fn new(wake: Wake) -> Self {
        Self {
            live: Mutex::default(),
            direction: Mutex::default(),
            pending: Mutex::new(Pending {
                rows: Vec::new(),
                woken: time::Instant::now(),
                shown: [0; Signal::COUNT],
            }),
            watched: AtomicBool::new(true),
            wake,
        }
    }

    /// Whether its signals are looked at: if not, only what the connection bar shows wakes anybody.
    pub fn watch(&self, watched: bool) {
        self.watched.store(watched, Ordering::Relaxed);
    }

    /// The bench as it is now; hold it shortly.
    pub fn read(&self) -> MutexGuard<'_, Live> {
        held(&self.live)
    }

    /// No further step begins, or steps begin again.
    pub fn pause(&self, paused: bool) {
        let mut direction = held(&self.direction);
        direction.paused = paused;
        direction.single_steps = 0;
    }

    /// Whether the run is to pause.
    pub fn paused(&self) -> bool {
        held(&self.direction).paused
    }

    /// One more step of a paused run.
    pub fn single_step(&self) {
        held(&self.direction).single_steps += 1;
    }

    /// The answer to the present prompt.
    pub fn answer(&self, yes: bool) {
        held(&self.direction).answer = Some(yes);
    }

    /// Nothing is wished of the next run.
    pub(super) fn clear_direction(&self) {
        *held(&self.direction) = Direction::default();
    }

    /// The bench's thread is at something else.
    pub(super) fn enter(&self, phase: Phase) {
        {
            let mut live = held(&self.live);
            live.phase = phase;
            if phase == Phase::Offline {
                let generation = live.generation + 1;
                *live = Live {
                    generation,
                    ..Live::default()
                };
            }
        }
        (self.wake)();
    }

    /// A unit is there to be worked with, and it is known which one: whoever sees the one sees the other.
    pub(super) fn enter_idle(&self, identity: Option<Identity>) {
        {
            let mut live = held(&self.live);
            live.phase = Phase::Idle;
            live.identity = identity;
        }
        (self.wake)();
    }

    /// What was given by hand is gone: the bench is another one, or was made safe.
    pub(super) fn begin_anew(&self) {
        held(&self.live).generation += 1;
    }

    pub(super) fn wake(&self) {
        (self.wake)();
    }
}

impl Board {
    fn is_worth_a_look(&self, before: &[u64; Signal::COUNT], now: &[u64; Signal::COUNT]) -> bool {
        let differs = |signal: &Signal| before[signal.index()] != now[signal.index()];
        if self.watched.load(Ordering::Relaxed) {
            let mut signals = Signal::ALL.iter();
            signals.any(|signal| differs(signal) && !COUNTS.contains(signal))
        } else {
            ALWAYS_SHOWN.iter().any(differs)
        }
    }
}

impl Attendant for Board {
    fn see(&self, now: Instant, rig: &Rig) {
        let mut pending = held(&self.pending);
        pending.rows.push(Row {
            at: now,
            values: *rig.sample().values(),
        });
        // Somebody reads at this moment: the next cycle will be shown with this one.
        let Ok(mut live) = self.live.try_lock() else {
            return;
        };
        for row in pending.rows.drain(..) {
            if live.rows.back().is_some_and(|last| row.at < last.at) {
                live.rows.clear();
            }
            if live.rows.len() == ROWS {
                live.rows.pop_front();
            }
            live.rows.push_back(row);
        }
        live.now = now;
        live.sample.clone_from(rig.sample());
        live.identity = rig.identity().copied();
        live.link.note(now, rig.counters());
        live.restarts = rig.unit_restarts();
        drop(live);
        let shown = rig.sample().values().map(f64::to_bits);
        let since = pending.woken.elapsed();
        let watched = self.watched.load(Ordering::Relaxed);
        let at_least = if watched { SELDOM } else { RARELY };
        if since >= at_least || (since >= OFTEN && self.is_worth_a_look(&pending.shown, &shown)) {
            pending.woken = time::Instant::now();
            pending.shown = shown;
            (self.wake)();
        }
    }

    fn direct(&self, runner: &mut Runner) {
        let Ok(mut direction) = self.direction.try_lock() else {
            return;
        };
        if direction.paused {
            runner.pause();
            (0..std::mem::take(&mut direction.single_steps)).for_each(|_| runner.single_step());
        } else {
            runner.resume();
        }
        if let Some(answer) = direction.answer.take() {
            runner.answer(answer);
        }
    }
}

/// What a lock holds, also after whoever held it panicked: everything in here is whole at any time.
fn held<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}
