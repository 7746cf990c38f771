//! Braking: from a share of full service to the demands on inverters and air brakes
//! [S3 eq. 4-8].
//!
//! Each MT pair is asked for its share of the train's effort, weighed by its load. Its inverter gives
//! what the electric pattern and adhesion allow, air on its trailers makes up for the rest, and air on
//! its motor cars for what is still missing, each up to its own maximum. The share of a car without a brake is divided
//! equally among the other pairs. Where a pair is then asked for more than its own maximum by air [S3 table 1: B7 of
//! the full train], its cars give the rest, up to the force of their emergency brake: the printed maxima of seven cars
//! are 11.2 % short of the demand on a full train, which S3 takes from the others.
//!
//! What each car can give changes with load and cut-outs only, so [`Sharing`] keeps it from scan to scan.

use std::ops::Range;

use crate::train::{CarSet, MAX_CARS, PerCar};

use super::consist::Consist;

/// Greatest efforts of the MT pairs and of their cars, N, at one load and with one set of cars cut out.
#[derive(Clone, Debug)]
pub struct Sharing {
    shares: Vec<PairShares>,
    /// Cars, one pair after the other.
    parts: Vec<CarPart>,
    /// Motor cars that brake electrically, with their pair.
    willing: Vec<(usize, usize)>,
    full_n: f64,
}

/// One car, and its share of each brake of its MT pair, 0..1.
#[derive(Clone, Copy, Debug)]
struct CarPart {
    car: usize,
    electric: f64,
    trailer_air: f64,
    motor_air: f64,
    more_air: f64,
}

/// Greatest efforts of one MT pair, N.
#[derive(Clone, Debug)]
struct PairShares {
    /// Full service brake, with what the pair takes over for cars without a brake.
    full_n: f64,
    electric_n: f64,
    trailer_air_n: f64,
    motor_air_n: f64,
    /// Effort that the air brakes of the pair add beyond their maximum in service when other cars have no brake, N.
    more_air_n: f64,
    /// Places of the pair's cars among the parts.
    parts: Range<usize>,
}

/// Demand in one scan.
#[derive(Clone, Copy, Debug)]
pub struct BrakingInputs<'a> {
    /// Share of full service, 0..1 (BE_s), jerk limited.
    pub share: f64,
    /// Electric brake available, share of its greatest (DBE_v).
    pub pattern: f64,
    /// Electric brake available when air that is asked for now arrives, share of its greatest.
    /// Air takes longer than an inverter, and would come too late to a brake that fades.
    pub pattern_ahead: f64,
    /// Efforts that inverters should give by now, and those that they report (EFM of S3); `None` where inverters give
    /// what they are asked for.
    pub inverters: Option<Inverters<'a>>,
}

/// Inverters as asked and as they answer.
#[derive(Clone, Copy, Debug)]
pub struct Inverters<'a> {
    /// Effort that each inverter should give by now, N; negative = electric brake.
    pub due_n: &'a PerCar,
    /// Electric brake that each inverter reports, N, never negative.
    pub electric_n: &'a PerCar,
}

/// Demand on each car, N, never negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrakeDemands {
    pub train_n: f64,
    /// Inverters (DBE1).
    pub electric_n: PerCar,
    /// Air brakes (FBE).
    pub air_n: PerCar,
}

impl Sharing {
    /// Shares for the consist's load, with cars whose inverter gives no electric brake, and cars that
    /// have no air brake.
    pub fn new(consist: &Consist, no_electric: CarSet, no_air: CarSet) -> Self {
        let pair_n = consist.full_brake_n() / consist.pairs.len().max(1) as f64;
        let wanted_n: f64 = consist
            .pairs
            .iter()
            .map(|pair| pair_n * pair.load_factor())
            .sum();
        let mut sharing = Self {
            shares: Vec::with_capacity(consist.pairs.len()),
            parts: Vec::new(),
            willing: Vec::new(),
            full_n: wanted_n,
        };
        let more_n = match no_air.is_empty() {
            true => [0.0; MAX_CARS],
            false => consist.more_air_n(),
        };
        for (at, pair) in consist.pairs.iter().enumerate() {
            let willing = pair.motors.without(no_electric);
            let (trailers, motors) = (pair.trailers.without(no_air), pair.motors.without(no_air));
            let moved_n = moved(consist, at, wanted_n, no_air);
            let begin = sharing.parts.len();
            let all = pair.motors.with(pair.trailers);
            let shares = PairShares {
                full_n: (pair_n * pair.load_factor() + moved_n).max(0.0),
                electric_n: willing.sum(&consist.electric_n),
                trailer_air_n: trailers.sum(&consist.air_n),
                motor_air_n: motors.sum(&consist.air_n),
                more_air_n: motors.with(trailers).sum(&more_n),
                parts: begin..begin + all.iter().count(),
            };
            for car in all.iter() {
                let of = |cars: CarSet, each: &PerCar, whole_n| match cars.contains(car) {
                    true => part(each[car], whole_n),
                    false => 0.0,
                };
                sharing.parts.push(CarPart {
                    car,
                    electric: of(willing, &consist.electric_n, shares.electric_n),
                    trailer_air: of(trailers, &consist.air_n, shares.trailer_air_n),
                    motor_air: of(motors, &consist.air_n, shares.motor_air_n),
                    more_air: of(motors.with(trailers), &more_n, shares.more_air_n),
                });
            }
            sharing.willing.extend(willing.iter().map(|car| (car, at)));
            sharing.shares.push(shares);
        }
        sharing
    }

    /// Demands of one scan; they depend on nothing but `inputs` and the shares.
    pub fn braking(&self, inputs: &BrakingInputs<'_>) -> BrakeDemands {
        let lost_n = self.lost(inputs.inverters);
        let mut demands = BrakeDemands {
            train_n: inputs.share * self.full_n,
            electric_n: [0.0; MAX_CARS],
            air_n: [0.0; MAX_CARS],
        };
        for (pair, lost_n) in self.shares.iter().zip(lost_n) {
            let needed_n = inputs.share * pair.full_n;
            let electric_n = needed_n.min(inputs.pattern * pair.electric_n);
            let left_n = needed_n.min(inputs.pattern_ahead * pair.electric_n);
            let air_n = needed_n - left_n + lost_n;
            let trailer_n = air_n.min(pair.trailer_air_n);
            let motor_n = (air_n - trailer_n).min(pair.motor_air_n);
            let more_n = (air_n - trailer_n - motor_n).min(pair.more_air_n);
            for part in &self.parts[pair.parts.clone()] {
                demands.electric_n[part.car] = part.electric * electric_n;
                demands.air_n[part.car] = part.trailer_air * trailer_n
                    + part.motor_air * motor_n
                    + part.more_air * more_n;
            }
        }
        demands
    }

    /// Electric brake that the inverters of each pair should give and do not report, N. A report that is not a number
    /// counts as no brake.
    fn lost(&self, inverters: Option<Inverters<'_>>) -> PerCar {
        let mut lost_n = [0.0; MAX_CARS];
        let Some(inverters) = inverters else {
            return lost_n;
        };
        for &(car, at) in &self.willing {
            let reported_n = inverters.electric_n[car];
            let given_n = if reported_n.is_finite() {
                reported_n.max(0.0)
            } else {
                0.0
            };
            lost_n[at] += (-inverters.due_n[car] - given_n).max(0.0);
        }
        lost_n
    }
}

/// Effort by which a pair brakes more, or less, because cars have no brake, N: the share of each
/// such car is spread over the pairs it does not belong to (S3: 11.2 % of T1, a third each).
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

/// DBE_v: electric brake available at a speed, share of the greatest.
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

/// `value` as a share of `whole`; 0 where `whole` is 0.
fn part(value: f64, whole: f64) -> f64 {
    if whole > 0.0 { value / whole } else { 0.0 }
}

#[cfg(test)]
mod tests;
