//! Waveforms to and from a sound card with two channels: the coil of speed codes (ATP) and that of TWC.
//!
//! No library of the system is needed to build: what carries the samples is a program of the sound server, or of ALSA, as
//! a child process (`programs`). Its samples go through a pipe that holds few of them. When this program is stopped,
//! killed or stuck, the pipe ends or runs dry, and the card falls silent.

mod calibration;
mod carried;
mod play;
mod programs;
mod record;
mod stream;

use serde::{Deserialize, Serialize};

pub use crate::signal::SAMPLE_HZ;

pub use ato_under_test::serve::DEFAULT;
pub use calibration::{Calibration, Calibrations, Direction};
pub use play::{Lead, Played, play};
pub use programs::{DeviceFound, devices};
pub use record::{MOST_RECORDED_S, Recorded, Take, record, record_to_file};
pub use stream::{Stream, TAKES_MS};

/// Channels of a card that are used.
pub const CHANNELS: usize = 2;

protocol::labelled! {
    /// One of the two channels.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    pub enum Side: name {
        /// The first, or left one: speed codes.
        Atp = "atp",
        /// The second, or right one: TWC.
        Twc = "twc",
    }
}
