//! Guidance of the controllers that follow a profile over time: S1's jerk-limited ramps between
//! speeds, and the stop curve when that is lower.
//!
//! S1 has no station stop and a train that is never too heavy for its ramp. Added here: the stop by
//! S2's curve (see [`super::descent`]), and a bound on how far the ramp may run ahead of a train
//! that cannot follow it (full train, gradient, constant power). At that bound the ramp goes on from
//! the train's acceleration, so that it ends softly when the train gets there.

use protocol::CYCLE;
use protocol::config::AtoConfig;

use super::{Descent, JerkLimited, Setpoint};

/// What a reference depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuideInputs {
    /// Speed to run at, m/s.
    pub cruise_mps: f64,
    /// The train.
    pub train: Setpoint,
    /// Way to the stop point, m; `None` = not known.
    pub to_stop_m: Option<f64>,
}

/// Where a train is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guidance {
    /// Speed and acceleration.
    pub setpoint: Setpoint,
    /// The stop curve rules.
    pub stopping: bool,
}

/// The generator of references.
#[derive(Clone, Copy, Debug)]
pub struct Guide {
    ramp: JerkLimited,
    descent: Descent,
    lead_mps: f64,
    running: bool,
}

impl Guide {
    /// A generator for a configuration.
    pub fn new(config: &AtoConfig) -> Self {
        Self {
            ramp: JerkLimited::new(&config.profile),
            descent: Descent::new(&config.pss),
            lead_mps: config.profile.lead_kmh / 3.6,
            running: false,
        }
    }

    /// One cycle.
    pub fn step(&mut self, inputs: GuideInputs) -> Guidance {
        if !self.running {
            self.running = true;
            self.ramp.place(inputs.train);
        }
        let ahead_mps = inputs.train.speed_mps + self.lead_mps;
        if self.ramp.setpoint().speed_mps > ahead_mps {
            self.ramp.place(Setpoint {
                speed_mps: ahead_mps,
                ..inputs.train
            });
        }
        let from = self.ramp.setpoint();
        let ramp = self.ramp.step(inputs.cruise_mps.max(0.0), CYCLE.as_secs());
        let stop = inputs.to_stop_m.map(|way| self.descent.follow(from, way));
        let lower = stop
            .filter(|stop| stop.accel_mps2 < ramp.accel_mps2 || stop.speed_mps < ramp.speed_mps);
        if let Some(stop) = lower {
            self.ramp.place(stop);
        }
        Guidance {
            setpoint: self.ramp.setpoint(),
            stopping: lower.is_some(),
        }
    }

    /// Begin anew with the train's speed.
    pub fn reset(&mut self) {
        self.running = false;
    }
}
