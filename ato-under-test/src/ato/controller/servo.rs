//! Servo: S-curve profile, marker-driven station stop, tracking controller [S0 §3.1].
//!
//! Terms: *reference* is the profile's speed and acceleration now; *compensator* the three integrators
//! of the error [S0 eq. 7]; *pull* the correction of the reference's speed by its distance from where the
//! train is.
//!
//! The printed law is u = −K·v + K_c·x_c with gains placed for a point mass. Added to it, because a real
//! train has what the point mass has not:
//! * **Anti-windup.** When REG could not grant the effort, the compensator takes back the error that would
//!   have asked for what was granted (conditioning). Without it a clipped ramp leaves three integrators
//!   full and the stop is lost; the profile's own peak, 3.2 km/h/s, is above the 3.0 allowed.
//! * **Gains by load.** K and K_c are placed per kilogram and scale with the mass TCMS reports.
//! * **Feed-forward** of the profile's acceleration, so that the compensator has only errors to correct.
//! * **Pull** toward the profile's own way between PSM2 and PSM4, since eq. (2) runs by time.

use protocol::CYCLE;
use protocol::config::{AtoConfig, ServoConfig};

use super::doubt::Doubt;
use super::{Demand, Gains, Situation, SpeedController, place};
use crate::ato::profile::{LastMetres, MarkerApproach, SCurve, Setpoint};

/// Greatest pull, share of the reference's speed and m/s.
const PULL: (f64, f64) = (0.1, 0.1);
/// Greatest difference of what is asked for from the profile's own acceleration, m/s²: 50 ‰ that nobody
/// knew of. What is beyond is a wheel that slides, and no effort helps.
const MOST_CORRECTION_MPS2: f64 = 0.5;
/// Speed by which a train that was braked too much may be below the profile before the profile begins
/// anew from the train, m/s.
const LEFT_BEHIND_MPS: f64 = 0.8;
/// Cycles at rest too far from the stop point after which it begins anew.
const REST_CYCLES: u32 = 20;

/// What the profile is doing.
#[derive(Debug)]
enum Phase {
    /// Toward or at the cruising speed by eq. (1).
    Cruise(SCurve),
    /// PSM2 to PSM4 by eq. (2).
    Approach(MarkerApproach),
    /// From PSM4 by eq. (3).
    LastMetres(LastMetres),
}

/// The controller.
#[derive(Debug)]
pub struct Servo {
    config: ServoConfig,
    /// Gains for one kilogram.
    gains: Gains,
    drag_per_s: f64,
    jerk_mps3: f64,
    rest_cycles: u32,
    doubt: Doubt,
    phase: Phase,
    reference: Setpoint,
    /// Integrals of the error: triple, double, single.
    integrals: [f64; 3],
    error_mps: f64,
    asked_mps2: f64,
}

impl Servo {
    /// A controller with the configuration's poles and profile.
    pub fn new(config: &AtoConfig) -> Self {
        Self {
            config: config.servo.clone(),
            gains: place(&config.servo.poles, 1.0, config.train.drag_per_s),
            drag_per_s: config.train.drag_per_s,
            jerk_mps3: config.train.jerk_mps3,
            rest_cycles: 0,
            doubt: Doubt::new(config),
            phase: Phase::Cruise(SCurve::hold(0.0)),
            reference: Setpoint::default(),
            integrals: [0.0; 3],
            error_mps: 0.0,
            asked_mps2: 0.0,
        }
    }

    /// Moves the profile on; gives the speed to follow, pull included.
    fn advance(&mut self, situation: &Situation) -> f64 {
        let dt = CYCLE.as_secs();
        let to_stop = situation.to_stop_m.unwrap_or(f64::INFINITY);
        self.change_phase(situation, to_stop);
        let mut pull = 0.0;
        match &mut self.phase {
            Phase::Cruise(curve) => self.reference = curve.step(dt),
            Phase::Approach(approach) => {
                let (reference, way_m) = approach.step(dt);
                let from_psm4 = to_stop - situation.markers_to_stop_m[3];
                let most = PULL.0 * reference.speed_mps + PULL.1;
                pull = (self.config.position_gain_per_s * (from_psm4 - way_m)).clamp(-most, most);
                self.reference = reference;
            }
            Phase::LastMetres(last) => {
                let rests = self.reference.speed_mps <= 0.0 && situation.speed_mps <= 0.0;
                self.rest_cycles = if rests { self.rest_cycles + 1 } else { 0 };
                if self.rest_cycles > REST_CYCLES {
                    last.creep();
                }
                self.reference = last.step(dt, to_stop);
            }
        }
        self.reference.speed_mps + pull
    }

    fn change_phase(&mut self, situation: &Situation, to_stop: f64) {
        let [psm1, psm2, _, psm4] = situation.markers_to_stop_m;
        let end_mps = self.config.psm4_mps;
        if matches!(self.phase, Phase::LastMetres(_)) {
            return;
        }
        let jerk = self.jerk_mps3;
        if to_stop <= psm4 + LastMetres::begins_before_m(end_mps, psm4, jerk) {
            self.phase = Phase::LastMetres(LastMetres::new(self.reference, jerk));
            return;
        }
        if matches!(self.phase, Phase::Approach(_)) {
            if self.reference.speed_mps - situation.speed_mps < LEFT_BEHIND_MPS {
                return;
            }
            self.begin_from(situation);
        }
        if to_stop <= psm2 && self.reference.speed_mps > end_mps {
            let way_m = to_stop - psm4;
            self.phase = Phase::Approach(MarkerApproach::new(
                self.reference.speed_mps,
                end_mps,
                way_m,
            ));
            return;
        }
        let mut target = situation.cruise_mps;
        if to_stop <= psm1 {
            target = target.min(self.config.psm1_kmh / 3.6);
        }
        if to_stop <= psm2 {
            target = target.min(end_mps);
        }
        if let Phase::Cruise(curve) = &mut self.phase
            && curve.target_mps() != target
        {
            let change = libm::fabs(target - self.reference.speed_mps);
            let seconds = self.config.s_curve_s_per_mps * change + self.config.s_curve_s;
            *curve = SCurve::new(self.reference, target, seconds);
        }
    }

    /// The profile goes on from where the train is.
    fn begin_from(&mut self, situation: &Situation) {
        self.reference = Setpoint {
            speed_mps: situation.speed_mps,
            accel_mps2: 0.0,
        };
        self.integrals = [0.0; 3];
        self.phase = Phase::Cruise(SCurve::hold(situation.speed_mps));
    }

    /// Compensator [S0 eq. 7], conditioned on what was granted of the last demand.
    fn compensate(&mut self, granted_mps2: f64) {
        let t = CYCLE.as_secs();
        let input = [t * t * t / 6.0, t * t / 2.0, t];
        let gain: f64 = dot(&self.gains.integrals, &input);
        let taken_back = (granted_mps2 - self.asked_mps2) / gain;
        let [mut a, mut b, mut c] = self.integrals;
        a += input[0] * taken_back;
        b += input[1] * taken_back;
        c += input[2] * taken_back;
        let e = self.error_mps;
        self.integrals = [
            a + t * b + t * t / 2.0 * c + input[0] * e,
            b + t * c + input[1] * e,
            c + t * e,
        ];
    }
}

impl SpeedController for Servo {
    fn step(&mut self, situation: &Situation) -> Demand {
        if let Some(brake) = self.doubt.brake(situation) {
            return brake;
        }
        self.compensate(situation.granted_n / situation.mass_kg);
        let follow_mps = self.advance(situation);
        let reference = self.reference;
        self.error_mps = follow_mps - situation.speed_mps;
        let correction = self.drag_per_s * follow_mps
            + self.gains.speed * self.error_mps
            + dot(&self.gains.integrals, &self.integrals);
        self.asked_mps2 = reference.accel_mps2 + correction;
        let ends = matches!(self.phase, Phase::LastMetres(_)) && reference.accel_mps2 < 0.0;
        // Where the profile has ended nothing but a brake is right.
        let most = if ends && reference.speed_mps <= 0.0 {
            0.0
        } else {
            MOST_CORRECTION_MPS2
        };
        let given = correction.clamp(-MOST_CORRECTION_MPS2, most);
        Demand {
            target_mps: reference.speed_mps,
            force_n: (reference.accel_mps2 + given) * situation.mass_kg,
        }
    }

    fn reset(&mut self) {
        self.phase = Phase::Cruise(SCurve::hold(0.0));
        self.reference = Setpoint::default();
        self.integrals = [0.0; 3];
        self.error_mps = 0.0;
        self.asked_mps2 = 0.0;
        self.rest_cycles = 0;
    }
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
