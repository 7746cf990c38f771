//! Observer: predicts speed and distance of the train for the time at which the effort of this cycle takes
//! effect.
//!
//! The papers' control laws act on the present speed of a train whose effort is there at once. A measured speed
//! is the mean of a window that lies in the past, and effort follows its command after a dead time and
//! with a lag, slower for air than for inverters. The observer runs the train model over that time with
//! the efforts already asked for, and looks ahead by the lag: of a first-order lag, `v + lag·a` follows
//! the command as the printed point mass follows its force.
//!
//! The model is held to the measured speed, and what it lacks (a brake that gives more or less, a gradient
//! that is not in the track database) is estimated as a constant acceleration. Toward standstill pulses
//! come so seldom that a measured speed says less than the model: there the model goes on by itself.

use protocol::CYCLE;
use protocol::config::{AtoTrainConfig, ObserverConfig};

/// Cycles of efforts that are remembered: the longest dead time, 1 s.
const CYCLES: usize = 22;
/// Time a frame takes from the tachometer to ATO, s: one scan.
const FRAME_S: f64 = 0.01;
/// Time between pulses at which a measured speed begins to lose its weight, and has none left, s.
const PULSE_S: (f64, f64) = (0.034, 0.1);

/// Quality of the measured speed.
#[derive(Clone, Copy, Debug)]
pub struct SpeedMeasurement {
    /// Window over which the speed is averaged, s.
    pub window_s: f64,
    /// Distance between pulses, m.
    pub pulse_m: f64,
}

#[derive(Clone, Debug)]
pub struct Observer {
    config: ObserverConfig,
    measurement: SpeedMeasurement,
    /// Demanded efforts as acceleration, newest first, m/s².
    asked: [f64; CYCLES],
    /// The part of the demand that the train gives, by the model.
    given: Lag,
    speed_mps: f64,
    missing_mps2: f64,
    slides_s: f64,
    slid_m: f64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Lag(f64);

impl Lag {
    fn follow(&mut self, asked: f64, seconds: f64, lag_s: f64) {
        let share = if lag_s > seconds {
            seconds / lag_s
        } else {
            1.0
        };
        self.0 += (asked - self.0) * share;
    }
}

/// The train when the effort has built up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PredictedState {
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Acceleration as the effort begins to act, m/s².
    pub accel_mps2: f64,
    /// Distance until then, m.
    pub moved_m: f64,
    /// Distance run in the last cycle that sliding wheels did not tell, m.
    pub slid_m: f64,
}

/// Dead time and time constant, s.
#[derive(Clone, Copy, Debug)]
struct Times {
    dead_s: f64,
    lag_s: f64,
}

impl Times {
    /// Times of inverters, of air, or between both while one hands over to the other.
    fn of(train: &AtoTrainConfig, speed_mps: f64, braking: bool) -> Self {
        let span = (train.air_from_kmh - train.air_alone_kmh).max(0.1);
        let air = ((train.air_from_kmh - speed_mps * 3.6) / span).clamp(0.0, 1.0);
        let air = if braking { air } else { 0.0 };
        let between = |inverter: f64, brake: f64| (inverter + (brake - inverter) * air) / 1000.0;
        Self {
            dead_s: between(train.dead_time_ms, train.air_dead_time_ms),
            lag_s: between(train.lag_ms, train.air_lag_ms),
        }
    }
}

impl Observer {
    /// An observer of a train at rest.
    pub fn new(config: &ObserverConfig, measurement: SpeedMeasurement) -> Self {
        Self {
            config: config.clone(),
            measurement,
            asked: [0.0; CYCLES],
            given: Lag::default(),
            speed_mps: 0.0,
            missing_mps2: 0.0,
            slides_s: 0.0,
            slid_m: 0.0,
        }
    }

    /// One cycle: `asked_mps2` is what the last effort asks of the train.
    pub fn step(
        &mut self,
        measured_mps: f64,
        asked_mps2: f64,
        train: &AtoTrainConfig,
    ) -> PredictedState {
        self.asked.rotate_right(1);
        self.asked[0] = asked_mps2;
        let times = Times::of(train, measured_mps, asked_mps2 < 0.0);
        let dt = CYCLE.as_secs();
        let dead_cycles = (times.dead_s / dt).min(CYCLES as f64 - 2.0);
        self.given
            .follow(self.asked_before(dead_cycles), dt, times.lag_s);
        self.correct(measured_mps, dt);
        let mut given = self.given;
        let mut speed = self.speed_mps;
        let mut moved = 0.0;
        let mut left = dead_cycles;
        while left > 0.0 {
            let seconds = left.min(1.0) * dt;
            let asked = self.asked_before((left - 1.0).max(0.0));
            given.follow(asked, seconds, times.lag_s);
            moved += speed * seconds;
            speed += (given.0 + self.missing_mps2) * seconds;
            left -= 1.0;
        }
        let accel_mps2 = given.0 + self.missing_mps2;
        moved += (speed + accel_mps2 * times.lag_s / 2.0) * times.lag_s;
        speed += accel_mps2 * times.lag_s;
        PredictedState {
            speed_mps: speed.max(0.0),
            accel_mps2,
            moved_m: moved.max(0.0),
            slid_m: self.slid_m,
        }
    }

    /// Moves the model on by a cycle and holds it to the measured speed.
    fn correct(&mut self, measured_mps: f64, dt: f64) {
        let accel = self.given.0 + self.missing_mps2;
        self.speed_mps = (self.speed_mps + accel * dt).max(0.0);
        // Speeds of a pulse every 0.1 s and every 0.034 s: between them a measured speed gains its weight.
        let (low, high) = (
            self.measurement.pulse_m / PULSE_S.1,
            self.measurement.pulse_m / PULSE_S.0,
        );
        if measured_mps <= 0.0 {
            self.speed_mps = self.speed_mps.min(low);
        }
        let since_edge_s = self.measurement.pulse_m / 2.0 / self.speed_mps.max(low);
        let age_s = self.measurement.window_s / 2.0 + FRAME_S + since_edge_s;
        let expected = self.speed_mps - accel * age_s;
        if self.slides(measured_mps - expected, dt) {
            self.slid_m = (expected - measured_mps) * dt;
            return;
        }
        self.slid_m = 0.0;
        let sure = ((measured_mps.max(self.speed_mps) - low) / (high - low)).clamp(0.0, 1.0);
        let (against, along) = (self.config.against_mps, self.config.along_mps);
        let (least, most) = if self.given.0 < 0.0 {
            (-along, against)
        } else {
            (-against, along)
        };
        let error = (measured_mps - expected).clamp(least, most) * sure;
        // Both poles of the error at 1 − q.
        let q = (self.config.pole_per_s * dt).min(1.0);
        self.speed_mps += 2.0 * q * error;
        let bound = self.config.missing_mps2;
        self.missing_mps2 = (self.missing_mps2 + q * q / dt * error * sure).clamp(-bound, bound);
    }

    /// Whether the measured wheel slides under the brake and so says nothing of the train. A slide
    /// is assumed for a short time only, as the wheel-slide protection ends it.
    fn slides(&mut self, error_mps: f64, dt: f64) -> bool {
        let slides = self.given.0 < 0.0
            && error_mps < -self.config.slide_mps
            && self.slides_s < self.config.slide_s;
        self.slides_s = if slides {
            self.slides_s + dt
        } else if error_mps < -self.config.slide_mps {
            self.slides_s
        } else {
            0.0
        };
        slides
    }

    /// The measured wheel slides: a wheel at rest does not mean a train at rest.
    pub fn sliding(&self) -> bool {
        self.slid_m > 0.0
    }

    /// Demand of some cycles before the last effort, m/s².
    fn asked_before(&self, cycles: f64) -> f64 {
        let whole = (cycles as usize).min(CYCLES - 2);
        let part = cycles - whole as f64;
        self.asked[whole] * (1.0 - part) + self.asked[whole + 1] * part
    }

    pub fn reset(&mut self) {
        *self = Self::new(&self.config, self.measurement);
    }
}
