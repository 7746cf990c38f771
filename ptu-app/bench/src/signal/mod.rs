//! Signals as waveforms in files: made by the bench's generators, read by the unit's receivers.

#[cfg(test)]
mod coil_tests;
mod make;
mod read;
#[cfg(test)]
mod tests;
mod wav;

pub use make::{Made, Wave, make};
pub use read::{NotUnderstood, Reading, Source, read};

/// Sample rate of files that are made, Hz.
const SAMPLE_HZ: u32 = 48_000;
/// What full scale of a file stands for, mV, unless something else is said: above the strongest level a receiver decodes.
pub const FULL_SCALE_MV: f64 = 4_000.0;
