//! Powering: from a share of full effort to the inverters' demands [S3 eq. 1-3].

use crate::train::{CarSet, MAX_CARS, PerCar};

use super::consist::Consist;

/// Demand on each inverter, N, for a share of full effort at a speed, m/s. Inverters `without` give
/// nothing, and the others no more than their own.
///
/// TE1 = TE_v·TE_s, TE2 = TE_w·TE1: load compensation for each MT pair, so that acceleration is the
/// same from empty to full.
pub fn powering(consist: &Consist, share: f64, speed_mps: f64, without: CarSet) -> PerCar {
    let mut demands = [0.0; MAX_CARS];
    let each_n = consist.traction_n() * share * pattern(consist, speed_mps);
    for pair in &consist.pairs {
        for car in pair.motors.without(without).iter() {
            demands[car] = each_n * pair.load_factor();
        }
    }
    demands
}

/// TE_v: traction there is at a speed, share of the greatest; constant power beyond base speed.
pub fn pattern(consist: &Consist, speed_mps: f64) -> f64 {
    let base_mps = consist.data.traction.base_speed_kmh / 3.6;
    base_mps / speed_mps.max(base_mps)
}
