//! What the unit makes of the waveforms in its coils: speed codes, TWC bytes, markers and pulses, from samples in mV.
//!
//! Once made they need no clock and no allocation: the caller passes one sample after the other at a known rate.

mod code;
mod coils;
mod downmix;
mod fsk;
mod marker;
mod rate;
mod second_code;
mod sensor;
mod shifted;
mod spell;
mod window;

pub use code::{CodeReceiver, Heard, Reception};
pub use coils::{Coils, Sampled};
pub use downmix::{Downmix, Phasor};
pub use fsk::{BitHeard, Demodulator, FskReceiver, Received, Tones};
pub use marker::{MarkerReceiver, Passed};
pub use sensor::SensorInput;
