//! The bench's thread: reaches a unit, keeps it alive and live, runs procedures on it, lets it go.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, TryRecvError};

use btu_rig::procedure::plan::Connection;
use btu_rig::procedure::{Procedure, UnitEvent};
use btu_rig::rig::UnitLink;
use btu_rig::stimulus::Stimulus;
use protocol::signal::{Sample, Signal};
use protocol::{Duration, SCAN};

use super::board::{Board, Phase};
use super::news::{News, RunNews};
use super::{Order, RunOrder, permit};
use crate::link::Pace;
use crate::run::{
    Began, BenchSetup, Connected, Listener, READY_WITHIN, Session, SessionEvent, run_on, settled,
};
use crate::stop::Stop;

/// Seed of the embedded unit's live session, as one procedure among others.
const LIVE: &str = "live";

/// Why a run cannot be begun.
const NO_UNIT: &str = "no unit is connected";

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

    /// Serves until the station is gone. Should the program fail, nobody is shown a unit that is not
    /// served any more.
    pub(super) fn serve_whatever_happens(self, orders: &Receiver<Order>) {
        while catch_unwind(AssertUnwindSafe(|| self.serve(orders))).is_err() {
            self.board.enter(Phase::Offline);
            self.tell(News::Broken);
        }
    }

    fn serve(&self, orders: &Receiver<Order>) {
        while let Ok(order) = orders.recv() {
            match order {
                Order::Connect(setup, connection, stop) => {
                    let flow = self.attend(*setup, connection, &stop, orders);
                    self.board.enter(Phase::Offline);
                    if flow.is_break() {
                        return;
                    }
                }
                Order::Run(..) => self.tell(News::RunFailed(NO_UNIT.into())),
                // Nothing to do it with, and nothing on.
                Order::Apply(..) | Order::Arm(_) | Order::MakeSafe | Order::Disconnect => {}
            }
        }
    }

    /// From reaching a unit until it is let go.
    fn attend(
        &self,
        mut setup: BenchSetup,
        connection: Connection,
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
            self.board.begin_anew();
            let (leave, safe) = self.watch(&mut connected, connection, orders);
            match leave {
                Leave::Run(order, stop) => {
                    if !safe {
                        self.tell(News::NotSafe);
                    }
                    self.run(&mut connected, &mut setup, *order, &stop);
                }
                Leave::Disconnect => {
                    self.tell(News::Disconnected { safe });
                    return ControlFlow::Continue(());
                }
                Leave::LinkLost(why) => {
                    self.tell(News::LinkLost(why));
                    return ControlFlow::Continue(());
                }
                Leave::Closed => {
                    self.tell(News::Disconnected { safe });
                    return ControlFlow::Break(());
                }
            }
        }
    }

    /// The unit live, until something else is asked; then outputs are made safe and the unit disarmed,
    /// which may be confirmed or not.
    fn watch(
        &self,
        connected: &mut Connected,
        connection: Connection,
        orders: &Receiver<Order>,
    ) -> (Leave, bool) {
        match connected {
            Connected::Sim(setup) => {
                let mut session = setup.sim_session(LIVE, &Stop::default());
                // Powering up is not worth waiting for.
                session.set_pace(Pace::Virtual);
                let mut logged = |entry: &UnitEvent, _, _: &Sample| self.tell(News::Logged(*entry));
                session.idle(READY_WITHIN + READY_WITHIN, &mut logged, settled());
                session.set_pace(Pace::real());
                let leave = self.watch_session(&mut session, connection, orders);
                session.set_pace(Pace::Virtual);
                (leave, self.let_go(&mut session))
            }
            Connected::Port(session, ..) => {
                session.set_stop(&Stop::default());
                let leave = self.watch_session(session, connection, orders);
                (leave, self.let_go(session))
            }
        }
    }

    fn let_go<L: UnitLink>(&self, session: &mut Session<L>) -> bool {
        self.board.enter(Phase::MakingSafe);
        session.make_safe()
    }

    fn watch_session<L: UnitLink>(
        &self,
        session: &mut Session<L>,
        connection: Connection,
        orders: &Receiver<Order>,
    ) -> Leave {
        self.board
            .enter_idle(session.bench().rig().identity().copied());
        let mut restarts = session.bench().rig().unit_restarts();
        let mut asked = None;
        let mut arm_at = None;
        loop {
            match orders.try_recv() {
                Ok(Order::Apply(stimulus, generation)) => {
                    if self.is_permitted(&stimulus, connection, generation) {
                        asked = self.apply(session, &stimulus);
                    }
                }
                Ok(Order::Arm(generation)) if generation == self.board.read().generation => {
                    let mut wait = Duration::ZERO;
                    let rig = session.bench().rig();
                    if rig.sample().get(Signal::MaintenanceKey) != Some(1.0) {
                        self.apply(session, &Stimulus::MaintenanceKey { on: true });
                        wait = KEY_SEEN;
                    }
                    arm_at = Some(session.now() + wait);
                }
                Ok(Order::Arm(_)) => {}
                Ok(Order::MakeSafe) => {
                    (asked, arm_at) = (None, None);
                    self.board.begin_anew();
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

    /// What was asked of a bench that was made safe since is not done to it any more; nor is what is
    /// no longer possible.
    fn is_permitted(&self, stimulus: &Stimulus, connection: Connection, generation: u64) -> bool {
        let live = self.board.read();
        live.generation == generation && permit(stimulus, connection, &live).is_ok()
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
        let began = Began::now();
        let (plan, store) = (&order.plan, order.store);
        let result = run_on(connected, &began, plan, setup, store, stop, &mut ear);
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

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::{Arc, OnceLock};
    use std::time::{Duration, Instant};

    use btu_rig::procedure::plan::Connection;

    use crate::data::ScriptsDirectory;
    use crate::gui::UnitChoice;
    use crate::station::{Board, Phase, Station};

    /// Goal: whoever sees that a unit can be worked with sees which one it is. Method: looked at each
    /// time the station says that there is something new.
    #[test]
    fn a_unit_that_can_be_worked_with_is_known() {
        let board: Arc<OnceLock<Arc<Board>>> = Arc::default();
        let [known, unknown]: [Arc<AtomicUsize>; 2] = Default::default();
        let wake = {
            let (board, known, unknown) = (board.clone(), known.clone(), unknown.clone());
            move || {
                let Some(live) = board.get().map(|board| board.read()) else {
                    return;
                };
                if live.phase == Phase::Idle {
                    let looked = live.identity.map_or(&unknown, |_| &known);
                    looked.fetch_add(1, Ordering::Relaxed);
                }
            }
        };
        let mut station = Station::new(Arc::new(wake)).expect("a thread");
        assert!(board.set(station.board().clone()).is_ok());
        let scripts = concat!(env!("CARGO_MANIFEST_DIR"), "/../scripts");
        let scripts = ScriptsDirectory::find(Some(scripts.as_ref())).expect("scripts");
        let choice = UnitChoice::default().named().expect("the embedded unit");
        let setup = choice.setup(&scripts).expect("its configuration");
        station.connect(setup, Connection::Btu);
        let began = Instant::now();
        while known.load(Ordering::Relaxed) == 0 {
            assert!(began.elapsed() < Duration::from_secs(60), "no unit");
            std::thread::sleep(Duration::from_millis(5));
        }
        assert_eq!(unknown.load(Ordering::Relaxed), 0);
    }
}
