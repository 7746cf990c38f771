//! Calibrations: what a device makes of the greatest sample, as somebody has measured it.

use std::path::Path;

use fault_db::read_regular_file;
use serde::{Deserialize, Serialize};

use super::{CHANNELS, Side};
use crate::failure::{Failure, SoundTrouble, Why};
use crate::signal::FULL_SCALE_MV;
use crate::whole_file;

/// Longest file, bytes.
const LONGEST_FILE: u64 = 1 << 20;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// To the device.
    Output,
    /// From the device.
    Input,
}

/// A calibration of one channel of a device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Name of the device.
    pub device: String,
    /// Whether it plays or records.
    pub direction: Direction,
    pub channel: Side,
    /// What the greatest sample stands for, mV.
    pub full_scale_mv: f64,
    /// When it was measured, µs UTC.
    pub at_us: i64,
    pub instrument: String,
    /// Uncertainty of the instrument, %.
    pub uncertainty_percent: f64,
}

/// All calibrations that are known to this user.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Calibrations {
    calibrations: Vec<Calibration>,
}

impl Calibrations {
    /// Reads the calibrations; none if there is no file.
    ///
    /// # Errors
    /// The file cannot be read or is damaged.
    pub fn load(file: &Path) -> Result<Self, Failure> {
        let failed =
            |why| Failure::bench(SoundTrouble::Calibrations(file.display().to_string(), why));
        let bytes = match read_regular_file(file, LONGEST_FILE) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Ok(Self::default());
            }
            other => other.map_err(|error| failed(Why::of(error)))?,
        };
        let known: Self = serde_json::from_slice(&bytes).map_err(|error| failed(Why::of(error)))?;
        let is_wrong =
            |of: &&Calibration| !(of.full_scale_mv > 0.0 && of.full_scale_mv.is_finite());
        match known.calibrations.iter().find(is_wrong) {
            Some(wrong) => Err(failed(Why::NoFullScale(wrong.full_scale_mv))),
            None => Ok(known),
        }
    }

    /// Keeps a calibration in the place of an earlier one of its channel.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn keep(&mut self, new: Calibration, file: &Path) -> Result<(), Failure> {
        let is_same = |of: &Calibration| {
            (&of.device, of.direction, of.channel) == (&new.device, new.direction, new.channel)
        };
        self.calibrations.retain(|of| !is_same(of));
        self.calibrations.push(new);
        whole_file::keep(file, self)
    }

    pub fn of(&self, device: &str, direction: Direction, channel: Side) -> Option<&Calibration> {
        self.calibrations.iter().find(|of| {
            (of.device.as_str(), of.direction, of.channel) == (device, direction, channel)
        })
    }

    /// What the greatest sample of each channel stands for, mV; without a calibration a nominal value.
    pub fn full_scale_mv(&self, device: &str, direction: Direction) -> [f64; CHANNELS] {
        Side::ALL.map(|channel| {
            let known = self.of(device, direction, channel);
            known.map_or(FULL_SCALE_MV, |known| known.full_scale_mv)
        })
    }
}
