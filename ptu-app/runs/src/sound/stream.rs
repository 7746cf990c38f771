//! A run's waveforms to a sound card, as they are made.

use std::io::Write;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;

use ato_under_test::serve::{Pair, Steady, TAPS};
use btu_rig::rig::InstrumentFault;

use super::carried::Carried;
use super::{CHANNELS, SAMPLE_HZ, programs};
use crate::pool::held;
use crate::signal::sample_of_16_bits;
use crate::stop::Stop;

/// Samples that are written together, and those that wait besides: 10 and 20 ms.
const TOGETHER: usize = 480;
const WAITING: usize = 960;
/// Samples that must wait beyond those that are taken: the filter between two clocks reaches over so many, and takes
/// one more where this computer's clock is the slower one.
const BESIDES: usize = TAPS + 1;
/// With more samples waiting the device takes none: those of a second [default: a sound server that starts takes less].
const STUCK: usize = SAMPLE_HZ as usize;
/// Time on the way to the card, in its sound server and in the pipe, ms.
pub const ON_THE_WAY_MS: u64 = programs::LATENCY_MS as u64 + 21;
/// Time on the way, and time that samples wait here at most while all is well, ms.
pub const TAKES_MS: u64 = ON_THE_WAY_MS + ((WAITING + TOGETHER) / 48) as u64;

struct State {
    steady: Steady,
    ends: bool,
    /// Samples beyond what the device can make, since this was asked last.
    clipped: u64,
    ended: Option<InstrumentFault>,
}

impl State {
    fn new() -> Self {
        Self {
            steady: Steady::new(WAITING),
            ends: false,
            clipped: 0,
            ended: None,
        }
    }
}

/// Plays the samples that it is fed until it is dropped, and silence where it is fed none.
pub struct Stream {
    shared: Arc<(Mutex<State>, Condvar)>,
    stop: Stop,
    thread: Option<JoinHandle<()>>,
}

impl Stream {
    /// Starts a stream to a device that makes so many mV of the greatest sample of each channel.
    ///
    /// # Errors
    /// Nothing here carries sound.
    pub fn start(device: &str, full_scale_mv: [f64; CHANNELS]) -> Result<Self, InstrumentFault> {
        let stop = Stop::default();
        let mut command =
            programs::player(device).map_err(|(server, alsa)| InstrumentFault::NoPlayer {
                server: server.to_owned(),
                alsa: alsa.to_owned(),
            })?;
        let started = Carried::spawn(&mut command, true, &stop);
        let mut carried = started.map_err(|error| InstrumentFault::NotThere {
            at: device.to_owned(),
            why: error.to_string(),
        })?;
        let shared = Arc::new((Mutex::new(State::new()), Condvar::new()));
        let played = shared.clone();
        let thread = std::thread::spawn(move || {
            while let Some(samples) = next(&played) {
                let mut bytes = Vec::with_capacity(TOGETHER * CHANNELS * 2);
                let mut clipped = 0;
                for pair in samples {
                    for (mv, full) in pair.iter().zip(full_scale_mv) {
                        let (kept, is_clipped) = sample_of_16_bits(f64::from(*mv) / full);
                        clipped += u64::from(is_clipped);
                        bytes.extend(kept.to_le_bytes());
                    }
                }
                held(&played.0).clipped += clipped;
                let written = carried.input.as_mut().map(|input| input.write_all(&bytes));
                if !matches!(written, Some(Ok(()))) {
                    let said = carried.last_words();
                    let why =
                        said.map_or(InstrumentFault::PlayerEnded, InstrumentFault::Disconnected);
                    held(&played.0).ended.get_or_insert(why);
                    return;
                }
            }
        });
        Ok(Self {
            shared,
            stop,
            thread: Some(thread),
        })
    }

    /// Takes the samples of a scan, mV, unless too many wait.
    pub fn feed(&self, samples: &[Pair]) {
        let mut state = held(&self.shared.0);
        if state.steady.waiting() > STUCK {
            state.ended.get_or_insert(InstrumentFault::TakesNoSamples);
        } else {
            state.steady.push(samples.iter().copied());
        }
        drop(state);
        self.shared.1.notify_all();
    }

    /// How long what is fed now takes until it is heard, ms.
    pub fn takes_ms(&self) -> u64 {
        ON_THE_WAY_MS + held(&self.shared.0).steady.waiting() as u64 / 48
    }

    /// Samples that were cut off since this was asked last; else why nothing is played any more.
    pub fn clipped(&self) -> Result<u64, InstrumentFault> {
        let mut state = held(&self.shared.0);
        match &state.ended {
            Some(why) => Err(why.clone()),
            None => Ok(std::mem::take(&mut state.clipped)),
        }
    }

    /// Ends at once: nothing that waits is heard.
    pub fn end(&mut self) {
        held(&self.shared.0).ends = true;
        self.stop.press_once();
        self.shared.1.notify_all();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Drop for Stream {
    fn drop(&mut self) {
        self.end();
    }
}

/// The samples to be played next; `None` at the end.
fn next((shared, changed): &(Mutex<State>, Condvar)) -> Option<[Pair; TOGETHER]> {
    let waits = |state: &mut State| !state.ends && state.steady.waiting() < TOGETHER + BESIDES;
    let waited = changed.wait_while(held(shared), waits);
    let mut state = waited.unwrap_or_else(PoisonError::into_inner);
    let mut samples = [Pair::default(); TOGETHER];
    state.steady.take(&mut samples);
    (!state.ends).then_some(samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_that_takes_nothing_is_told_and_no_more_is_kept_for_it() {
        let stream = Stream {
            shared: Arc::new((Mutex::new(State::new()), Condvar::new())),
            stop: Stop::default(),
            thread: None,
        };
        let half = vec![Pair::default(); STUCK / 2];
        stream.feed(&half);
        stream.feed(&half);
        assert_eq!(stream.clipped(), Ok(0));
        (0..9).for_each(|_| stream.feed(&half));
        assert_eq!(stream.clipped(), Err(InstrumentFault::TakesNoSamples));
        assert!(held(&stream.shared.0).steady.waiting() < 2 * STUCK);
    }
}
