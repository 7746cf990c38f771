//! Braking: from a share of full service to the demands on inverters and air brakes
//! [S3 eq. 4-8].
//!
//! Each MT pair is asked for its share of the train's effort, weighed by its load. Its inverter gives
//! what the electric pattern and adhesion allow, air on its trailers makes up for the rest, and air on
//! its motor cars for what is still missing, each up to its own maximum. The share of a car without
//! brake goes to the other pairs, the same to each.

use crate::train::{CarSet, MAX_CARS, PerCar};

use super::consist::{Consist, Pair};

/// What braking looks at.
#[derive(Clone, Copy, Debug)]
pub struct BrakingInputs<'a> {
    /// Share of full service, 0..1 (BE_s), jerk limited.
    pub share: f64,
    /// Speed, m/s, a size.
    pub speed_mps: f64,
    /// Cars whose inverter gives no electric brake.
    pub no_electric: CarSet,
    /// Cars that have no air brake.
    pub no_air: CarSet,
    /// Electric brake each car was asked for and should have given by now, and did not, N.
    pub lost_n: &'a PerCar,
}

/// What each car is asked for, N, sizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrakeDemands {
    /// The whole train.
    pub train_n: f64,
    /// Inverters (DBE1).
    pub electric_n: PerCar,
    /// Air brakes (FBE).
    pub air_n: PerCar,
}

/// Demands of one scan. It keeps nothing.
pub fn braking(consist: &Consist, inputs: &BrakingInputs<'_>) -> BrakeDemands {
    let mut demands = BrakeDemands {
        train_n: 0.0,
        electric_n: [0.0; MAX_CARS],
        air_n: [0.0; MAX_CARS],
    };
    let pattern = pattern(consist, inputs.speed_mps);
    let pair_n = consist.full_brake_n() / consist.pairs.len().max(1) as f64;
    let wanted_n = |pair: &Pair| pair_n * inputs.share * pair.load_factor();
    let train_n: f64 = consist.pairs.iter().map(wanted_n).sum();
    demands.train_n = train_n;
    for (at, pair) in consist.pairs.iter().enumerate() {
        let moved_n = moved(consist, at, train_n, inputs.no_air);
        let needed_n = (wanted_n(pair) + moved_n).max(0.0);
        let limit = |car: usize| pattern * consist.electric_n[car];
        let willing = pair.motors.without(inputs.no_electric);
        let most_n: f64 = willing.iter().map(limit).sum();
        let electric_n = needed_n.min(most_n);
        for car in willing.iter() {
            demands.electric_n[car] = electric_n * part(limit(car), most_n);
        }
        let lost_n: f64 = willing.iter().map(|car| inputs.lost_n[car]).sum();
        let mut air_n = needed_n - electric_n + lost_n;
        for cars in [pair.trailers, pair.motors] {
            let cars = cars.without(inputs.no_air);
            let most_n: f64 = cars.iter().map(|car| consist.air_n[car]).sum();
            let given_n = air_n.min(most_n);
            for car in cars.iter() {
                demands.air_n[car] = given_n * part(consist.air_n[car], most_n);
            }
            air_n -= given_n;
        }
    }
    demands
}

/// What a pair brakes more, or less, because cars have no brake, N: the share of each such car is
/// spread over the pairs it does not belong to (S3: 11.2 % of T1, a third each).
fn moved(consist: &Consist, pair: usize, train_n: f64, no_air: CarSet) -> f64 {
    let others = consist.pairs.len().saturating_sub(1);
    if no_air.is_empty() || others == 0 {
        return 0.0;
    }
    let whole_n: f64 = consist.air_n.iter().sum();
    let mut moved_n = 0.0;
    for (at, of) in consist.pairs.iter().enumerate() {
        for car in of
            .motors
            .with(of.trailers)
            .iter()
            .filter(|&car| no_air.contains(car))
        {
            let share_n = train_n * part(consist.air_n[car], whole_n);
            moved_n += if at == pair {
                -share_n
            } else {
                share_n / others as f64
            };
        }
    }
    moved_n
}

/// DBE_v: electric brake there is at a speed, share of the greatest.
pub fn pattern(consist: &Consist, speed_mps: f64) -> f64 {
    let electric = &consist.data.electric_brake;
    let kmh = speed_mps * 3.6;
    if kmh < electric.fade_from_kmh {
        let span = electric.fade_from_kmh - electric.fade_to_kmh;
        ((kmh - electric.fade_to_kmh) / span).max(0.0)
    } else {
        electric.full_to_kmh / kmh.max(electric.full_to_kmh)
    }
}

/// `value` as a share of `whole`; nothing of nothing is nothing.
fn part(value: f64, whole: f64) -> f64 {
    if whole > 0.0 { value / whole } else { 0.0 }
}
