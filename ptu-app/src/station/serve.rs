//! The bench's thread: reaches a unit, keeps it alive and live, runs procedures on it, lets it go.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, TryRecvError};

use btu_rig::procedure::Procedure;
use btu_rig::rig::UnitLink;
use btu_rig::stimulus::Stimulus;
use protocol::signal::Signal;
use protocol::{Duration, SCAN};

use super::board::{Board, Phase};
use super::news::{News, RunNews};
use super::{Order, RunOrder};
use crate::link::Pace;
use crate::run::{
    Began, BenchSetup, Connected, Listener, READY_WITHIN, Session, SessionEvent, run_on, settled,
};
use crate::stop::Stop;

/// Seed of the embedded unit's live session, as one procedure among others.
const LIVE: &str = "live";

/// The thread's side of a station.
pub(super) struct Server {
    board: Arc<Board>,
    news: Sender<News>,
}

/// From turning the maintenance key until the unit has seen it.
const KEY_SEEN: Duration = Duration::from_ms(300);

/// Why the unit is no longer just watched.
enum Leave {
    Run(Box<RunOrder>, Stop),
    Disconnect,
    LinkLost(String),
    /// The station is gone.
    Closed,
}

impl Server {
    pub(super) fn new(board: Arc<Board>, news: Sender<News>) -> Self {
        Self { board, news }
    }

    /// Serves until the station is gone.
    pub(super) fn serve(self, orders: &Receiver<Order>) {
        while let Ok(order) = orders.recv() {
            // Nothing else can be done without a unit.
            if let Order::Connect(setup, stop) = order {
                let flow = self.attend(*setup, &stop, orders);
                self.board.enter(Phase::Offline);
                if flow.is_break() {
                    return;
                }
            }
        }
    }

    /// From reaching a unit until it is let go.
    fn attend(
        &self,
        mut setup: BenchSetup,
        stop: &Stop,
        orders: &Receiver<Order>,
    ) -> ControlFlow<()> {
        setup.attendant = Some(self.board.clone());
        let mut connected = match setup.connect(stop) {
            Ok(connected) => connected,
            Err(failure) => {
                self.tell(News::NotConnected(failure.message));
                return ControlFlow::Continue(());
            }
        };
        self.tell(News::Connected {
            serial: connected.serial(),
        });
        loop {
            self.board.enter(Phase::Idle);
            match self.watch(&mut connected, orders) {
                Leave::Run(order, stop) => self.run(&mut connected, &mut setup, *order, &stop),
                Leave::Disconnect => {
                    self.tell(News::Disconnected);
                    return ControlFlow::Continue(());
                }
                Leave::LinkLost(why) => {
                    self.tell(News::LinkLost(why));
                    return ControlFlow::Continue(());
                }
                Leave::Closed => return ControlFlow::Break(()),
            }
        }
    }

    /// The unit live, until something else is asked; then outputs are safe and the unit disarmed.
    fn watch(&self, connected: &mut Connected, orders: &Receiver<Order>) -> Leave {
        match connected {
            Connected::Sim(setup) => {
                let mut session = setup.sim_session(LIVE, &Stop::default());
                // Powering up is not worth waiting for.
                session.set_pace(Pace::Virtual);
                session.idle(READY_WITHIN + READY_WITHIN, |_, _, _| {}, settled());
                session.set_pace(Pace::real());
                let leave = self.watch_session(&mut session, orders);
                session.set_pace(Pace::Virtual);
                self.let_go(&mut session);
                leave
            }
            Connected::Port(session, ..) => {
                session.heed(&Stop::default());
                let leave = self.watch_session(session, orders);
                self.let_go(session);
                leave
            }
        }
    }

    fn let_go<L: UnitLink>(&self, session: &mut Session<L>) {
        self.board.enter(Phase::MakingSafe);
        if !session.make_safe() && session.link_error().is_none() {
            self.tell(News::NotSafe);
        }
    }

    fn watch_session<L: UnitLink>(
        &self,
        session: &mut Session<L>,
        orders: &Receiver<Order>,
    ) -> Leave {
        let mut restarts = session.bench().rig().unit_restarts();
        let mut asked = None;
        let mut arm_at = None;
        loop {
            match orders.try_recv() {
                Ok(Order::Apply(stimulus)) => asked = self.apply(session, &stimulus),
                Ok(Order::Arm) => {
                    let mut wait = Duration::ZERO;
                    let rig = session.bench().rig();
                    if rig.sample().get(Signal::MaintenanceKey) != Some(1.0) {
                        self.apply(session, &Stimulus::MaintenanceKey { on: true });
                        wait = KEY_SEEN;
                    }
                    arm_at = Some(session.now() + wait);
                }
                Ok(Order::MakeSafe) => {
                    let now = session.now();
                    session.bench().rig_mut().make_safe(now);
                }
                Ok(Order::Run(order, stop)) => return Leave::Run(order, stop),
                Ok(Order::Disconnect) => return Leave::Disconnect,
                Ok(Order::Connect(..)) => {}
                Err(TryRecvError::Empty) => {}
                Err(TryRecvError::Disconnected) => return Leave::Closed,
            }
            session.idle(
                SCAN,
                |entry, _, _| self.tell(News::Logged(*entry)),
                |_| false,
            );
            if arm_at.is_some_and(|at| session.now() >= at) {
                arm_at = None;
                asked = self.apply(session, &Stimulus::PtuArm);
            }
            // What the unit refuses stays refused until the next stimulus, and is told once.
            if let Err(why) = session.bench().rig().settled()
                && let Some(asked) = asked.take()
            {
                self.tell(News::NotDone { asked, why: why.0 });
            }
            if let Some(why) = session.link_error() {
                return Leave::LinkLost(why);
            }
            let now_restarts = session.bench().rig().unit_restarts();
            if now_restarts != restarts {
                restarts = now_restarts;
                self.tell(News::UnitRestarted);
            }
        }
    }

    /// What was asked, if the bench began it.
    fn apply<L: UnitLink>(&self, session: &mut Session<L>, stimulus: &Stimulus) -> Option<String> {
        let now = session.now();
        let asked = stimulus.to_string();
        match session.bench().rig_mut().apply(now, stimulus) {
            Ok(()) => Some(asked),
            Err(why) => {
                self.tell(News::NotDone { asked, why: why.0 });
                None
            }
        }
    }

    fn run(&self, connected: &mut Connected, setup: &mut BenchSetup, order: RunOrder, stop: &Stop) {
        self.board.enter(Phase::Running);
        setup.realtime = order.realtime;
        if let Connected::Sim(made) = connected {
            made.realtime = order.realtime;
        }
        let mut ear = Ear(self);
        let result = (order.open_store)().and_then(|store| {
            run_on(
                connected,
                &Began::now(),
                &order.plan,
                setup,
                store,
                stop,
                &mut ear,
            )
        });
        let closed = result.and_then(|(store, outcome)| {
            store.close()?;
            Ok(outcome)
        });
        self.tell(match closed {
            Ok(outcome) => News::RunEnded(outcome),
            Err(failure) => News::RunFailed(failure.message),
        });
    }

    /// Nobody hears it once the station is gone.
    fn tell(&self, news: News) {
        let _ = self.news.send(news);
        self.board.wake();
    }
}

/// Passes on what a run says.
struct Ear<'a>(&'a Server);

impl Listener for Ear<'_> {
    fn hear(&mut self, procedure: &Procedure, event: &SessionEvent) {
        let what = match event {
            SessionEvent::Run(event) => RunNews::Event(event.clone()),
            SessionEvent::Fault(fault) => RunNews::Fault(fault.clone()),
            SessionEvent::LinkLost(why) => RunNews::LinkLost(why.clone()),
            SessionEvent::Ended { .. } => RunNews::Ended,
            SessionEvent::Trace(_) | SessionEvent::Recording(_) => return,
        };
        self.0.tell(News::Run {
            procedure: procedure.id.clone(),
            what,
        });
    }
}
