//! Waveforms in the coils, as samples in mV: speed codes, TWC, markers, pulses of speed sensors, and disturbances.
//!
//! Each source gives one sample after the other, without end or for its length, at a rate of its own. A phase is counted
//! in cycles and kept below one, so that it stays exact over hours.

mod channel;
mod code;
mod fsk;
mod marker;
mod noise;
mod sensor;
mod toothed_wheel;

pub use channel::{Channel, ChannelConfig};
pub use code::CodeWave;
pub use fsk::FskWave;
pub use marker::MarkerWave;
pub use noise::Noise;
pub use sensor::SensorWave;
pub use toothed_wheel::{Teeth, ToothedWheel};

/// A phase in cycles, 0 to 1.
#[derive(Clone, Copy, Debug, Default)]
struct Phase(f64);

impl Phase {
    /// Moves the phase on by a part of a cycle; returns the phase before.
    fn step(&mut self, cycles: f64) -> f64 {
        let before = self.0;
        self.0 = (before + cycles).fract();
        before
    }
}

/// The cosine of a phase.
fn cosine(cycles: f64) -> f64 {
    (std::f64::consts::TAU * cycles).cos()
}
