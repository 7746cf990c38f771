//! Defects of the TEST board: the injected faults that act on its outputs.

use protocol::injection::{Effect, Place};

use crate::faults::Faults;
use crate::signals::AntennaSignal;

/// The board's faults of the present scan.
#[derive(Clone, Copy, Debug)]
pub struct Defects {
    /// The board makes no signal and does not answer.
    pub dead: bool,
    /// Pulses made for each pulse that should be made.
    pub speed_gain: f64,
    level_gain: f64,
    carrier_offset_hz: f64,
    rate_offset_hz: f64,
}

impl Defects {
    pub fn of(faults: &Faults) -> Self {
        let offset = |place| match faults.at(place) {
            Some(Effect::Offset { by }) => by,
            _ => 0.0,
        };
        Self {
            dead: faults.dead(Place::TestBoard),
            speed_gain: faults.gain(Place::TestSpeed),
            level_gain: faults.gain(Place::TestCode),
            carrier_offset_hz: offset(Place::TestCarrier),
            rate_offset_hz: offset(Place::TestRate),
        }
    }

    /// The signal that leaves the code generator for the signal asked for.
    pub fn leaves(&self, asked: AntennaSignal) -> AntennaSignal {
        let moved = |value: f64, by: f64| {
            if value > 0.0 {
                (value + by).max(0.0)
            } else {
                0.0
            }
        };
        AntennaSignal {
            carrier_hz: moved(asked.carrier_hz, self.carrier_offset_hz),
            rate_hz: moved(asked.rate_hz, self.rate_offset_hz),
            level_mv: asked.level_mv * self.level_gain,
            ..AntennaSignal::default()
        }
    }
}

impl Default for Defects {
    fn default() -> Self {
        Self {
            dead: false,
            speed_gain: 1.0,
            level_gain: 1.0,
            carrier_offset_hz: 0.0,
            rate_offset_hz: 0.0,
        }
    }
}
