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

use std::ops::Range;

use crate::train::{CarSet, MAX_CARS, PerCar};

use super::consist::Consist;

/// What the pairs' parts can give, N, at one load and with the same cars cut out.
#[derive(Clone, Debug)]
pub struct Sharing {
    shares: Vec<PairShares>,
    /// Cars, one pair after the other.
    parts: Vec<CarPart>,
    /// Motor cars that brake electrically, with their pair.
    willing: Vec<(usize, usize)>,
    full_n: f64,
}

/// Part of each of its pair's brakes that a car gives.
#[derive(Clone, Copy, Debug)]
struct CarPart {
    car: usize,
    electric: f64,
    trailer_air: f64,
    motor_air: f64,
}

/// One MT pair, N.
#[derive(Clone, Debug)]
struct PairShares {
    /// Full service, with what it takes over for others.
    full_n: f64,
    /// Its inverters by adhesion.
    electric_n: f64,
    trailer_air_n: f64,
    motor_air_n: f64,
    /// Its cars among the parts.
    parts: Range<usize>,
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
            parts: Vec::new(),
            willing: Vec::new(),
            full_n: wanted_n,
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
                });
            }
            sharing.willing.extend(willing.iter().map(|car| (car, at)));
            sharing.shares.push(shares);
        }
        sharing
    }

    /// Demands of one scan. It keeps nothing.
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
            for part in &self.parts[pair.parts.clone()] {
                demands.electric_n[part.car] = part.electric * electric_n;
                demands.air_n[part.car] = part.trailer_air * trailer_n + part.motor_air * motor_n;
            }
        }
        demands
    }

    /// Electric brake of each pair that should be there and is not, N. A report that is no number is of
    /// no brake.
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::tcms::consist::line6;

    /// Cars of the bits that the train has.
    fn cars(bits: u16) -> CarSet {
        let mut set = CarSet::NONE;
        for car in 0..8 {
            set.set(car, bits >> car & 1 == 1);
        }
        set
    }

    fn shared(consist: &Consist, share: f64, kmh: [f64; 2], out: [CarSet; 2]) -> BrakeDemands {
        Sharing::new(consist, out[0], out[1]).braking(&BrakingInputs {
            share,
            pattern: pattern(consist, kmh[0] / 3.6),
            pattern_ahead: pattern(consist, kmh[1] / 3.6),
            inverters: None,
        })
    }

    fn near(value: f64, printed: f64) {
        assert!((value - printed).abs() < 3.0, "{value} {printed}");
    }

    /// S3's pair of 110.9 kN: 87 418 N of M2 electric, the rest on its trailer; by air, the trailer's
    /// own B7 first.
    #[test]
    fn electric_first_then_air_on_the_trailer_then_on_the_motor_car() {
        let consist = line6(160_000.0);
        let none = [CarSet::NONE; 2];
        let electric = shared(&consist, 1.0, [50.0; 2], none);
        near(electric.electric_n[2], 87_418.0);
        near(electric.air_n[3], 110_923.0 - 87_418.0);
        assert_eq!((electric.electric_n[3], electric.air_n[2]), (0.0, 0.0));
        let air = shared(&consist, 0.565, [3.0; 2], none);
        near(air.air_n[3], 49_756.0);
        near(air.air_n[2], 0.565 * 110_923.0 - 49_756.0);
    }

    /// What an inverter should give by now and does not comes as air, of its own pair.
    #[test]
    fn air_makes_up_for_an_inverter_that_fails_to_brake() {
        let consist = line6(160_000.0);
        let sharing = Sharing::new(&consist, CarSet::NONE, CarSet::NONE);
        let mut given_n = consist.electric_n;
        given_n[2] -= 40_000.0;
        let due_n = consist.electric_n.map(|n| -n);
        let demands = sharing.braking(&BrakingInputs {
            share: 1.0,
            pattern: 1.0,
            pattern_ahead: 1.0,
            inverters: Some(Inverters {
                due_n: &due_n,
                electric_n: &given_n,
            }),
        });
        near(demands.air_n[3], 49_756.0);
        near(demands.air_n[2], 110_923.0 - 87_418.0 + 40_000.0 - 49_756.0);
        near(demands.air_n[0], 110_923.0 - 87_345.0);
    }

    /// A report that is no number is of nothing given, and air comes in its place.
    #[test]
    fn air_makes_up_for_an_inverter_that_reports_no_number() {
        let consist = line6(160_000.0);
        let sharing = Sharing::new(&consist, CarSet::NONE, CarSet::NONE);
        let due_n = consist.electric_n.map(|n| -n);
        let air_n = |reported_n: f64| {
            let mut electric_n = consist.electric_n;
            electric_n[2] = reported_n;
            let inverters = Inverters {
                due_n: &due_n,
                electric_n: &electric_n,
            };
            let demands = sharing.braking(&BrakingInputs {
                share: 1.0,
                pattern: 1.0,
                pattern_ahead: 1.0,
                inverters: Some(inverters),
            });
            demands.air_n
        };
        let nothing = air_n(0.0);
        assert!(nothing[2] + nothing[3] > 108_000.0);
        for report_n in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e9] {
            assert_eq!(air_n(report_n), nothing, "{report_n}");
        }
    }

    /// Without an inverter its pair brakes by air; without both, its cars are all that is missing.
    #[test]
    fn a_pair_without_its_inverter_brakes_by_air() {
        let consist = line6(0.0);
        let out = [CarSet::one(5), CarSet::NONE];
        let demands = shared(&consist, 1.0, [50.0; 2], out);
        assert_eq!(demands.electric_n[5], 0.0);
        let sum = demands.air_n[4] + demands.air_n[5];
        near(sum, 110_923.0 * consist.pairs[2].load_factor());
    }

    proptest! {
        /// Whatever is asked of whatever is left of the train: each pair gives what it is asked for or
        /// all it has, no car more than its own, the electric brake no more than pattern and adhesion
        /// allow, and the shares of brakes that are out go to the others.
        #[test]
        fn effort_is_neither_lost_nor_made(
            share in 0.0..1.0_f64,
            kmh in 0.0..120.0_f64,
            load_kg in 0.0..200_000.0_f64,
            electric_bits in any::<u16>(),
            air_bits in prop_oneof![Just(0), (0..8_u32).prop_map(|car| 1 << car), any::<u16>()],
        ) {
            let consist = line6(load_kg);
            let out = [cars(electric_bits), cars(air_bits)];
            let demands = shared(&consist, share, [kmh; 2], out);
            let pattern = pattern(&consist, kmh / 3.6);
            let n = |car: usize| demands.electric_n[car] + demands.air_n[car];
            let mut asked_n = 0.0;
            for (at, pair) in consist.pairs.iter().enumerate() {
                let moved_n = moved(&consist, at, demands.train_n, out[1]);
                let pair_n = consist.full_brake_n() / 4.0 * pair.load_factor() * share;
                let needed_n = (pair_n + moved_n).max(0.0);
                asked_n += pair_n + moved_n;
                let both = pair.motors.with(pair.trailers);
                let air = both.without(out[1]).iter().map(|car| consist.air_n[car]);
                let electric = pair.motors.without(out[0]).iter();
                let there_n = air.sum::<f64>()
                    + needed_n.min(electric.map(|car| pattern * consist.electric_n[car]).sum());
                let given_n: f64 = both.iter().map(n).sum();
                prop_assert!((given_n - needed_n.min(there_n)).abs() < 1e-3, "{given_n} {needed_n} {there_n}");
            }
            // Without any cut-out, or with one, what is taken off one pair is put on the others.
            prop_assert!((asked_n - demands.train_n).abs() < 1e-3);
            for car in 0..MAX_CARS {
                prop_assert!(demands.electric_n[car] >= 0.0 && demands.air_n[car] >= 0.0);
                let most_n = pattern * consist.electric_n[car] + 1e-6;
                prop_assert!(demands.electric_n[car] <= most_n);
                prop_assert!(demands.air_n[car] <= consist.air_n[car] + 1e-6);
                prop_assert!(!out[0].contains(car) || demands.electric_n[car] == 0.0);
                prop_assert!(!out[1].contains(car) || demands.air_n[car] == 0.0);
            }
        }

        /// The lead of air changes air alone, by what the electric brake fades in its time.
        #[test]
        fn air_leads_by_what_fades(
            share in 0.0..1.0_f64, kmh in 0.0..60.0_f64, ahead_kmh in 0.0..2.0_f64,
        ) {
            let consist = line6(0.0);
            let none = [CarSet::NONE; 2];
            let level = shared(&consist, share, [kmh; 2], none);
            let leads = shared(&consist, share, [kmh, kmh - ahead_kmh], none);
            let later = shared(&consist, share, [kmh - ahead_kmh; 2], none);
            prop_assert_eq!(leads.electric_n, level.electric_n);
            prop_assert_eq!(leads.air_n, later.air_n);
        }
    }
}
