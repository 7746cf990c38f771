//! One unit under test and the thread that drives its bench, for the window.
//!
//! ```text
//! window → Order → bench thread (live monitoring or a run) → LiveState (latest cycle, rows of the plot)
//!                                                          ↘ BenchEvent (what happened, in order)
//! ```
//! The bench thread never waits for the window. A cycle that ends while the window reads the live state is shown
//! with the next one. The queue of events has no limit, because a lost end of a run would be worse than the
//! memory it takes while the window is not drawn.

mod bench_thread;
mod event;
mod link_quality;
mod live_state;
mod order;
mod permit;
mod progress;
mod waking;

use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::JoinHandle;

use btu_rig::stimulus::Stimulus;

pub use event::BenchEvent;
pub use link_quality::LinkQuality;
pub use live_state::{HISTORY, LiveData, LiveState, Phase};
pub use order::RunOrder;
pub use permit::{Refused, permit};
pub use progress::{ProcedureProgress, Progress, RunPosition, Waiting, outside_place};
pub use waking::{Wake, Watched};

use crate::failure::{Failure, RunTrouble};
use crate::run::BenchSetup;
use crate::stop::Stop;
use bench_thread::BenchThread;
use order::Order;

/// The window's side of a bench thread. Dropping it stops the run, makes outputs safe and disarms.
pub struct BenchWorker {
    orders: Option<Sender<Order>>,
    live_state: Arc<LiveState>,
    events: Receiver<BenchEvent>,
    stop: Stop,
    thread: Option<JoinHandle<()>>,
}

impl BenchWorker {
    /// State of the run that the operator acts on: pause, single step, answers.
    pub fn live_state(&self) -> &Arc<LiveState> {
        &self.live_state
    }

    /// Stops the run that was ordered last: the first press ends the step and goes on to clean-up, the second cuts that short.
    pub fn stop(&self) -> &Stop {
        &self.stop
    }

    /// Starts the bench thread, without a unit.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(wake: Wake) -> Result<Self, Failure> {
        let (orders, receiver) = mpsc::channel();
        let (sender, events) = mpsc::channel();
        let live_state = Arc::new(LiveState::new(wake));
        let bench_thread = BenchThread::new(live_state.clone(), sender);
        let thread = std::thread::Builder::new()
            .name("bench".into())
            .spawn(move || bench_thread.run_until_closed(&receiver))
            .map_err(|error| Failure::bench(RunTrouble::NoThread(error.to_string())))?;
        Ok(Self {
            orders: Some(orders),
            live_state,
            events,
            stop: Stop::default(),
            thread: Some(thread),
        })
    }

    /// Reaches a unit, as a bench that drives all its inputs or as a laptop on its maintenance port: which of the
    /// two is found out or said in `setup`.
    pub fn connect(&mut self, setup: BenchSetup) {
        self.live_state.enter(Phase::Connecting);
        self.stop = Stop::default();
        let setup = Box::new(setup);
        self.send(Order::Connect(setup, self.stop.clone()));
    }

    /// Makes outputs safe, disarms and lets the unit go.
    pub fn disconnect(&self) {
        self.stop.press();
        self.send(Order::Disconnect);
    }

    /// Applies a stimulus by hand.
    ///
    /// # Errors
    /// The stimulus is not possible now, or not with this connection; see [`permit`].
    pub fn apply(&self, stimulus: Stimulus) -> Result<(), Refused> {
        self.permits(&stimulus)?;
        let bench_epoch = self.live_state.read().bench_epoch;
        self.send(Order::Apply(stimulus, bench_epoch));
        Ok(())
    }

    /// Turns the maintenance key on, which is a person's to do on a train, and arms the unit.
    pub fn arm(&self) {
        let bench_epoch = self.live_state.read().bench_epoch;
        self.send(Order::Arm(bench_epoch));
    }

    /// Whether `stimulus` can be given by hand now.
    ///
    /// # Errors
    /// The reason why it cannot.
    pub fn permits(&self, stimulus: &Stimulus) -> Result<(), Refused> {
        permit(stimulus, &self.live_state.read())
    }

    /// Stops a run and takes every stimulus away; the unit stays connected, disarmed.
    ///
    /// Asked for again it does no more: clean-up is cut short only by [`stop`](Self::stop).
    pub fn stop_all(&self) {
        self.stop.press_once();
        self.send(Order::MakeSafe);
    }

    /// Runs procedures.
    pub fn run(&mut self, order: RunOrder) {
        self.live_state.clear_requests();
        self.stop = Stop::default();
        self.send(Order::Run(Box::new(order), self.stop.clone()));
    }

    /// The latest cycle and the rows before it; held for as short a time as possible.
    pub fn live(&self) -> std::sync::MutexGuard<'_, LiveData> {
        self.live_state.read()
    }

    /// Events since the last call.
    pub fn events(&self) -> impl Iterator<Item = BenchEvent> + '_ {
        self.events.try_iter()
    }

    /// Stops and disconnects; true once the bench's thread has ended.
    pub fn close(&mut self) -> bool {
        if self.orders.take().is_some() {
            self.stop.press();
        }
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// The thread receives until this is dropped.
    fn send(&self, order: Order) {
        if let Some(orders) = &self.orders {
            let _ = orders.send(order);
        }
    }
}

impl Drop for BenchWorker {
    fn drop(&mut self) {
        self.close();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
