//! Speed and way at which the effort of this cycle will meet the train.
//!
//! The printed laws act on the present speed of a train whose effort is there at once. A measured speed
//! is the mean of a window that lies in the past, and effort follows its command after a dead time and
//! with a lag, slower for air than for inverters. The observer runs the train model over that time with
//! the efforts already asked for, and looks ahead by the lag: of a first-order lag, `v + lag·a` follows
//! the command as the printed point mass follows its force.
//!
//! The model is held to the measured speed, and what it lacks (a brake that gives more or less, a gradient
//! that is not in the track database) is estimated as a constant acceleration. Toward standstill pulses
//! come so seldom that a measured speed says less than the model: there it goes on by itself.

use protocol::CYCLE;
use protocol::config::AtoTrainConfig;

/// Cycles of efforts that are remembered: the longest dead time, 1 s.
const CYCLES: usize = 22;
/// Age of a measured speed when it is used: half the window of 100 ms, and a frame.
const MEASURED_S: f64 = 0.06;
/// Way by which it is older still, since it was measured at the last edge, m: half a pulse of 27 mm.
const HALF_PULSE_M: f64 = 0.0135;

/// Correction of speed per cycle, and of the missing acceleration per cycle and second: both poles of
/// the error at 3 1/s.
const CORRECTION: (f64, f64) = (0.28, 0.4);
/// Speeds between which the measured one gains its weight: a pulse every 0.1 s .. every 0.03 s, m/s.
const MEASURABLE_MPS: (f64, f64) = (0.27, 0.8);
/// Greatest error that is taken for one of the model, m/s: against the effort, and with it. A sliding wheel
/// is too slow while braking, a slipping one too fast while powering; neither is the train.
const ERROR_MPS: (f64, f64) = (0.5, 0.1);
/// Speed below the model's at which a braked wheel slides, m/s, and the longest slide, s [default].
const SLIDE_MPS: f64 = 0.25;
const LONGEST_SLIDE_S: f64 = 3.0;
/// Greatest missing acceleration, m/s².
const MOST_MISSING_MPS2: f64 = 0.5;

/// The observer.
#[derive(Debug, Default)]
pub struct Observer {
    /// What was asked for, newest first, m/s².
    asked: [f64; CYCLES],
    /// What of it the train gives by the model.
    given: Lag,
    speed_mps: f64,
    missing_mps2: f64,
    slides_s: f64,
    slid_m: f64,
}

/// A first-order lag.
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
pub struct Ahead {
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Acceleration as the effort begins to act, m/s².
    pub accel_mps2: f64,
    /// Way until then, m.
    pub moved_m: f64,
    /// Way run in the last cycle that sliding wheels did not tell, m.
    pub slid_m: f64,
}

/// Dead time and time constant, s.
#[derive(Clone, Copy, Debug)]
struct Times {
    dead_s: f64,
    lag_s: f64,
}

impl Times {
    /// Of inverters, of air, or of both while one hands over to the other.
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
    /// One cycle: `asked_mps2` is what the last effort asks of the train.
    pub fn step(&mut self, measured_mps: f64, asked_mps2: f64, train: &AtoTrainConfig) -> Ahead {
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
        Ahead {
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
        if measured_mps <= 0.0 {
            self.speed_mps = self.speed_mps.min(MEASURABLE_MPS.0);
        }
        let age_s = MEASURED_S + HALF_PULSE_M / self.speed_mps.max(MEASURABLE_MPS.0);
        let expected = self.speed_mps - accel * age_s;
        if self.slides(measured_mps - expected, dt) {
            self.slid_m = (expected - measured_mps) * dt;
            return;
        }
        self.slid_m = 0.0;
        let (low, high) = MEASURABLE_MPS;
        let sure = ((measured_mps.max(self.speed_mps) - low) / (high - low)).clamp(0.0, 1.0);
        let (against, along) = ERROR_MPS;
        let (least, most) = if self.given.0 < 0.0 {
            (-along, against)
        } else {
            (-against, along)
        };
        let error = (measured_mps - expected).clamp(least, most) * sure;
        self.speed_mps += CORRECTION.0 * error;
        self.missing_mps2 = (self.missing_mps2 + CORRECTION.1 * error * sure)
            .clamp(-MOST_MISSING_MPS2, MOST_MISSING_MPS2);
    }

    /// The wheel that is measured slides under the brake: it says nothing of the train. It is not
    /// believed to for long, since a protection ends a slide.
    fn slides(&mut self, error_mps: f64, dt: f64) -> bool {
        let slides =
            self.given.0 < 0.0 && error_mps < -SLIDE_MPS && self.slides_s < LONGEST_SLIDE_S;
        self.slides_s = if slides {
            self.slides_s + dt
        } else if error_mps < -SLIDE_MPS {
            self.slides_s
        } else {
            0.0
        };
        slides
    }

    /// The measured wheel slides: that it stands does not say that the train does.
    pub fn sliding(&self) -> bool {
        self.slid_m > 0.0
    }

    /// What was asked for some cycles before the last effort.
    fn asked_before(&self, cycles: f64) -> f64 {
        let whole = (cycles as usize).min(CYCLES - 2);
        let part = cycles - whole as f64;
        self.asked[whole] * (1.0 - part) + self.asked[whole + 1] * part
    }

    /// The train stands.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
}
