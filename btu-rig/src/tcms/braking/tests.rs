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

/// S3 figure 6: with T1 cut out the other cars brake the full train as before, by air alone, too. The printed
/// maxima of the seven make 88.8 % of 443 691 N; no car gives more than at 4.5 km/h/s, its emergency brake.
#[test]
fn the_other_cars_give_all_of_a_full_train_without_t1() {
    let consist = line6(160_000.0);
    let demands = shared(&consist, 1.0, [3.0; 2], [CarSet::NONE, CarSet::one(3)]);
    near(demands.air_n.iter().sum(), 443_691.0);
    assert_eq!(demands.air_n[3], 0.0);
    for (car, air_n) in demands.air_n.iter().enumerate() {
        assert!(
            *air_n <= consist.air_n[car] * 4.5 / 3.5 + 3.0,
            "{car}: {air_n}"
        );
    }
}

/// An effort that an inverter should give by now and does not give comes as air of its own pair.
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
        let more_n = consist.more_air_n();
        let beyond = |car: usize| if out[1].is_empty() { 0.0 } else { more_n[car] };
        let air_most_n: PerCar = std::array::from_fn(|car| consist.air_n[car] + beyond(car));
        for (at, pair) in consist.pairs.iter().enumerate() {
            let moved_n = moved(&consist, at, demands.train_n, out[1]);
            let pair_n = consist.full_brake_n() / 4.0 * pair.load_factor() * share;
            let needed_n = (pair_n + moved_n).max(0.0);
            asked_n += pair_n + moved_n;
            let both = pair.motors.with(pair.trailers);
            let air = both.without(out[1]).iter().map(|car| air_most_n[car]);
            let electric = pair.motors.without(out[0]).iter();
            let there_n = air.sum::<f64>()
                + needed_n.min(electric.map(|car| pattern * consist.electric_n[car]).sum());
            let given_n: f64 = both.iter().map(n).sum();
            prop_assert!((given_n - needed_n.min(there_n)).abs() < 1e-3, "{given_n} {needed_n} {there_n}");
        }
        // Without any cut-out, or with one, what is taken off one pair is put on the others.
        prop_assert!((asked_n - demands.train_n).abs() < 1e-3);
        for (car, air_most_n) in air_most_n.into_iter().enumerate() {
            prop_assert!(demands.electric_n[car] >= 0.0 && demands.air_n[car] >= 0.0);
            let most_n = pattern * consist.electric_n[car] + 1e-6;
            prop_assert!(demands.electric_n[car] <= most_n);
            prop_assert!(demands.air_n[car] <= air_most_n + 1e-6);
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
