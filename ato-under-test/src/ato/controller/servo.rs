//! Servo.

use protocol::config::AtoConfig;

use super::{Demand, Pss, Situation, SpeedController};

/// The controller.
#[derive(Debug)]
pub struct Servo(Pss);

impl Servo {
    /// A controller with the configuration's gains.
    pub fn new(config: &AtoConfig) -> Self {
        Self(Pss::new(config))
    }
}

impl SpeedController for Servo {
    fn step(&mut self, situation: &Situation) -> Demand {
        self.0.step(situation)
    }

    fn reset(&mut self) {
        self.0.reset();
    }
}
