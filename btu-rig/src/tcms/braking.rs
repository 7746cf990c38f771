//! Braking: from a share of full service to the demands on inverters and air brakes
//! [S3 eq. 4-8].
//!
//! Each MT pair is asked for its share of the train's effort, weighed by its load. Its inverter gives
//! what the electric pattern and adhesion allow, air on its trailers makes up for the rest, and air on
//! its motor cars for what is still missing, each up to its own maximum. The share of a car without
//! brake goes to the other pairs, the same to each.
//!
//! Who can give what changes with load and cut-outs only, so it is kept ([`Sharing`]) from scan to
//! scan.

use crate::train::{CarSet, MAX_CARS, PerCar};

use super::consist::Consist;

/// What the pairs' parts can give, N, at one load and with the same cars cut out.
#[derive(Clone, Debug)]
pub struct Sharing {
    shares: Vec<PairShares>,
    /// Place of each car's pair.
    pair_of: [usize; MAX_CARS],
    /// Part of its pair's electric brake that each car gives.
    electric_part: PerCar,
    /// The same of air on trailers, or on motor cars.
    air_part: PerCar,
    /// Motor cars that brake electrically, with their pair.
    willing: Vec<(usize, usize)>,
    trailers: CarSet,
    full_n: f64,
}

/// One MT pair, N.
#[derive(Clone, Copy, Debug, Default)]
struct PairShares {
    /// Full service, with what it takes over for others.
    full_n: f64,
    /// Its inverters by adhesion.
    electric_n: f64,
    trailer_air_n: f64,
    motor_air_n: f64,
}

/// What is asked for in one scan.
#[derive(Clone, Copy, Debug)]
pub struct BrakingInputs<'a> {
    /// Share of full service, 0..1 (BE_s), jerk limited.
    pub share: f64,
    /// Electric brake there is, share of its greatest (DBE_v).
    pub pattern: f64,
    /// The same when air that is asked for now will be there. Air takes longer than an inverter, and
    /// would come too late to a brake that fades.
    pub pattern_ahead: f64,
    /// What inverters should be giving by now and what their electric brakes give (EFM of S3); none
    /// when they give what they are asked for.
    pub inverters: Option<Inverters<'a>>,
}

/// Inverters as asked and as they answer.
#[derive(Clone, Copy, Debug)]
pub struct Inverters<'a> {
    /// Effort of each that should be there by now, N, electric brake below 0.
    pub due_n: &'a PerCar,
    /// Electric brake of each, N, a size.
    pub electric_n: &'a PerCar,
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

impl Sharing {
    /// For the consist's load, with cars whose inverter gives no electric brake, and cars that have no
    /// air brake.
    pub fn new(consist: &Consist, no_electric: CarSet, no_air: CarSet) -> Self {
        let pair_n = consist.full_brake_n() / consist.pairs.len().max(1) as f64;
        let wanted_n: f64 = consist
            .pairs
            .iter()
            .map(|pair| pair_n * pair.load_factor())
            .sum();
        let mut sharing = Self {
            shares: Vec::with_capacity(consist.pairs.len()),
            pair_of: [0; MAX_CARS],
            electric_part: [0.0; MAX_CARS],
            air_part: [0.0; MAX_CARS],
            willing: Vec::new(),
            trailers: CarSet::NONE,
            full_n: wanted_n,
        };
        for (at, pair) in consist.pairs.iter().enumerate() {
            let sum = |of: &PerCar, cars: CarSet| cars.iter().map(|car| of[car]).sum::<f64>();
            let willing = pair.motors.without(no_electric);
            let (trailers, motors) = (pair.trailers.without(no_air), pair.motors.without(no_air));
            let moved_n = moved(consist, at, wanted_n, no_air);
            let shares = PairShares {
                full_n: (pair_n * pair.load_factor() + moved_n).max(0.0),
                electric_n: sum(&consist.electric_n, willing),
                trailer_air_n: sum(&consist.air_n, trailers),
                motor_air_n: sum(&consist.air_n, motors),
            };
            for car in pair.motors.with(pair.trailers).iter() {
                sharing.pair_of[car] = at;
            }
            for car in willing.iter() {
                sharing.electric_part[car] = part(consist.electric_n[car], shares.electric_n);
                sharing.willing.push((car, at));
            }
            for car in trailers.iter() {
                sharing.air_part[car] = part(consist.air_n[car], shares.trailer_air_n);
                sharing.trailers.set(car, true);
            }
            for car in motors.iter() {
                sharing.air_part[car] = part(consist.air_n[car], shares.motor_air_n);
            }
            sharing.shares.push(shares);
        }
        sharing
    }

    /// Demands of one scan. It keeps nothing.
    pub fn braking(&self, inputs: &BrakingInputs<'_>) -> BrakeDemands {
        let lost_n = self.lost(inputs.inverters);
        let (mut electric_n, mut trailer_n, mut motor_n) =
            ([0.0; MAX_CARS], [0.0; MAX_CARS], [0.0; MAX_CARS]);
        for (at, pair) in self.shares.iter().enumerate() {
            let needed_n = inputs.share * pair.full_n;
            electric_n[at] = needed_n.min(inputs.pattern * pair.electric_n);
            let left_n = needed_n.min(inputs.pattern_ahead * pair.electric_n);
            let air_n = needed_n - left_n + lost_n[at];
            trailer_n[at] = air_n.min(pair.trailer_air_n);
            motor_n[at] = (air_n - trailer_n[at]).min(pair.motor_air_n);
        }
        let mut demands = BrakeDemands {
            train_n: inputs.share * self.full_n,
            electric_n: [0.0; MAX_CARS],
            air_n: [0.0; MAX_CARS],
        };
        for car in 0..MAX_CARS {
            let at = self.pair_of[car];
            let air_n = if self.trailers.contains(car) {
                trailer_n[at]
            } else {
                motor_n[at]
            };
            demands.electric_n[car] = self.electric_part[car] * electric_n[at];
            demands.air_n[car] = self.air_part[car] * air_n;
        }
        demands
    }

    /// Electric brake of each pair that should be there and is not, N.
    fn lost(&self, inverters: Option<Inverters<'_>>) -> PerCar {
        let mut lost_n = [0.0; MAX_CARS];
        let Some(inverters) = inverters else {
            return lost_n;
        };
        for &(car, at) in &self.willing {
            lost_n[at] += (-inverters.due_n[car] - inverters.electric_n[car]).max(0.0);
        }
        lost_n
    }
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
        for car in of.motors.with(of.trailers).iter() {
            if !no_air.contains(car) {
                continue;
            }
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
