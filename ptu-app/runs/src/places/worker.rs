//! A thread for each instrument: it sets what is wanted, reads, watches its time, and switches outputs off on every end.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use btu_rig::rig::{InstrumentFault, LinkTrouble};
use protocol::signal::Signal;

use super::model::Values;
use super::points::UnitInput;
use crate::pool::held;

/// Longest time for an answer: less than all instruments together have to become safe.
pub(super) const ANSWERS_WITHIN: Duration = Duration::from_millis(400);
/// Time without a scan of the bench after which outputs are switched off, and what each further instrument waits longer,
/// so that the order is kept.
const UNFED: Duration = Duration::from_millis(500);
const AFTER_EACH_OTHER: Duration = Duration::from_millis(50);
/// An instrument that is late once may have waited for this computer; one that is late so often in a row is slow.
const SLOW_AFTER: u32 = 3;

/// What is wanted of an instrument, by stimulus.
pub(super) type Wanted = BTreeMap<UnitInput, Values>;

/// An instrument that is connected and has passed its self-check.
pub(super) trait Instrument: Send {
    /// Sets what has changed, and reads; true if there was anything to do.
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
    /// Greatest time by which a cycle was longer than the bench file states.
    late: Duration,
    fault: Option<InstrumentFault>,
    ends: bool,
    ended: bool,
}

/// An instrument's thread, seen from outside.
pub(super) struct Worker {
    pub name: String,
    shared: Arc<(Mutex<State>, Condvar)>,
    thread: Option<JoinHandle<()>>,
}

/// How an instrument is worked.
#[derive(Clone, Copy)]
pub(super) struct Timing {
    pub poll: Duration,
    /// `uncertainty_ms` of the bench file.
    pub uncertainty: Duration,
    /// Place in the order in which outputs are switched off.
    pub place: u32,
}

impl Worker {
    pub fn start(name: String, timing: Timing, mut instrument: Box<dyn Instrument>) -> Self {
        let shared = Arc::new((Mutex::new(State::default()), Condvar::new()));
        let worked = shared.clone();
        let thread = std::thread::spawn(move || {
            let ended = kept(|| work(&worked, timing, &mut *instrument));
            // Whatever happened before: outputs are not left on.
            let off = kept(|| instrument.off());
            let mut state = held(&worked.0);
            if let Some(why) = ended.err().or(off.err()) {
                state
                    .fault
                    .get_or_insert(InstrumentFault::Disconnected(why));
            }
            state.ended = true;
            worked.1.notify_all();
        });
        Self {
            name,
            shared,
            thread: Some(thread),
        }
    }

    /// Tells the thread what is wanted from now on.
    pub fn feed(&self, wanted: &Wanted) {
        let mut state = held(&self.shared.0);
        state.fed = Some(Instant::now());
        if state.wanted != *wanted {
            state.wanted.clone_from(wanted);
            self.shared.1.notify_all();
        }
    }

    /// Hands each signal that the instrument read last to `each`; its fault, if it has one.
    pub fn readings(&self, mut each: impl FnMut(Signal, f64)) -> Result<(), InstrumentFault> {
        let state = held(&self.shared.0);
        state
            .read
            .iter()
            .for_each(|(signal, value)| each(*signal, *value));
        state.fault.clone().map_or(Ok(()), Err)
    }

    /// How long the longest cycle was beyond what is stated, since this was last asked.
    pub fn take_late(&self) -> protocol::Duration {
        span(std::mem::take(&mut held(&self.shared.0).late))
    }

    /// Waits until the instrument has read for the first time.
    pub fn has_read(&self, within: Duration) -> Result<(), InstrumentFault> {
        let state = held(&self.shared.0);
        let waits = |state: &mut State| !state.has_read && state.fault.is_none();
        let waited = self.shared.1.wait_timeout_while(state, within, waits);
        let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        match (&state.fault, state.has_read) {
            (Some(fault), _) => Err(fault.clone()),
            (None, true) => Ok(()),
            (None, false) => Err(InstrumentFault::Silent(span(within))),
        }
    }

    /// Switches the instrument's outputs off and waits for that, no longer than `within`.
    pub fn end(&mut self, within: Duration) {
        let mut state = held(&self.shared.0);
        // The end of the thread was waited for once.
        if std::mem::replace(&mut state.ends, true) {
            return;
        }
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

fn work(
    (shared, changed): &(Mutex<State>, Condvar),
    timing: Timing,
    instrument: &mut dyn Instrument,
) {
    let patience = UNFED + AFTER_EACH_OTHER * timing.place;
    let mut read = BTreeMap::new();
    let (mut is_off, mut late) = (true, 0);
    loop {
        let began = Instant::now();
        let (wanted, fed) = {
            let state = held(shared);
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
        // A change just after a reading is seen by the next reading.
        let took = began.elapsed() + timing.poll;
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
        let mut state = held(shared);
        state.read.clone_from(&read);
        if took > timing.uncertainty {
            state.late = state.late.max(took - timing.uncertainty);
        }
        state.fault = cycled.err();
        state.has_read = true;
        changed.notify_all();
        let rest = timing.poll.saturating_sub(began.elapsed());
        let age = state.fed.filter(|_| fed).map(|at| at.elapsed());
        let rest = age.map_or(rest, |age| rest.min(patience.saturating_sub(age)));
        let waits = |state: &mut State| !state.ends && (!fed || state.wanted == *wanted);
        drop(changed.wait_timeout_while(state, rest, waits));
    }
}

/// Does the work; a panic becomes an error with the panic's text.
fn kept<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
        text.unwrap_or("panic").to_owned()
    })
}

/// The fault of an instrument, as the trouble of the bench's link.
pub(super) fn trouble(instrument: &str, fault: InstrumentFault) -> LinkTrouble {
    LinkTrouble::Instrument {
        instrument: instrument.to_owned(),
        fault: Box::new(fault),
    }
}

pub(super) fn span(time: Duration) -> protocol::Duration {
    protocol::Duration::from_us(u64::try_from(time.as_micros()).unwrap_or(u64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An instrument that takes so long, panics in the cycle of this number, and counts how often it was switched off.
    struct Odd(Duration, u32, Arc<Mutex<u32>>);

    impl Instrument for Odd {
        fn cycle(
            &mut self,
            _: &Wanted,
            _: &mut BTreeMap<Signal, f64>,
        ) -> Result<bool, InstrumentFault> {
            std::thread::sleep(self.0);
            self.1 = self.1.wrapping_sub(1);
            assert_ne!(self.1, 0, "a defect");
            Ok(true)
        }

        fn off(&mut self) -> Result<(), InstrumentFault> {
            *self.2.lock().expect("a count") += 1;
            Ok(())
        }
    }

    fn started(takes_ms: u64, panics: u32, poll_ms: u64) -> (Worker, Arc<Mutex<u32>>) {
        let offs = Arc::new(Mutex::new(0));
        let odd = Odd(Duration::from_millis(takes_ms), panics, offs.clone());
        let timing = Timing {
            poll: Duration::from_millis(poll_ms),
            uncertainty: Duration::from_secs(10),
            place: 0,
        };
        (Worker::start("odd".into(), timing, Box::new(odd)), offs)
    }

    #[test]
    fn a_panic_is_a_fault_and_switches_off() {
        let (mut worker, offs) = started(0, 2, 10);
        worker.has_read(Duration::from_secs(1)).expect("one cycle");
        let began = Instant::now();
        while worker.readings(|_, _| {}).is_ok() && began.elapsed() < Duration::from_secs(10) {
            std::thread::sleep(Duration::from_millis(10));
        }
        let fault = worker.readings(|_, _| {}).expect_err("a panic");
        assert!(fault.to_string().contains("a defect"), "{fault}");
        assert_eq!(*offs.lock().expect("a count"), 1);
        let began = Instant::now();
        worker.end(Duration::from_secs(1));
        assert!(began.elapsed() < Duration::from_millis(500));
    }

    #[test]
    fn a_long_poll_delays_no_switching_off() {
        let (mut worker, offs) = started(0, 0, 5_000);
        worker.feed(&Wanted::from([(UnitInput::Hcr, Values::new())]));
        std::thread::sleep(UNFED + Duration::from_millis(300));
        assert_eq!(*offs.lock().expect("a count"), 1);
        worker.end(Duration::from_secs(1));
    }

    #[test]
    fn the_time_until_the_next_reading_counts_as_late() {
        let offs = Arc::new(Mutex::new(0));
        let timing = Timing {
            poll: Duration::from_millis(100),
            uncertainty: Duration::from_millis(140),
            place: 0,
        };
        let odd = Box::new(Odd(Duration::from_millis(60), 0, offs));
        let mut worker = Worker::start("odd".into(), timing, odd);
        std::thread::sleep(Duration::from_millis(600));
        let late_ms = worker.take_late().as_secs() * 1000.0;
        let fault = worker.readings(|_, _| {});
        assert!(
            matches!(fault, Err(InstrumentFault::Slow { .. })),
            "{fault:?}"
        );
        assert!((20.0..100.0).contains(&late_ms), "{late_ms}");
        worker.end(Duration::from_secs(1));
    }

    #[test]
    fn what_was_not_read_in_time_is_silent() {
        let (mut worker, _) = started(300, 0, 10);
        let read = worker.has_read(Duration::from_millis(50));
        assert!(matches!(read, Err(InstrumentFault::Silent(_))), "{read:?}");
        worker.end(Duration::from_secs(1));
    }
}
