//! A unit and the bench thread that serves it: what stands behind a window.
//!
//! ```text
//! window → Order → thread (bench: idle and live, or a run) → Board (latest cycle, rows of the plot)
//!                                                          ↘ News (what happened, in order)
//! ```
//! The thread never waits for who looks on: a cycle that finds the board being read is shown with
//! the next one, and news wait in a queue that is as long as it takes: losing the end of a run would
//! be worse than some memory while a window is not painted.

mod board;
mod link_quality;
mod news;
mod permit;
mod progress;
mod serve;

use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::JoinHandle;

use btu_rig::procedure::plan::Connection;
use btu_rig::stimulus::Stimulus;

pub use board::{Board, HISTORY, Live, Phase, Row};
pub use link_quality::LinkQuality;
pub use news::{News, RunNews};
pub use permit::{Refused, permit};
pub use progress::{Present, ProcedureProgress, Progress, Waiting};

use crate::failure::Failure;
use crate::run::{BenchSetup, RunPlan};
use crate::stop::Stop;
use serve::Server;

/// Told when there is something new to look at; must not block.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// What is to be run and where it is recorded.
pub struct RunOrder {
    /// Procedures and steps.
    pub plan: RunPlan,
    /// The database the run is recorded in, open: a bench does not wait for one.
    pub store: fault_db::Store,
    /// The embedded unit runs at the wall clock's pace.
    pub realtime: bool,
}

/// What the bench is told.
enum Order {
    Connect(Box<BenchSetup>, Connection, Stop),
    Disconnect,
    /// A stimulus for the bench as it was then, by its generation.
    Apply(Stimulus, u64),
    Arm(u64),
    MakeSafe,
    Run(Box<RunOrder>, Stop),
}

/// A unit at the window. Dropping it stops what runs, makes outputs safe and disarms.
pub struct Station {
    orders: Option<Sender<Order>>,
    board: Arc<Board>,
    news: Receiver<News>,
    /// Of what was ordered last.
    stop: Stop,
    thread: Option<JoinHandle<()>>,
    connection: Connection,
}

impl Station {
    /// A station that is not connected.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(wake: Wake) -> Result<Self, Failure> {
        let (orders, receiver) = mpsc::channel();
        let (sender, news) = mpsc::channel();
        let board = Arc::new(Board::new(wake));
        let server = Server::new(board.clone(), sender);
        let thread = std::thread::Builder::new()
            .name("bench".into())
            .spawn(move || server.serve_whatever_happens(&receiver))
            .map_err(|error| Failure::bench(format!("cannot start a bench thread: {error}")))?;
        Ok(Self {
            orders: Some(orders),
            board,
            news,
            stop: Stop::default(),
            thread: Some(thread),
            connection: Connection::Btu,
        })
    }

    /// Reaches a unit, as a bench that drives all its inputs or as a laptop on its maintenance port.
    pub fn connect(&mut self, setup: BenchSetup, connection: Connection) {
        self.connection = connection;
        self.board.enter(Phase::Connecting);
        self.stop = Stop::default();
        let setup = Box::new(setup);
        self.send(Order::Connect(setup, connection, self.stop.clone()));
    }

    /// Makes outputs safe, disarms and lets the unit go.
    pub fn disconnect(&self) {
        self.stop.press();
        self.send(Order::Disconnect);
    }

    /// Does something to the unit by hand.
    ///
    /// # Errors
    /// It is not possible now, or not with this connection; see [`permit`].
    pub fn apply(&self, stimulus: Stimulus) -> Result<(), Refused> {
        self.permits(&stimulus)?;
        let generation = self.board.read().generation;
        self.send(Order::Apply(stimulus, generation));
        Ok(())
    }

    /// Turns the maintenance key on, which is a person's to do on a train, and arms the unit.
    pub fn arm(&self) {
        let generation = self.board.read().generation;
        self.send(Order::Arm(generation));
    }

    /// Whether something can be done to the unit by hand now.
    ///
    /// # Errors
    /// Why not.
    pub fn permits(&self, stimulus: &Stimulus) -> Result<(), Refused> {
        permit(stimulus, self.connection, &self.board.read())
    }

    /// Stops a run and takes every stimulus away; the unit stays connected, disarmed.
    ///
    /// Asked for again it does no more: clean-up is cut short only by [`stop_run`](Self::stop_run).
    pub fn stop_all(&self) {
        self.stop.press_once();
        self.send(Order::MakeSafe);
    }

    /// Runs procedures.
    pub fn run(&mut self, order: RunOrder) {
        self.board.clear_direction();
        self.stop = Stop::default();
        self.send(Order::Run(Box::new(order), self.stop.clone()));
    }

    /// Stops the run: the first press ends the step and goes on to clean-up, the second cuts that short.
    pub fn stop_run(&self) {
        self.stop.press();
    }

    /// How often the present run was told to stop.
    pub fn stop_presses(&self) -> u32 {
        self.stop.presses()
    }

    /// What the run's operator does: pause, single step, answers.
    pub fn board(&self) -> &Arc<Board> {
        &self.board
    }

    /// The latest cycle and the rows before it; held for as short a time as possible.
    pub fn live(&self) -> std::sync::MutexGuard<'_, Live> {
        self.board.read()
    }

    /// As what it is connected.
    pub fn connection(&self) -> Connection {
        self.connection
    }

    /// What happened since the last call.
    pub fn news(&self) -> impl Iterator<Item = News> + '_ {
        self.news.try_iter()
    }

    /// Stops and disconnects; true once the bench's thread has ended.
    pub fn close(&mut self) -> bool {
        if self.orders.take().is_some() {
            self.stop.press();
        }
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// The thread is gone only when the station is, so that nothing is lost.
    fn send(&self, order: Order) {
        if let Some(orders) = &self.orders {
            let _ = orders.send(order);
        }
    }
}

impl Drop for Station {
    fn drop(&mut self) {
        self.close();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
