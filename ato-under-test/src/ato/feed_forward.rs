//! Feed-forward: force that gradients, curves (track database, under the train's length) and running
//! resistance need.
//!
//! The printed laws have none: their integrators would compensate afterwards, too late for a change of
//! gradient within the last metres.

use protocol::config::AtoTrainConfig;
use protocol::line::Section;

/// One kilogram-force per tonne, N/kg.
const KGF_PER_T: f64 = 9.80665e-3;
/// Places along the train at which the track is looked at.
const PLACES: u32 = 8;
/// Parts of the approach, at whose ends the track is looked at.
const APPROACH_PLACES: u32 = 10;

/// Force that keeps the speed with the head at `position_m`, N, in the direction of travel; `weight_kg` is the mass
/// that weighs.
pub fn holding_force_n(
    section: Option<&Section>,
    position_m: f64,
    backward: bool,
    weight_kg: f64,
    train: &AtoTrainConfig,
) -> f64 {
    let uphill = if backward { -1.0 } else { 1.0 };
    let track_kgf_t = section.map_or(0.0, |section| under(section, position_m, uphill, train));
    (track_kgf_t + train.rolling_kgf_t) * KGF_PER_T * weight_kg
}

/// The least holding force from PSM2 to the stop point, N for each kilogram of weight, below 0 = downhill. 0 where
/// no gradient takes part of the brake, since the demanded rate is the greatest on a climb, too.
pub fn approach_n_per_kg(section: &Section, train: &AtoTrainConfig) -> f64 {
    let [_, psm2, _, _] = section.markers_m;
    let distance_m = (section.stop_m - psm2).max(0.0);
    let least = (0..=APPROACH_PLACES)
        .map(|i| psm2 + distance_m * f64::from(i) / f64::from(APPROACH_PLACES))
        .map(|position_m| under(section, position_m, 1.0, train))
        .fold(f64::INFINITY, f64::min);
    ((least + train.rolling_kgf_t) * KGF_PER_T).min(0.0)
}

/// Mean resistance of the track under the train with its head at `position_m`, kgf/t, a gradient times `uphill`.
fn under(section: &Section, position_m: f64, uphill: f64, train: &AtoTrainConfig) -> f64 {
    let sum: f64 = (0..PLACES)
        .map(|i| {
            let back_m = train.length_m * (f64::from(i) + 0.5) / f64::from(PLACES);
            at(section, position_m - back_m, uphill, train)
        })
        .sum();
    sum / f64::from(PLACES)
}

/// Resistance of the track at one place, kgf/t; 1 ‰ is 1 kgf/t.
fn at(section: &Section, position_m: f64, uphill: f64, train: &AtoTrainConfig) -> f64 {
    let gradient = section.gradients.iter().rev();
    let permille = gradient
        .skip_while(|g| g.at_m > position_m)
        .map(|g| g.permille)
        .next();
    let curve = section.curves.iter().rev();
    let radius_m = curve
        .skip_while(|c| c.at_m > position_m)
        .map(|c| c.radius_m)
        .next();
    let curve = radius_m
        .filter(|&r| r > 0.0)
        .map_or(0.0, |r| train.curve_kgf_m_t / r);
    uphill * permille.unwrap_or(0.0) + curve
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::{line8, sg100};

    /// An approach of 35 ‰ down, with 3.3 kgf/t of rolling resistance, takes 31.7 kgf/t, 0.311 m/s²; level or up
    /// nothing.
    #[test]
    fn an_approach_takes_of_the_brake_downhill_only() {
        let mut section = line8().section(61).unwrap().clone();
        section.curves.clear();
        section.gradients.truncate(1);
        let train = sg100().ato.train;
        for (permille, expected) in [(-35.0, -0.311), (0.0, 0.0), (35.0, 0.0)] {
            section.gradients[0].permille = permille;
            let least = approach_n_per_kg(&section, &train);
            assert!((least - expected).abs() < 1e-3, "{permille} ‰: {least}");
        }
    }
}
