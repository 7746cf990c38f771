//! Speed generator of the TEST board: pulses in place of the tachometers, and the counter that measures them
//! where they leave.

use protocol::message::TestSpeed;
use protocol::{Duration, Instant, SCAN, Speed};

use crate::signals::Pulses;
use crate::speedometer::Speedometer;

/// Acceleration when none is asked for, mm/s².
const OWN_ACCEL_MMS2: u16 = 3000;
/// Time over which the counter averages.
const WINDOW: Duration = Duration::from_ms(100);

#[derive(Debug)]
pub struct SpeedGenerator {
    metres_per_pulse: f64,
    request: TestSpeed,
    speed: Speed,
    pulses: f64,
    counter: Speedometer,
}

impl SpeedGenerator {
    /// A generator at rest, for tachometers of this resolution.
    pub fn new(metres_per_pulse: f64) -> Self {
        Self {
            metres_per_pulse,
            request: TestSpeed::default(),
            speed: Speed::ZERO,
            pulses: 0.0,
            counter: Speedometer::new(WINDOW, metres_per_pulse),
        }
    }

    /// Goes from the present speed to another one.
    pub fn go(&mut self, mut request: TestSpeed) {
        if request.accel_mms2 == 0 {
            request.accel_mms2 = OWN_ACCEL_MMS2;
        }
        self.request = request;
    }

    /// Whether the generator makes pulses in place of this tachometer, 0 or 1.
    pub fn drives(&self, channel: usize) -> bool {
        self.request.channels & (1 << channel) != 0
    }

    /// The pulses of one scan, `gain` times as many as there should be.
    pub fn step(&mut self, now: Instant, gain: f64) -> Pulses {
        let goal = f64::from(self.request.speed_cms) / 100.0;
        let step = f64::from(self.request.accel_mms2) / 1000.0 * SCAN.as_secs();
        let speed = self.speed.mps();
        let speed = speed + (goal - speed).clamp(-step, step);
        self.speed = Speed::from_mps(speed);

        let speed = speed * gain;
        let before = libm::floor(self.pulses);
        self.pulses += speed * SCAN.as_secs() / self.metres_per_pulse;
        let after = libm::floor(self.pulses);
        let beyond = self.pulses - after;
        let age_s = if speed > 0.0 {
            beyond * self.metres_per_pulse / speed
        } else {
            0.0
        };
        let pulses = Pulses {
            count: (after - before) as u32,
            edge_at: now.back(Duration::from_secs(age_s)),
            sampled_at: now,
            backward: self.request.backward != 0,
        };
        self.counter.step(&pulses);
        pulses
    }

    /// Speed of the pulses that left the generator, measured by their edges.
    pub fn measured(&self) -> Speed {
        self.counter.speed
    }
}
