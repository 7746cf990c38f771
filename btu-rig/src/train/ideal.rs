//! The papers' train: dv/dt = −r·v + u/M [S0 eq. 8], M·dv/dt + f_d(t)·v = u (S1).
//!
//! Exact for constant effort over a step [S0 eq. 9]: v′ = A·v + B·u with A = e^(−rT) and
//! B = (1 − e^(−rT))/(M·r). Effort is a share of an acceleration, so the mass cancels but for f_d.

use crate::conditions::{Conditions, Disturbance};

use super::data::IdealData;
use super::{Equipment, KGF_PER_T, Piece, TrainInputs, TrainState};

/// A point mass with ideal drive and brakes.
#[derive(Clone, Debug)]
pub(super) struct Ideal {
    data: IdealData,
    brake_factor: f64,
    gradient_offset_permille: f64,
    disturbance: Disturbance,
    pub(super) velocity_mps: f64,
    seconds: f64,
    /// Efforts of the last step, N: traction and brake.
    efforts_n: (f64, f64),
    /// Coefficients for the latest step and damping.
    discrete: Discrete,
}

/// A and B·M of [S0 eq. 9] for one step and damping.
#[derive(Clone, Copy, Debug, Default)]
struct Discrete {
    dt_s: f64,
    damping_per_s: f64,
    keeps: f64,
    gains_s: f64,
}

impl Discrete {
    fn new(dt_s: f64, damping_per_s: f64) -> Self {
        let lost = -(-damping_per_s * dt_s).exp_m1();
        let gains_s = if damping_per_s == 0.0 {
            dt_s
        } else {
            lost / damping_per_s
        };
        Self {
            dt_s,
            damping_per_s,
            keeps: 1.0 - lost,
            gains_s,
        }
    }
}

impl Ideal {
    pub(super) fn new(data: &IdealData, conditions: &Conditions) -> Self {
        let mut train = Self {
            data: data.clone(),
            brake_factor: 1.0,
            gradient_offset_permille: 0.0,
            disturbance: Disturbance::None,
            velocity_mps: 0.0,
            seconds: 0.0,
            efforts_n: (0.0, 0.0),
            discrete: Discrete::default(),
        };
        train.set_conditions(conditions);
        train
    }

    pub(super) fn set_conditions(&mut self, conditions: &Conditions) {
        self.brake_factor = conditions.brake_factor;
        self.gradient_offset_permille = conditions.gradient_offset_permille;
        self.disturbance = conditions.disturbance;
    }

    pub(super) fn place(&mut self, velocity_mps: f64) {
        self.velocity_mps = velocity_mps;
        self.seconds = 0.0;
        self.efforts_n = (0.0, 0.0);
    }

    /// One car with the whole train's effort.
    pub(super) fn equipment(&self) -> Equipment {
        let mut equipment = Equipment::default();
        equipment.axle_mps[0] = self.velocity_mps.abs();
        (equipment.traction_n[0], equipment.air_n[0]) = self.efforts_n;
        equipment
    }

    pub(super) fn step(&mut self, dt_s: f64, inputs: &TrainInputs) -> TrainState {
        let mass_kg = self.data.mass_kg + inputs.load_kg;
        // The disturbance at the middle of the step stands for the whole step (midpoint rule).
        let damping_n_s_per_m = self.disturbance.at(self.seconds + 0.5 * dt_s);
        self.seconds += dt_s;
        let damping_per_s = self.data.drag_per_s + damping_n_s_per_m / mass_kg;
        if dt_s != self.discrete.dt_s || damping_per_s != self.discrete.damping_per_s {
            self.discrete = Discrete::new(dt_s, damping_per_s);
        }
        let speed_mps = self.velocity_mps;
        let (power, brake) = self.efforts_mps2(inputs);
        self.efforts_n = (power * mass_kg, brake * mass_kg);
        let gradient = if self.data.gradients {
            (inputs.gradient_permille + self.gradient_offset_permille) * KGF_PER_T
        } else {
            0.0
        };
        let drive = if inputs.backward { -power } else { power } - gradient;
        // Brakes oppose motion; at rest they hold as far as they reach.
        let direction = match speed_mps {
            v if v != 0.0 => v.signum(),
            _ if drive.abs() <= brake => 0.0,
            _ => drive.signum(),
        };
        let net = if direction == 0.0 {
            0.0
        } else {
            drive - direction * brake
        };
        let end = self.discrete.keeps * speed_mps + self.discrete.gains_s * net;
        let stops = speed_mps != 0.0 && end * speed_mps <= 0.0;
        self.velocity_mps = if stops { 0.0 } else { end };
        let pieces = Piece::between(speed_mps, end, dt_s);
        let middle_mps = 0.5 * (speed_mps + self.velocity_mps);
        TrainState {
            pieces,
            axle: pieces,
            traction_n: power * mass_kg,
            air_brake_n: brake * mass_kg,
            resistance_n: damping_per_s * mass_kg * middle_mps.abs(),
            gradient_n: gradient * mass_kg,
            tractive_power_w: power * mass_kg * middle_mps.abs(),
            braking: brake > 0.0,
            ..TrainState::default()
        }
    }

    /// Powering and braking, m/s², never negative.
    fn efforts_mps2(&self, inputs: &TrainInputs) -> (f64, f64) {
        let share = inputs.demand.clamp(-1.0, 1.0);
        let fade = self.data.base_speed_kmh.map_or(1.0, |base_kmh| {
            let base_mps = base_kmh / 3.6;
            base_mps / self.velocity_mps.abs().max(base_mps)
        });
        let power = share.max(0.0) * self.data.power_kmh_per_s / 3.6 * fade;
        let mut brake_share = (-share).max(0.0);
        if inputs.security {
            brake_share = 1.0;
        }
        if inputs.parking {
            brake_share = brake_share.max(self.data.parking_share);
        }
        let service = brake_share * self.data.service_kmh_per_s / 3.6;
        let emergency = if inputs.emergency {
            self.data.emergency_kmh_per_s / 3.6
        } else {
            0.0
        };
        (power, service.max(emergency) * self.brake_factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::TrainData;

    const DT: f64 = 0.005;

    fn train(change: fn(&mut IdealData), conditions: &Conditions) -> Ideal {
        let TrainData::Ideal(mut data) = TrainData::ideal() else {
            panic!("a point mass");
        };
        change(&mut data);
        Ideal::new(&data, conditions)
    }

    fn demand(demand: f64) -> TrainInputs {
        TrainInputs {
            demand,
            ..TrainInputs::default()
        }
    }

    /// After n steps of constant effort: v = u/(M·r)·(1 − e^(−r·n·T)), the solution of eq. (8).
    #[test]
    fn follows_equation_9() {
        let mut train = train(|_| (), &Conditions::default());
        let (mut distance, steps) = (0.0, 2000);
        for _ in 0..steps {
            let state = train.step(DT, &demand(0.6));
            distance += state.pieces[0].distance_m();
        }
        let (accel, r, t) = (0.6 * 3.0 / 3.6, 0.001, f64::from(steps) * DT);
        let speed = accel / r * (1.0 - (-r * t).exp());
        assert!((train.velocity_mps - speed).abs() < 1e-10);
        let expected = accel / r * (t - (1.0 - (-r * t).exp()) / r);
        assert!((distance - expected).abs() < 1e-6, "{distance} {expected}");
    }

    /// Full brake from 10 m/s without drag: 10²/(2·3.5/3.6) m, then it stays.
    #[test]
    fn brakes_stop_it_and_hold_it() {
        let mut train = train(|d| d.drag_per_s = 0.0, &Conditions::default());
        train.place(10.0);
        let mut distance = 0.0;
        for _ in 0..4000 {
            let state = train.step(DT, &demand(-1.0));
            distance += state.pieces[0].distance_m();
        }
        assert_eq!(train.velocity_mps, 0.0);
        assert!((distance - 50.0 * 3.6 / 3.5).abs() < 1e-6, "{distance}");
    }

    /// S1's plant: 432 t coasting under f_d = 2e4·sin(2πt) has lost nothing after each period, and
    /// after half a period v = v₀·exp(−∫f_d/M dt) = v₀·exp(−2e4/(π·432e3)).
    #[test]
    fn a_disturbance_damps_and_drives_in_turn() {
        let conditions = Conditions {
            disturbance: Disturbance::Sine {
                amplitude_n_s_per_m: 2e4,
                hz: 1.0,
            },
            ..Conditions::default()
        };
        let change: fn(&mut IdealData) = |d| (d.mass_kg, d.drag_per_s) = (432e3, 0.0);
        let mut train = train(change, &conditions);
        train.place(10.0);
        for step in 1..=400 {
            train.step(DT, &demand(0.0));
            let expected = match step {
                100 | 300 => 10.0 * (-2e4 / (std::f64::consts::PI * 432e3)).exp(),
                200 | 400 => 10.0,
                _ => continue,
            };
            assert!((train.velocity_mps - expected).abs() < 1e-5, "{step}");
        }
    }

    /// Security brake as hard as full service, parking brake by its share, neither adding to a brake.
    #[test]
    fn hard_wired_brakes_brake() {
        for (security, parking, demand, share) in [
            (true, false, 0.0, 1.0),
            (true, true, -0.5, 1.0),
            (false, true, 0.0, 0.25),
            (false, true, -0.5, 0.5),
        ] {
            let change: fn(&mut IdealData) = |d| (d.drag_per_s, d.parking_share) = (0.0, 0.25);
            let mut train = train(change, &Conditions::default());
            train.place(20.0);
            let inputs = TrainInputs {
                demand,
                security,
                parking,
                ..TrainInputs::default()
            };
            let state = train.step(DT, &inputs);
            let lost_mps = 20.0 - train.velocity_mps;
            assert!(
                (lost_mps / DT - share * 3.5 / 3.6).abs() < 1e-9,
                "{inputs:?}"
            );
            assert!(state.braking);
        }
    }

    #[test]
    fn gradients_act_only_when_asked() {
        let downhill = TrainInputs {
            gradient_permille: -35.0,
            ..TrainInputs::default()
        };
        let mut level = train(|_| (), &Conditions::default());
        level.step(DT, &downhill);
        assert_eq!(level.velocity_mps, 0.0);
        let mut rolls = train(|d| d.gradients = true, &Conditions::default());
        rolls.step(DT, &downhill);
        assert!(rolls.velocity_mps > 0.0);
    }
}
