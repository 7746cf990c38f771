//! Figures of S3 as tests: its table derived again from masses, and effort as the train gives it.
//! `cargo test -p btu-rig --test all tcms_figures -- --nocapture` prints them beside the printed ones.

#![allow(
    clippy::print_stdout,
    reason = "figures, for whoever asks with --nocapture"
)]

use btu_rig::tcms::Consist;
use btu_rig::train::{CarSet, CarsData};

use super::ride::{FULL_KG, Ride};

/// Speed at which the train all but stands, km/h.
const STAND_KMH: f64 = 0.1;
const LOADS_KG: [f64; 3] = [0.0, 80_000.0, FULL_KG];
/// S3's table: TC, T1, T2, M1, M2, train; kg, the last four rows N.
const TABLE: [(&str, [f64; 6]); 9] = [
    ("empty", [33552., 29413., 29378., 35705., 35751., 268807.]),
    ("bogies", [10900., 10600., 10600., 13913., 13913., 98652.]),
    ("full", [53552., 49413., 49378., 55705., 55751., 428807.]),
    (
        "braking, empty",
        [35565., 31178., 31141., 40704., 40756., 296368.],
    ),
    (
        "braking, full",
        [55565., 51178., 51141., 60704., 60756., 456368.],
    ),
    (
        "FBE B7, empty",
        [34577., 30312., 30276., 39573., 39624., 288136.],
    ),
    (
        "FBE B7, full",
        [54022., 49756., 49720., 59017., 59068., 443691.],
    ),
    ("electric, empty", [0., 0., 0., 55985., 56058., 224086.]),
    ("electric, full", [0., 0., 0., 87345., 87418., 349526.]),
];
/// Columns of the cars from the head.
const COLUMNS: [usize; 8] = [0, 3, 4, 1, 2, 3, 4, 0];
/// Braking mass full and FBE full of the MT pairs, kg and N, as printed.
const PAIRS: [(f64, f64); 4] = [
    (116_269.0, 113_039.0),
    (111_934.0, 108_825.0),
    (111_844.0, 108_738.0),
    (116_321.0, 113_090.0),
];

fn consist(load_kg: f64) -> Consist {
    let mut consist = Consist::new(&CarsData::line6());
    consist.weigh(load_kg);
    consist
}

fn near(what: &str, value: f64, printed: f64, within: f64) {
    println!("{what:<46} {printed:>12.2} | {value:>12.2}");
    assert!(
        (value - printed).abs() <= within,
        "{what}: {value} {printed}"
    );
}

/// A car's row of the table from its empty mass alone: 6 % or 14 % of rotating parts, 3.5 km/h/s,
/// 0.16·9.8 of the weight.
fn derived(empty_kg: f64, bogies_kg: f64, motor: bool) -> [f64; 9] {
    let braking_kg = empty_kg * if motor { 1.14 } else { 1.06 };
    let electric = if motor { 0.16 * 9.8 } else { 0.0 };
    let full_kg = empty_kg + 20_000.0;
    [
        empty_kg,
        bogies_kg,
        full_kg,
        braking_kg,
        braking_kg + 20_000.0,
        braking_kg * 3.5 / 3.6,
        (braking_kg + 20_000.0) * 3.5 / 3.6,
        empty_kg * electric,
        full_kg * electric,
    ]
}

/// The table from masses, from the train's file and as TCMS calculates with it, all within 1 kg and
/// 1 N of the printed cells, S3's own rounding.
#[test]
fn the_table_of_cars() {
    let data = CarsData::line6();
    let (empty, full) = (consist(0.0), consist(FULL_KG));
    let mut totals = [0.0; 9];
    for (i, car) in data.cars.iter().enumerate() {
        let motor = full.motors.contains(i);
        let from_masses = derived(car.empty_kg, car.bogies_kg, motor);
        let braking_kg = car.empty_kg + car.rotating_kg;
        let held = [
            car.empty_kg,
            car.bogies_kg,
            car.empty_kg + car.full_load_kg,
            braking_kg,
            braking_kg + car.full_load_kg,
            empty.full_service_n[i],
            full.full_service_n[i],
            empty.electric_n[i],
            full.electric_n[i],
        ];
        for (row, (name, printed)) in TABLE.iter().enumerate() {
            let printed = printed[COLUMNS[i]];
            near(
                &format!("{} {name}", car.name),
                from_masses[row],
                printed,
                1.0,
            );
            assert!((held[row] - printed).abs() <= 1.0, "{} {name}", car.name);
            totals[row] += from_masses[row];
        }
        assert!((car.air_n - TABLE[6].1[COLUMNS[i]]).abs() <= 1.0);
    }
    for ((name, printed), total) in TABLE.iter().zip(totals) {
        near(&format!("train {name}"), total, printed[5], 1.0);
    }
    for (at, (pair, printed)) in full.pairs.iter().zip(PAIRS).enumerate() {
        let cars = || pair.motors.with(pair.trailers).iter();
        let name = format!("pair {} braking, full", at + 1);
        near(&name, pair.full_inertia_kg, printed.0, 1.0);
        let full_n = cars().map(|car| full.full_service_n[car]).sum();
        near(
            &format!("pair {} FBE B7, full", at + 1),
            full_n,
            printed.1,
            2.0,
        );
    }
}

/// Greatest efforts of S3's equations 1, 4 and 6, kN.
#[test]
fn greatest_efforts() {
    let (data, full) = (CarsData::line6(), consist(FULL_KG));
    let traction = data.traction.full_load_n / 1e3;
    near("TE_max, kN", 456.4 * 0.83 + 19.024, 397.8, 0.05);
    near("TE_max of the train's file, kN", traction, 397.8, 0.05);
    let traction_n: f64 = full.power_n.iter().sum();
    near("TE_max as shared out, kN", traction_n / 1e3, 397.8, 0.05);
    near("BE_max by 0.97 m/s², kN", 456.368 * 0.97, 442.7, 0.05);
    near(
        "BE_max by 3.5 km/h/s, kN",
        full.full_brake_n() / 1e3,
        443.69,
        0.01,
    );
    let pair = full.full_brake_n() / 4e3;
    near("BE of a pair, kN", pair, 110.9, 0.05);
    let electric: f64 = full.electric_n.iter().sum();
    near("DBE_max, kN", electric / 1e3, 350.0, 0.5);
    near("DBE_max of an inverter, kN", electric / 4e3, 87.0, 0.5);
}

/// T1 has 11.2 % of the train's brake; without it the other three pairs take a third each.
#[test]
fn the_share_of_a_brake_that_is_cut_out() {
    let share = |cut: CarSet| {
        let mut ride = Ride::new(40.0, FULL_KG, -1.0);
        ride.brakes_out = cut;
        ride.run(3.0);
        ride
    };
    let (sound, cut) = (share(CarSet::NONE), share(CarSet::one(3)));
    let pairs = sound.effort.consist.pairs.clone();
    let of = |ride: &Ride, pair: usize| {
        let cars = pairs[pair].motors.with(pairs[pair].trailers);
        let n = |car: usize| ride.demands.air_n[car] - ride.demands.motor_n[car];
        cars.iter().map(n).sum::<f64>()
    };
    let t1 = 100.0 * 49_756.0 / 443_691.0;
    near("share of T1, %", t1, 11.2, 0.05);
    let less = of(&sound, 1) - of(&cut, 1);
    near(
        "taken off its pair, %",
        100.0 * less / 443_691.0,
        11.2,
        0.05,
    );
    for pair in [0, 2, 3] {
        let more = of(&cut, pair) - of(&sound, pair);
        near(
            "taken over by another, %",
            100.0 * more / 443_691.0,
            11.2 / 3.0,
            0.02,
        );
    }
}

/// The whole way from 80 km/h to a stand, electric brake to air: effort on the rails within 2 % of
/// the demand once the onset is over.
#[test]
fn effort_keeps_to_the_demand_through_blending() {
    let fade_from_kmh = CarsData::line6().electric_brake.fade_from_kmh;
    for (cut, name) in [(CarSet::NONE, "sound"), (CarSet::one(3), "T1 cut out")] {
        for load_kg in LOADS_KG {
            for (notch, share) in [("B7", 1.0), ("B4", 0.565), ("B2", 0.275)] {
                let mut ride = Ride::new(80.0, load_kg, -share);
                ride.brakes_out = cut;
                // The ramp to the notch, and what the slower brake takes after it.
                ride.run(share * 3.5 / 3.6 / 0.8 + 0.9);
                let name = format!("{name}, {load_kg:.0} kg, {notch}");
                let (low, high) = ride.run_to(fade_from_kmh);
                println!("{name:<46} effort of demand {low:.4}..{high:.4}");
                assert!(low >= 0.98 && high <= 1.02, "{name}: {low}..{high}");
                // Air alone: the remaining brakes have no more than 393.9 of 443.7 kN.
                let least = match cut.is_empty() || load_kg < FULL_KG || share < 1.0 {
                    true => 0.98,
                    false => 393_935.0 / 443_691.0 - 0.001,
                };
                let (low, high) = ride.run_to(STAND_KMH);
                println!("{:<46} while it fades {low:.4}..{high:.4}", "");
                assert!(low >= least && high <= 1.02, "{name}: {low}..{high}");
            }
        }
    }
}

/// S3: without T1 the other cars give all that is asked for, 443.69 kN, once the electric brake has faded, too. Their own
/// maxima by the car table are 393.9 kN.
#[test]
fn without_t1_a_full_train_stops_on_the_air_of_the_other_cars() {
    let mut ride = Ride::new(60.0, FULL_KG, -1.0);
    ride.brakes_out = CarSet::one(3);
    ride.run_until(|ride| ride.kmh() < 2.0);
    near(
        "air without T1, B7 full, kN",
        ride.brake_n() / 1e3,
        443.69,
        1.5,
    );
}

/// The line takes no regenerated power any more at 40 km/h: air takes over.
#[test]
fn air_takes_over_when_regeneration_is_cut_out() {
    for load_kg in LOADS_KG {
        let mut ride = Ride::new(60.0, load_kg, -1.0);
        ride.run_until(|ride| ride.kmh() <= 40.0);
        ride.inputs.regeneration_refused = true;
        let (seconds, low, high) = ride.transient();
        let name = format!("regeneration cut out, {load_kg:.0} kg");
        println!("{name:<46} {seconds:.2} s, effort of demand {low:.3}..{high:.3}");
        assert!(seconds < 1.0 && high < 1.02, "{seconds} {low} {high}");
        assert_eq!(ride.state.electric_brake_n.round(), 0.0);
        let (low, high) = ride.run_to(STAND_KMH);
        // Two pairs are a little short of air at full load: their cars' own maxima.
        let least = if load_kg < FULL_KG { 0.995 } else { 0.985 };
        assert!(low > least && high < 1.005, "{low} {high}");
    }
}

/// An inverter is cut out while braking: air of its pair takes over.
#[test]
fn air_takes_over_when_an_inverter_is_cut_out() {
    for load_kg in LOADS_KG {
        let mut ride = Ride::new(60.0, load_kg, -1.0);
        ride.run_until(|ride| ride.kmh() <= 40.0);
        ride.inputs.inverters_cut_out = CarSet::one(2);
        let (seconds, low, high) = ride.transient();
        let name = format!("inverter cut out, {load_kg:.0} kg");
        println!("{name:<46} {seconds:.2} s, effort of demand {low:.3}..{high:.3}");
        assert!(seconds < 1.0 && high < 1.02, "{seconds} {low} {high}");
        let (low, high) = ride.run_to(STAND_KMH);
        assert!(low > 0.98 && high < 1.02, "{low} {high}");
    }
}

/// The brake of T1 is cut out while braking: the other pairs take its share over.
#[test]
fn the_others_take_over_when_a_brake_is_cut_out() {
    for load_kg in [0.0, FULL_KG] {
        let mut ride = Ride::new(60.0, load_kg, -1.0);
        ride.run_until(|ride| ride.kmh() <= 40.0);
        ride.brakes_out = CarSet::one(3);
        let (seconds, low, high) = ride.transient();
        let name = format!("brake of T1 cut out, {load_kg:.0} kg");
        println!("{name:<46} {seconds:.2} s, effort of demand {low:.3}..{high:.3}");
        assert!(seconds < 1.0 && high < 1.02, "{seconds} {low} {high}");
        let t1_n = ride.train.equipment().air_n[3];
        assert!(t1_n < 100.0, "{t1_n}");
    }
}

/// B7 decelerates an empty and a full train by 3.5 km/h/s, resistance aside; P4 accelerates them by
/// 3.0 km/h/s up to 35 km/h.
#[test]
fn full_effort_is_the_same_empty_and_full() {
    for load_kg in LOADS_KG {
        let mut ride = Ride::new(80.0, load_kg, -1.0);
        let inertia_kg = TABLE[3].1[5] + load_kg;
        for kmh in [60.0, 40.0, 20.0, 10.0, 3.0] {
            ride.run_until(|ride| ride.kmh() <= kmh);
            let brake = ride.brake_n() / inertia_kg * 3.6;
            let whole = (ride.brake_n() + ride.state.resistance_n) / inertia_kg * 3.6;
            let name = format!("B7 {load_kg:.0} kg at {kmh} km/h, km/h/s ({whole:.2})");
            near(&name, brake, 3.5, 0.03 * 3.5);
            // Air makes up for what the electric brake does not give, and is alone in the end.
            let electric = ride.state.electric_brake_n / ride.brake_n();
            match kmh {
                60.0 | 40.0 => assert!((0.7..0.95).contains(&electric), "{name}: {electric}"),
                3.0 => assert!(electric < 0.05, "{name}: {electric}"),
                _ => {}
            }
        }
        let mut ride = Ride::new(0.0, load_kg, 1.0);
        ride.run_until(|ride| ride.kmh() >= 10.0);
        let seconds = ride.run_until(|ride| ride.kmh() >= 35.0);
        let name = format!("P4 {load_kg:.0} kg, 10 to 35 km/h, km/h/s");
        near(&name, 25.0 / seconds, 3.0, 0.03 * 3.0);
    }
}

/// Emergency and security brake: no electric effort, from any state.
#[test]
fn emergency_and_security_brake_are_air_alone() {
    for load_kg in [0.0, FULL_KG] {
        for emergency in [true, false] {
            let mut ride = Ride::new(60.0, load_kg, -1.0);
            ride.run(3.0);
            assert!(ride.state.electric_brake_n > 0.5 * ride.brake_n());
            ride.inputs.emergency = emergency;
            ride.inputs.security = !emergency;
            ride.run(0.02);
            assert!(ride.demands.motor_n.iter().all(|&n| n == 0.0));
            ride.run(2.0);
            assert!(ride.state.electric_brake_n < 100.0, "{:?}", ride.state);
            let kmh_per_s = ride.brake_n() * 3.6 / (TABLE[3].1[5] + load_kg);
            assert!(kmh_per_s > if emergency { 4.4 } else { 3.4 }, "{kmh_per_s}");
        }
    }
}
