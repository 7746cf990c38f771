//! The bench thread: connects to a unit, scans the bench while nothing runs, runs procedures, and releases the
//! unit with its outputs safe.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, TryRecvError};

use btu_rig::procedure::plan::Connection;
use btu_rig::procedure::runner::SAFE_WITHIN;
use btu_rig::procedure::{Procedure, UnitEvent};
use btu_rig::rig::{LinkTrouble, UnitLink};
use btu_rig::stimulus::Stimulus;
use protocol::signal::{Sample, Signal};
use protocol::{Duration, Instant, SCAN};

use super::event::BenchEvent;
use super::live_state::{LiveState, Phase};
use super::order::{Order, RunOrder};
use super::permit::permit;
use crate::failure::RunTrouble;
use crate::link::{Pace, keep_time};
use crate::run::{
    BenchSetup, Connected, Listener, Outcome, READY_WITHIN, RunStart, Session, SessionEvent,
    run_on, settled, trace_repaired,
};
use crate::stop::Stop;

/// Name from which the seed of the embedded unit's live session is made, as from a procedure's.
const LIVE: &str = "live";

/// The thread's side of a [`BenchWorker`](super::BenchWorker).
pub(super) struct BenchThread {
    live_state: Arc<LiveState>,
    events: Sender<BenchEvent>,
}

/// From turning the maintenance key until the unit has seen it.
const KEY_SEEN: Duration = Duration::from_ms(300);

/// Why live monitoring of the unit ended.
enum WatchEnd {
    Run(Box<RunOrder>, Stop),
    Disconnect,
    LinkLost(LinkTrouble),
    Closed,
}

impl BenchThread {
    pub(super) fn new(live_state: Arc<LiveState>, events: Sender<BenchEvent>) -> Self {
        Self { live_state, events }
    }

    /// Executes orders until the worker is dropped. After a panic the unit is shown as disconnected, because
    /// nothing scans it any more.
    pub(super) fn run_until_closed(self, orders: &Receiver<Order>) {
        while catch_unwind(AssertUnwindSafe(|| self.execute_orders(orders))).is_err() {
            self.live_state.enter(Phase::Offline);
            self.tell(BenchEvent::Broken);
        }
    }

    fn execute_orders(&self, orders: &Receiver<Order>) {
        while let Ok(order) = orders.recv() {
            match order {
                Order::Connect(setup, stop) => {
                    let flow = self.hold_unit(*setup, &stop, orders);
                    self.live_state.enter(Phase::Offline);
                    if flow.is_break() {
                        return;
                    }
                }
                Order::Run(..) => self.tell(BenchEvent::RunFailed(RunTrouble::NoUnit.into())),
                // No unit is connected, so nothing is to be done or undone.
                Order::Apply(..) | Order::Arm(_) | Order::MakeSafe | Order::Disconnect => {}
            }
        }
    }

    /// From connecting to a unit until it is released.
    fn hold_unit(
        &self,
        mut setup: BenchSetup,
        stop: &Stop,
        orders: &Receiver<Order>,
    ) -> ControlFlow<()> {
        setup.run_control = Some(self.live_state.clone());
        let mut connected = match setup.connect(stop) {
            Ok(connected) => connected,
            Err(failure) => {
                self.tell(BenchEvent::NotConnected(failure.message));
                return ControlFlow::Continue(());
            }
        };
        self.tell(BenchEvent::Connected {
            serial: connected.serial(),
        });
        loop {
            self.live_state.invalidate_orders();
            let (end, safe) = self.watch(&mut connected, orders);
            match end {
                WatchEnd::Run(order, stop) => {
                    if !safe {
                        self.tell(BenchEvent::NotSafe);
                    }
                    self.run(&mut connected, &mut setup, *order, &stop);
                }
                WatchEnd::Disconnect => {
                    self.tell(BenchEvent::Disconnected { safe });
                    return ControlFlow::Continue(());
                }
                WatchEnd::LinkLost(why) => {
                    self.tell(BenchEvent::LinkLost(why));
                    return ControlFlow::Continue(());
                }
                WatchEnd::Closed => {
                    self.tell(BenchEvent::Disconnected { safe });
                    return ControlFlow::Break(());
                }
            }
        }
    }

    /// Monitors the unit until an order ends the monitoring; then makes outputs safe and disarms. The flag says whether
    /// safe outputs were confirmed.
    fn watch(&self, connected: &mut Connected, orders: &Receiver<Order>) -> (WatchEnd, bool) {
        match connected {
            Connected::Sim(setup) => {
                let mut session = setup.sim_session(LIVE, &Stop::default());
                // Powering up is not worth waiting for.
                session.set_pace(Pace::Virtual);
                let mut logged =
                    |entry: &UnitEvent, _, _: &Sample| self.tell(BenchEvent::Logged(*entry));
                session.idle(READY_WITHIN + READY_WITHIN, &mut logged, settled());
                session.set_pace(Pace::real());
                let end = self.watch_session(&mut session, orders);
                session.set_pace(Pace::Virtual);
                (end, self.release(&mut session))
            }
            Connected::Port(session, ..) => {
                session.set_stop(&Stop::default());
                let end = self.watch_session(session, orders);
                (end, self.release(session))
            }
        }
    }

    fn release<L: UnitLink>(&self, session: &mut Session<L>) -> bool {
        self.live_state.enter(Phase::MakingSafe);
        session.make_safe()
    }

    fn watch_session<L: UnitLink>(
        &self,
        session: &mut Session<L>,
        orders: &Receiver<Order>,
    ) -> WatchEnd {
        keep_time();
        self.live_state.enter_idle(&session.bench.rig);
        let mut restarts = session.bench.rig.unit_restarts();
        let mut asked = None;
        let mut arm_at = None;
        let mut safe_until = None;
        loop {
            match orders.try_recv() {
                Ok(Order::Apply(stimulus, bench_epoch)) => {
                    if self.is_permitted(&stimulus, bench_epoch) {
                        self.end_stop(&mut safe_until);
                        asked = self.apply(session, &stimulus);
                    }
                }
                Ok(Order::Arm(bench_epoch))
                    if bench_epoch == self.live_state.read().bench_epoch =>
                {
                    self.end_stop(&mut safe_until);
                    let mut wait = Duration::ZERO;
                    let rig = &session.bench.rig;
                    let bench = rig.connection() == Some(Connection::Btu);
                    if bench && rig.sample().get(Signal::MaintenanceKey) != Some(1.0) {
                        self.apply(session, &Stimulus::MaintenanceKey { on: true });
                        wait = KEY_SEEN;
                    }
                    arm_at = Some(session.now() + wait);
                }
                Ok(Order::Arm(_)) => {}
                Ok(Order::MakeSafe) => {
                    (asked, arm_at) = (None, None);
                    safe_until = Some(session.now() + SAFE_WITHIN);
                    self.live_state.invalidate_orders();
                    let now = session.now();
                    session.bench.rig.make_safe(now);
                }
                Ok(Order::Run(order, stop)) => return WatchEnd::Run(order, stop),
                Ok(Order::Disconnect) => return WatchEnd::Disconnect,
                Ok(Order::Connect(..)) => {}
                Err(TryRecvError::Empty) => {}
                Err(TryRecvError::Disconnected) => return WatchEnd::Closed,
            }
            session.idle(
                SCAN,
                |entry, _, _| self.tell(BenchEvent::Logged(*entry)),
                |_| false,
            );
            if session.bench.rig.safe() {
                self.end_stop(&mut safe_until);
            } else if safe_until.is_some_and(|until| session.now() >= until) {
                safe_until = None;
                self.tell(BenchEvent::NotSafe);
            }
            if arm_at.is_some_and(|at| session.now() >= at) {
                arm_at = None;
                asked = self.apply(session, &Stimulus::PtuArm);
            }
            // The rig reports a refusal until the next stimulus; tell it once.
            if let Err(why) = session.bench.rig.settled()
                && let Some(asked) = asked.take()
            {
                self.tell(BenchEvent::NotDone { asked, why: why.0 });
            }
            if let Some(why) = session.link_error() {
                return WatchEnd::LinkLost(why);
            }
            let now_restarts = session.bench.rig.unit_restarts();
            if now_restarts != restarts {
                restarts = now_restarts;
                self.tell(BenchEvent::UnitRestarted);
            }
        }
    }

    /// Tells the end of a stop that was under way.
    fn end_stop(&self, safe_until: &mut Option<Instant>) {
        if safe_until.take().is_some() {
            self.tell(BenchEvent::StopEnded);
        }
    }

    /// Whether a stimulus is executed: not if it was ordered before the bench was last made safe, or is no longer permitted.
    fn is_permitted(&self, stimulus: &Stimulus, bench_epoch: u64) -> bool {
        let live = self.live_state.read();
        live.bench_epoch == bench_epoch && permit(stimulus, &live).is_ok()
    }

    /// Applies a stimulus; returns the text of the stimulus if the bench accepted it.
    fn apply<L: UnitLink>(&self, session: &mut Session<L>, stimulus: &Stimulus) -> Option<String> {
        let now = session.now();
        let asked = stimulus.to_string();
        match session.bench.rig.apply(now, stimulus) {
            Ok(()) => Some(asked),
            Err(why) => {
                self.tell(BenchEvent::NotDone { asked, why: why.0 });
                None
            }
        }
    }

    fn run(&self, connected: &mut Connected, setup: &mut BenchSetup, order: RunOrder, stop: &Stop) {
        self.live_state.enter(Phase::Running);
        setup.realtime = order.realtime;
        if let Connected::Sim(made) = connected {
            made.realtime = order.realtime;
        }
        let mut forwarder = EventForwarder(self);
        let began = RunStart::now();
        let RunOrder {
            mut plan, store, ..
        } = order;
        let serial = connected.serial();
        let traced = trace_repaired(&mut plan.tasks, &store, &serial);
        let result = traced
            .and_then(|()| run_on(connected, &began, &plan, setup, store, stop, &mut forwarder));
        let closed = result.and_then(|(store, outcome)| {
            store.close()?;
            Ok(outcome)
        });
        self.tell(match closed {
            Ok(Outcome {
                lost: Some(lost), ..
            }) => BenchEvent::RunFailed(lost),
            Ok(outcome) => BenchEvent::RunEnded(outcome),
            Err(failure) => BenchEvent::RunFailed(failure.message),
        });
    }

    /// Sends an event to the window; it is lost once the worker has been dropped.
    fn tell(&self, event: BenchEvent) {
        let _ = self.events.send(event);
        self.live_state.wake();
    }
}

/// Forwards the events of a run to the window.
struct EventForwarder<'a>(&'a BenchThread);

impl Listener for EventForwarder<'_> {
    fn on_event(&mut self, procedure: &Procedure, event: &SessionEvent) {
        // Traces and recorded stimuli are large, and the window reads them from the database.
        if !matches!(
            event,
            SessionEvent::Trace(_) | SessionEvent::Rows(_) | SessionEvent::Recording(_)
        ) {
            self.0.tell(BenchEvent::Run {
                procedure: procedure.id.clone(),
                event: event.clone(),
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::{Arc, OnceLock};
    use std::time::{Duration, Instant};

    use crate::bench_worker::{BenchWorker, LiveState, Phase};
    use crate::test_support;

    /// Goal: an idle unit is never shown without its identity. Method: the state is read at each wake-up.
    #[test]
    fn an_idle_unit_is_never_shown_without_its_identity() {
        let live_state: Arc<OnceLock<Arc<LiveState>>> = Arc::default();
        let [known, unknown]: [Arc<AtomicUsize>; 2] = Default::default();
        let wake = {
            let (live_state, known, unknown) = (live_state.clone(), known.clone(), unknown.clone());
            move || {
                let Some(live) = live_state.get().map(|live_state| live_state.read()) else {
                    return;
                };
                if live.phase == Phase::Idle {
                    let looked = live.identity.map_or(&unknown, |_| &known);
                    looked.fetch_add(1, Ordering::Relaxed);
                }
            }
        };
        let mut worker = BenchWorker::new(Arc::new(wake)).expect("a thread");
        assert!(live_state.set(worker.live_state.clone()).is_ok());
        worker.connect(test_support::setup(&[]));
        let began = Instant::now();
        while known.load(Ordering::Relaxed) == 0 {
            assert!(began.elapsed() < Duration::from_secs(60), "no unit");
            std::thread::sleep(Duration::from_millis(5));
        }
        assert_eq!(unknown.load(Ordering::Relaxed), 0);
    }
}
