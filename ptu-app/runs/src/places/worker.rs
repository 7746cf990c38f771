//! A thread for each instrument: it sets what is wanted, reads, watches its time, and switches outputs off on every end.

use std::collections::BTreeMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use btu_rig::rig::InstrumentFault;
use protocol::signal::Signal;

/// Longest time for an answer: less than what all have to become safe in.
pub(super) const ANSWERS_WITHIN: Duration = Duration::from_millis(400);
/// Time without a scan of the bench after which outputs are switched off, and what each further instrument waits longer,
/// so that the order is kept.
const UNFED: Duration = Duration::from_millis(500);
const AFTER_EACH_OTHER: Duration = Duration::from_millis(50);
/// An instrument that is late once may have waited for this computer; one that is so often in a row is slow.
const SLOW_AFTER: u32 = 3;

/// Values of a stimulus by name.
pub(super) type Values = BTreeMap<&'static str, f64>;
/// What is wanted of an instrument, by stimulus.
pub(super) type Wanted = BTreeMap<&'static str, Values>;

/// An instrument that is connected and has passed its self-check.
pub(super) trait Instrument: Send {
    /// Sets what differs from what was set, and reads; whether there was anything to do.
    fn cycle(
        &mut self,
        wanted: &Wanted,
        read: &mut BTreeMap<Signal, f64>,
    ) -> Result<bool, InstrumentFault>;

    /// Every relay that proves itself is where it was ordered.
    fn proved(&self) -> bool {
        true
    }

    /// Switches all outputs off, whatever was set.
    fn off(&mut self) -> Result<(), InstrumentFault>;
}

#[derive(Default)]
struct State {
    wanted: Wanted,
    fed: Option<Instant>,
    read: BTreeMap<Signal, f64>,
    has_read: bool,
    /// Longest cycle beyond what the bench file states.
    late: Duration,
    fault: Option<InstrumentFault>,
    ends: bool,
    ended: bool,
}

/// The thread's other end.
pub(super) struct Worker {
    pub name: String,
    shared: Arc<(Mutex<State>, Condvar)>,
    thread: Option<JoinHandle<()>>,
}

/// How an instrument is worked.
#[derive(Clone, Copy)]
pub(super) struct Timing {
    pub poll: Duration,
    /// What the bench file states.
    pub uncertainty: Duration,
    /// Place in the order in which outputs are switched off.
    pub place: u32,
}

impl Worker {
    pub fn start(name: String, timing: Timing, instrument: Box<dyn Instrument>) -> Self {
        let shared = Arc::new((Mutex::new(State::default()), Condvar::new()));
        let worked = shared.clone();
        let thread = std::thread::spawn(move || {
            work(&worked, timing, instrument);
            let mut state = lock(&worked.0);
            state.ended = true;
            worked.1.notify_all();
        });
        Self {
            name,
            shared,
            thread: Some(thread),
        }
    }

    /// Wants this from now on.
    pub fn feed(&self, wanted: &Wanted) {
        let mut state = lock(&self.shared.0);
        state.fed = Some(Instant::now());
        if state.wanted != *wanted {
            state.wanted.clone_from(wanted);
            self.shared.1.notify_all();
        }
    }

    /// What it read last.
    pub fn readings(&self, mut each: impl FnMut(Signal, f64)) -> Result<(), InstrumentFault> {
        let state = lock(&self.shared.0);
        state
            .read
            .iter()
            .for_each(|(signal, value)| each(*signal, *value));
        state.fault.clone().map_or(Ok(()), Err)
    }

    /// How long the longest cycle was beyond what is stated, since this was last asked.
    pub fn take_late(&self) -> protocol::Duration {
        span(std::mem::take(&mut lock(&self.shared.0).late))
    }

    /// Waits until it has read for the first time.
    pub fn has_read(&self, within: Duration) -> Result<(), InstrumentFault> {
        let state = lock(&self.shared.0);
        let waits = |state: &mut State| !state.has_read && state.fault.is_none();
        let waited = self.shared.1.wait_timeout_while(state, within, waits);
        let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        state.fault.clone().map_or(Ok(()), Err)
    }

    /// Switches its outputs off and waits for that, no longer than this.
    pub fn end(&mut self, within: Duration) {
        let mut state = lock(&self.shared.0);
        state.ends = true;
        self.shared.1.notify_all();
        let waits = |state: &mut State| !state.ended;
        let waited = self.shared.1.wait_timeout_while(state, within, waits);
        let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        if state.ended
            && let Some(thread) = self.thread.take()
        {
            drop(state);
            let _ = thread.join();
        }
    }
}

fn lock(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

fn work(
    (shared, changed): &(Mutex<State>, Condvar),
    timing: Timing,
    mut instrument: Box<dyn Instrument>,
) {
    let patience = UNFED + AFTER_EACH_OTHER * timing.place;
    let mut read = BTreeMap::new();
    let (mut is_off, mut late) = (true, 0);
    loop {
        let began = Instant::now();
        let (wanted, fed) = {
            let state = lock(shared);
            let fed = state.fed.is_some_and(|at| at.elapsed() < patience);
            if state.ends || state.fault.is_some() {
                break;
            }
            (state.wanted.clone(), fed)
        };
        let nothing = Wanted::new();
        if !fed && !is_off {
            let _ = instrument.off();
        }
        is_off = !fed;
        let wanted = if fed { &wanted } else { &nothing };
        let cycled = instrument.cycle(wanted, &mut read);
        let took = began.elapsed();
        late = match took > timing.uncertainty {
            true => late + 1,
            false if cycled == Ok(true) => 0,
            false => late,
        };
        let cycled = cycled.and_then(|_| match late {
            SLOW_AFTER.. => Err(InstrumentFault::Slow {
                took: span(took),
                stated: span(timing.uncertainty),
            }),
            _ => Ok(()),
        });
        let mut state = lock(shared);
        state.read.clone_from(&read);
        if took > timing.uncertainty {
            state.late = state.late.max(took);
        }
        state.fault = cycled.err();
        state.has_read = true;
        changed.notify_all();
        let rest = timing.poll.saturating_sub(began.elapsed());
        let waits = |state: &mut State| !state.ends && (!fed || state.wanted == *wanted);
        drop(changed.wait_timeout_while(state, rest, waits));
    }
    let _ = instrument.off();
}

pub(super) fn span(time: Duration) -> protocol::Duration {
    protocol::Duration::from_us(u64::try_from(time.as_micros()).unwrap_or(u64::MAX))
}
