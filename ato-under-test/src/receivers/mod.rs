//! What the unit makes of the waveforms in its coils: speed codes and TWC bytes, from samples in mV.
//!
//! No allocation, no clock: the caller passes one sample after the other at a known rate.

mod code;
mod downmix;
mod fsk;

pub use code::{CodeReceiver, HEARD_WITHIN_S, Heard};
pub use fsk::{BitHeard, Demodulator, FskReceiver, Received, Tones};
