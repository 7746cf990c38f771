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
//! * **Speed at PSM1** no higher than the brake on the gradients of the approach allows eq. (2): on −35 ‰ the
//!   full brake has 0.64 m/s² left of the 0.85 it asks for from 40 km/h.
//! * **Pull** toward the profile's own distance between PSM2 and PSM4, since eq. (2) runs by time.

use protocol::CYCLE;
use protocol::config::{AtoConfig, ServoConfig};

use super::plausibility::PlausibilityCheck;
use super::{ControllerInput, Demand, Gains, SpeedController, place};
use crate::ato::profile::{FinalStop, FinalStopLimits, MarkerApproach, SCurve, Setpoint};

/// Speed by which an order must be below the station stop's profile to rule instead, m/s.
const ORDER_MPS: f64 = 0.05;

/// Phase of the profile.
#[derive(Clone, Debug)]
enum Phase {
    /// Toward or at the cruising speed by eq. (1).
    Cruise(SCurve),
    /// PSM2 to PSM4 by eq. (2).
    Approach(MarkerApproach),
    /// From PSM4 by eq. (3).
    FinalStop(FinalStop),
}

#[derive(Clone, Debug)]
pub struct Servo {
    config: ServoConfig,
    /// Gains for one kilogram.
    gains: Gains,
    drag_per_s: f64,
    rates: FinalStopLimits,
    /// A cruising speed below the station stop's profile, led to by eq. (1).
    order: Option<SCurve>,
    plausibility: PlausibilityCheck,
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
            rates: FinalStopLimits {
                jerk_mps3: config.train.jerk_mps3,
                most_mps2: config.decel_kmh_per_s / 3.6,
                rest_mps2: config.servo.rest_mps2,
            },
            order: None,
            plausibility: PlausibilityCheck::new(config),
            phase: Phase::Cruise(SCurve::hold(0.0)),
            reference: Setpoint::default(),
            integrals: [0.0; 3],
            error_mps: 0.0,
            asked_mps2: 0.0,
        }
    }

    /// Moves the profile on; gives the speed to follow, pull included.
    fn advance(&mut self, input: &ControllerInput) -> f64 {
        let dt = CYCLE.as_secs();
        let to_stop = input.to_stop_m.unwrap_or(f64::INFINITY);
        self.change_phase(input, to_stop);
        let before = self.reference;
        let mut pull = 0.0;
        match &mut self.phase {
            Phase::Cruise(curve) => self.reference = curve.step(dt),
            Phase::Approach(approach) => {
                let (reference, distance_m) = approach.step(dt);
                let from_psm4 = to_stop - input.markers_to_stop_m[3];
                let most = self.config.pull_share * reference.speed_mps + self.config.pull_mps;
                pull =
                    (self.config.position_gain_per_s * (from_psm4 - distance_m)).clamp(-most, most);
                self.reference = reference;
            }
            Phase::FinalStop(last) => self.reference = last.step(dt, to_stop),
        }
        match self.ordered(before, input, dt) {
            Some(order) => {
                self.reference = order;
                order.speed_mps
            }
            None => self.reference.speed_mps + pull,
        }
    }

    /// Setpoint to follow in place of the station stop's profile where the cruising speed is lower. When
    /// the cruising speed rises again the profile goes on from where the train is.
    fn ordered(&mut self, from: Setpoint, input: &ControllerInput, dt: f64) -> Option<Setpoint> {
        let profile = self.reference;
        let lower = input.cruise_mps < profile.speed_mps - ORDER_MPS;
        if matches!(self.phase, Phase::Cruise(_)) || (!lower && self.order.is_none()) {
            self.order = None;
            return None;
        }
        if !lower {
            self.order = None;
            self.begin_from(input);
            return None;
        }
        let target_mps = input.cruise_mps;
        if self
            .order
            .is_none_or(|curve| curve.target_mps() != target_mps)
        {
            self.order = Some(self.s_curve(from, target_mps));
        }
        let order = self.order.as_mut()?.step(dt);
        (order.speed_mps < profile.speed_mps).then_some(order)
    }

    fn change_phase(&mut self, input: &ControllerInput, to_stop: f64) {
        let [psm1, psm2, _, psm4] = input.markers_to_stop_m;
        let end_mps = self.config.psm4_mps;
        if matches!(self.phase, Phase::FinalStop(_)) {
            return;
        }
        let begins_m = FinalStop::begins_before_m(end_mps, psm4, self.rates.jerk_mps3);
        if to_stop <= psm4 + begins_m {
            self.phase = Phase::FinalStop(FinalStop::new(self.reference, self.rates));
            return;
        }
        if matches!(self.phase, Phase::Approach(_)) {
            let behind_mps = self.reference.speed_mps - input.speed_mps;
            if behind_mps < self.config.left_behind_mps {
                return;
            }
            self.begin_from(input);
        }
        if to_stop <= psm2 && self.reference.speed_mps > end_mps {
            let distance_m = to_stop - psm4;
            self.phase = Phase::Approach(MarkerApproach::new(
                self.reference.speed_mps,
                end_mps,
                distance_m,
            ));
            return;
        }
        let mut target = input.cruise_mps;
        if to_stop <= psm1 {
            let brake_mps2 = self.config.brake_share * input.brake_mps2;
            let fastest = MarkerApproach::fastest_mps(end_mps, psm2 - psm4, brake_mps2);
            target = target.min(self.config.psm1_kmh / 3.6).min(fastest);
        }
        if to_stop <= psm2 {
            target = target.min(end_mps);
        }
        let leads_elsewhere =
            matches!(&self.phase, Phase::Cruise(curve) if curve.target_mps() != target);
        if leads_elsewhere {
            self.phase = Phase::Cruise(self.s_curve(self.reference, target));
        }
    }

    /// Eq. (1) from a setpoint to a speed.
    fn s_curve(&self, from: Setpoint, target_mps: f64) -> SCurve {
        let seconds = self.s_curve_s(target_mps - from.speed_mps);
        SCurve::new(from, target_mps, seconds, self.rates.jerk_mps3)
    }

    /// Time of the S-curve for a change of speed, s.
    fn s_curve_s(&self, change_mps: f64) -> f64 {
        self.config.s_curve_s_per_mps * libm::fabs(change_mps) + self.config.s_curve_s
    }

    /// The profile goes on from where the train is.
    fn begin_from(&mut self, input: &ControllerInput) {
        self.reference = Setpoint {
            speed_mps: input.speed_mps,
            accel_mps2: 0.0,
        };
        self.integrals = [0.0; 3];
        self.phase = Phase::Cruise(SCurve::hold(input.speed_mps));
    }

    /// Compensator [S0 eq. 7], conditioned on the granted part of the last demand.
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
    fn step(&mut self, input: &ControllerInput) -> Demand {
        if let Some(brake) = self.plausibility.brake(input) {
            return brake;
        }
        self.compensate(input.granted_n / input.mass_kg);
        let follow_mps = self.advance(input);
        let reference = self.reference;
        self.error_mps = follow_mps - input.speed_mps;
        let correction = self.drag_per_s * follow_mps
            + self.gains.speed * self.error_mps
            + dot(&self.gains.integrals, &self.integrals);
        self.asked_mps2 = reference.accel_mps2 + correction;
        let ends = matches!(self.phase, Phase::FinalStop(_)) && reference.accel_mps2 < 0.0;
        // Where the profile has ended nothing but a brake is right.
        let most = if ends && reference.speed_mps <= 0.0 {
            0.0
        } else {
            self.config.correction_mps2
        };
        // A larger correction means a sliding wheel, against which no effort helps.
        let given = correction.clamp(-self.config.correction_mps2, most);
        Demand {
            target_mps: reference.speed_mps,
            force_n: (reference.accel_mps2 + given) * input.mass_kg,
        }
    }

    /// Eq. (1) is symmetric: it runs at the mean of both speeds.
    fn slowing_m(&self, from_mps: f64, to_mps: f64) -> f64 {
        self.s_curve_s(from_mps - to_mps) * 0.5 * (from_mps + to_mps)
    }

    fn reset(&mut self) {
        self.phase = Phase::Cruise(SCurve::hold(0.0));
        self.reference = Setpoint::default();
        self.integrals = [0.0; 3];
        self.error_mps = 0.0;
        self.asked_mps2 = 0.0;
        self.order = None;
    }
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
