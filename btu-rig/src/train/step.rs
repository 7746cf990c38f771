//! One step of a train: what acts on the train, and what it does.

use super::car_set::{CarSet, PerCar};
use super::piece::Piece;
use crate::conditions::Disturbance;

/// One kilogram-force per tonne, N/kg; also the force per mass on a gradient of 1 ‰.
pub const KGF_PER_T: f64 = 9.80665e-3;

/// Everything that acts on the train in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrainInputs {
    /// Share of full effort, −1 full service brake .. 1 full power; only the point mass uses it.
    pub demand: f64,
    /// Demand of TCMS on each car's inverter, N: powering above 0, electric brake below.
    pub motor_n: PerCar,
    /// Demand of TCMS on each car's air brake, N.
    pub air_n: PerCar,
    /// Emergency brake: its train line is open and not cut out. Hard-wired, air on all cars (S3).
    pub emergency: bool,
    /// Security brake, hard-wired (S3).
    pub security: bool,
    /// Parking brake: springs.
    pub parking: bool,
    /// Brakes are released by force (S4).
    pub forced_release: bool,
    /// The contact line takes no regenerated power.
    pub regeneration_refused: bool,
    pub brakes_cut_out: CarSet,
    pub inverters_cut_out: CarSet,
    /// Traction pulls backward.
    pub backward: bool,
    /// Passengers, kg.
    pub load_kg: f64,
    /// Gradient under the train, mean over its weight, ‰, uphill positive.
    pub gradient_permille: f64,
    /// Curvature under the train, mean over its weight, 1/m.
    pub curvature_per_m: f64,
    /// Share of the train in the open air, not in a tunnel.
    pub open_air: f64,
}

impl TrainInputs {
    /// Takes the voltage away from the contact line: nothing drives, and nothing is regenerated.
    pub fn without_voltage(&mut self) {
        self.regeneration_refused = true;
        self.demand = self.demand.min(0.0);
        self.motor_n = self.motor_n.map(|motor_n| motor_n.min(0.0));
    }
}

/// Motion of the train in one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrainState {
    /// Motion of the train: moving, then standing for the rest if it came to a stop.
    pub pieces: [Piece; 2],
    /// Motion at the rim of the axle with the tachometers; equal to the train's unless the wheel
    /// slips or slides.
    pub axle: [Piece; 2],
    /// Traction on the rails, N, never negative.
    pub traction_n: f64,
    /// Electric brake, N, never negative.
    pub electric_brake_n: f64,
    /// Air brake, N, never negative.
    pub air_brake_n: f64,
    /// Running, starting and curve resistance and the disturbance, N, against the motion.
    pub resistance_n: f64,
    /// Force of the gradient, N, uphill positive.
    pub gradient_n: f64,
    /// Traction power at the wheels, W.
    pub tractive_power_w: f64,
    pub braking: bool,
    /// A car slips or slides.
    pub sliding: bool,
}

impl Disturbance {
    /// Coefficient of the disturbance at a time, N·s/m: the force is `−f_d·v`.
    pub(super) fn at(&self, seconds: f64) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::Sine {
                amplitude_n_s_per_m,
                hz,
            } => amplitude_n_s_per_m * (std::f64::consts::TAU * hz * seconds).sin(),
        }
    }
}
