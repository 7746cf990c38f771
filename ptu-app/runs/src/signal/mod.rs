//! Signals as waveforms in files: made by the bench's generators, read by the unit's receivers.

mod audible;
mod codes;
#[cfg(test)]
mod coil_tests;
mod fit;
mod make;
mod markers;
mod meter;
mod picture;
mod read;
mod reading;
#[cfg(test)]
mod reading_tests;
mod receive;
mod tacho;
#[cfg(test)]
mod tests;
mod twc;
#[cfg(test)]
mod types_tests;
mod wav;
mod wav_head;

pub use audible::unheard;
pub use btu_rig::waveform::Teeth;
pub use make::{
    Made, Samples, Strength, Wave, bytes_of, make, make_tacho, reference_hz, rest_hz, samples,
};
pub use picture::{Columns, Picture, Span};
pub use read::{read, read_and_picture};
pub use reading::{Level, MOST_CHANNELS, NotUnderstood, Reading, Source, Tacho, Why};
pub use receive::Receivers;
pub use tacho::read_tacho;
pub(crate) use wav::sample_of_16_bits;
pub use wav::{End, Wav};

/// Sample rate of waveforms that are made, Hz.
pub const SAMPLE_HZ: u32 = 48_000;
/// What full scale of a file stands for, mV, unless something else is said: above the strongest level a receiver decodes.
pub const FULL_SCALE_MV: f64 = 4_000.0;
