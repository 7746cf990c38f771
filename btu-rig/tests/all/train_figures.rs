//! The train of cars against what the papers print and what physics keeps.

use btu_rig::conditions::Conditions;
use btu_rig::train::{Piece, TrainInputs, TrainState};

use super::ride::{FULL_KG, Ride, STEP_S};

/// Braking mass, empty (S3).
const EMPTY_INERTIA_KG: f64 = 296_368.0;

fn conditions(change: impl FnOnce(&mut Conditions)) -> Conditions {
    let mut conditions = Conditions::default();
    change(&mut conditions);
    conditions
}

fn demanding(demand: f64) -> TrainInputs {
    TrainInputs {
        demand,
        ..TrainInputs::default()
    }
}

/// A motor car's electric brake reaches S3's limit of 87 kN; trailers brake first.
#[test]
fn electric_brake_reaches_its_limit_and_trailers_do_the_rest() {
    let mut ride = Ride::new(60.0, 0.0, -1.0);
    ride.inputs.load_kg = FULL_KG;
    ride.run(3.0);
    // Full B7 443.7 kN less four times 87.3 and 87.4 kN [S3].
    assert!(
        (ride.state.electric_brake_n - 349_526.0).abs() < 2_000.0,
        "{:?}",
        ride.state
    );
    assert!(
        (ride.state.air_brake_n - 94_165.0).abs() < 3_000.0,
        "{:?}",
        ride.state
    );
}

/// From 80 km/h: v²/2a with 4.5 km/h/s and about 0.03 m/s² of resistance is 193 m, and the dead time
/// and time constant at 80 km/h another 10 m.
#[test]
fn emergency_brake_stops_in_its_distance_by_air_alone() {
    for load_kg in [0.0, FULL_KG] {
        let mut ride = Ride::new(80.0, 0.0, 1.0);
        ride.inputs.emergency = true;
        ride.inputs.load_kg = load_kg;
        ride.run_until(|r| r.kmh() == 0.0 || r.state.electric_brake_n > 0.0 || r.state.sliding);
        assert_eq!(ride.kmh(), 0.0);
        assert!(
            (196.0..208.0).contains(&ride.distance_m),
            "{}",
            ride.distance_m
        );
    }
}

/// Full service from coasting: 10 % and 90 % of the effort after dead time, lag and the ramp of
/// 0.97 m/s² at 0.8 m/s³, 1.22 s, a fifth of it by the slower air; the emergency brake after 0.15 s and 2.3 · 0.3 s.
#[test]
fn brakes_build_up_in_their_times() {
    let share =
        |r: &Ride, full_kmh_per_s: f64| r.brake_n() * 3.6 / full_kmh_per_s / EMPTY_INERTIA_KG;
    let mut service = Ride::new(60.0, 0.0, -1.0);
    let tenth = service.run_until(|r| share(r, 3.5) >= 0.1);
    let most = tenth + service.run_until(|r| share(r, 3.5) >= 0.9);
    assert!((0.25..0.45).contains(&tenth), "{tenth}");
    assert!((1.3..1.7).contains(&most), "{most}");

    let mut emergency = Ride::new(60.0, 0.0, 0.0);
    emergency.inputs.emergency = true;
    let tenth = emergency.run_until(|r| share(r, 4.5) >= 0.1);
    let most = tenth + emergency.run_until(|r| share(r, 4.5) >= 0.9);
    assert!((0.15..0.22).contains(&tenth), "{tenth}");
    assert!((0.80..0.88).contains(&most), "{most}");

    // Twice as slow a train: twice the dead time and time constant.
    let slow = conditions(|it| it.delay_factor = 2.0);
    let mut late = Ride::under(slow, 60.0, emergency.inputs);
    let late_most = late.run_until(|r| share(r, 4.5) >= 0.9);
    assert!((late_most / most - 2.0).abs() < 0.02, "{late_most}");
}

/// From full power to full brake and back, past the fade of the electric brake: jerk stays at the
/// limit [S1: 0.8 m/s³] until the train stops. When full service is released air empties more slowly
/// than the electric brake falls, so that for a moment both fall: a tenth on top.
#[test]
fn jerk_is_limited() {
    for load_kg in [0.0, FULL_KG] {
        let mut ride = Ride::new(0.0, 0.0, 1.0);
        ride.inputs.load_kg = load_kg;
        for (demand, seconds) in [
            (1.0, 18.0),
            (-1.0, 4.0),
            (0.5, 5.0),
            (-0.6, 9.0),
            (1.0, 4.0),
        ] {
            ride.inputs.demand = demand;
            ride.run(seconds);
        }
        ride.inputs.demand = -1.0;
        ride.run_until(|r| r.kmh() < 1.0);
        let peak = ride.peak_jerk_mps3();
        assert!((0.7..0.9).contains(&peak), "{load_kg}: {peak}");
    }
}

#[test]
fn the_holding_brake_holds_where_it_would_roll() {
    for gradient_permille in [35.0, -35.0] {
        let inputs = TrainInputs {
            gradient_permille,
            load_kg: FULL_KG,
            ..TrainInputs::default()
        };
        let mut free = Ride::under(Conditions::default(), 0.0, inputs);
        free.run(2.0);
        assert!(
            free.distance_m * gradient_permille < 0.0,
            "{}",
            free.distance_m
        );
        free.holding = true;
        free.run(10.0);
        assert_eq!(free.kmh(), 0.0);
        let stood_m = free.distance_m;
        free.run(60.0);
        assert_eq!(free.distance_m, stood_m);
    }
}

/// Full power against the holding brake, which goes when motors pull with 10 % of what they can (S4):
/// no roll-back on the ruling gradient, and jerk at its limit although air goes out by itself.
#[test]
fn it_departs_without_rolling_back_or_jumping() {
    for (gradient_permille, load_kg) in [(35.0, FULL_KG), (35.0, 0.0), (0.0, 0.0), (-20.0, FULL_KG)]
    {
        let inputs = TrainInputs {
            gradient_permille,
            load_kg,
            ..TrainInputs::default()
        };
        let mut ride = Ride::under(Conditions::default(), 0.0, inputs);
        ride.holding = true;
        ride.run(3.0);
        let stood_m = ride.distance_m;
        ride.speeds_mps.clear();
        ride.inputs.demand = 1.0;
        let tenth_n = 0.1 * ride.effort.consist.traction_n();
        ride.run_until(|r| r.train.equipment().traction_n[1] >= tenth_n);
        ride.holding = false;
        let mut least_m = stood_m;
        for _ in 0..1200 {
            ride.step();
            least_m = least_m.min(ride.distance_m);
        }
        assert_eq!(least_m, stood_m, "{gradient_permille} {load_kg}");
        let peak = ride.peak_jerk_mps3();
        assert!(peak < 0.9, "{gradient_permille} {load_kg}: {peak}");
        assert!(ride.kmh() > 5.0, "{}", ride.kmh());
    }
}

/// On rails that carry 0.05 full service slides: deceleration is what friction gives, the axle with
/// the tachometers rolls less distance than the train. On good rails again, everything recovers.
#[test]
fn braked_wheels_slide_on_leaves_and_recover() {
    let leaves = conditions(|it| it.adhesion = 0.05);
    let mut ride = Ride::under(leaves, 60.0, demanding(-1.0));
    let mut axle_m = 0.0;
    let mut sliding_steps = 0;
    for _ in 0..1600 {
        ride.step();
        axle_m += ride.state.axle.iter().map(Piece::distance_m).sum::<f64>();
        sliding_steps += u32::from(ride.state.sliding);
    }
    let lost = (60.0 - ride.kmh()) / 3.6 / 8.0;
    assert!((0.2..0.5).contains(&lost), "mean deceleration {lost} m/s²");
    assert!(sliding_steps > 400, "{sliding_steps}");
    assert!(
        axle_m < ride.distance_m - 1.0,
        "{axle_m} {}",
        ride.distance_m
    );

    ride.train.set_conditions(&Conditions::default());
    ride.run(3.0);
    assert!(!ride.state.sliding);
    assert_eq!(ride.state.axle, ride.state.pieces);
    let kmh_per_s = ride.brake_n() / EMPTY_INERTIA_KG * 3.6;
    assert!((kmh_per_s / 3.5 - 1.0).abs() < 0.03, "{kmh_per_s}");
}

/// Motor cars slip at full power on poor rails; the tachometers on a trailer do not see it.
#[test]
fn slip_under_power_does_not_reach_a_trailers_tachometers() {
    let leaves = conditions(|it| it.adhesion = 0.1);
    let mut ride = Ride::under(leaves, 0.0, demanding(1.0));
    let mut slipped = false;
    for _ in 0..2000 {
        ride.step();
        slipped |= ride.state.sliding;
        assert_eq!(ride.state.axle, ride.state.pieces);
    }
    assert!(slipped);
    let accel = ride.train.velocity_mps() / 10.0;
    assert!((0.2..0.6).contains(&accel), "{accel}");
}

/// A wet stop ends, and standing wheels stand.
#[test]
fn a_slide_to_a_stop_leaves_no_wheel_turning() {
    let ice = conditions(|it| it.adhesion = 0.03);
    let mut ride = Ride::under(ice, 30.0, demanding(-1.0));
    ride.run_until(|r| r.kmh() == 0.0);
    ride.run(5.0);
    assert_eq!((ride.kmh(), ride.state.sliding), (0.0, false));
    assert_eq!(ride.state.axle, ride.state.pieces);
}

/// Work of traction less that of brakes, resistance and gradient is the kinetic energy of train and
/// rotating parts, over starts, stops, reversals of the gradient and a disturbance.
#[test]
fn energy_is_kept() {
    let conditions = Conditions {
        gradient_offset_permille: 1.5,
        brake_factor: 0.9,
        disturbance: btu_rig::conditions::Disturbance::Sine {
            amplitude_n_s_per_m: 2e3,
            hz: 0.3,
        },
        ..Conditions::default()
    };
    let mut ride = Ride::under(conditions, 20.0, TrainInputs::default());
    ride.inputs.load_kg = 80_000.0;
    ride.inputs.curvature_per_m = 1.0 / 600.0;
    let inertia_kg = EMPTY_INERTIA_KG + 80_000.0;
    let kinetic = |r: &Ride| 0.5 * inertia_kg * r.train.velocity_mps().powi(2);
    let start = kinetic(&ride);
    let (mut work, mut traction) = (0.0, 0.0);
    for (demand, gradient, seconds) in [
        (1.0, 10.0, 15.0),
        (0.0, -20.0, 5.0),
        (-0.5, -20.0, 10.0),
        (0.3, 30.0, 10.0),
        (-0.2, 0.0, 3.0),
    ] {
        ride.inputs.demand = demand;
        ride.inputs.gradient_permille = gradient;
        for _ in 0..(seconds / STEP_S) as usize {
            let before = ride.distance_m;
            ride.step();
            let s = ride.state;
            let against = s.electric_brake_n + s.air_brake_n + s.resistance_n + s.gradient_n;
            work += (s.traction_n - against) * (ride.distance_m - before);
            traction += s.tractive_power_w * STEP_S;
        }
    }
    let gained = kinetic(&ride) - start;
    assert!(
        (work - gained).abs() < 1e-3 * traction,
        "{work} {gained} of {traction}"
    );
    assert!(ride.kmh() > 1.0 && traction > 1e7);
}

/// Absurd inputs are bounded, and the same inputs give the same bits.
#[test]
fn it_stays_finite_and_deterministic() {
    let run = || {
        let leaves = conditions(|it| it.adhesion = 0.04);
        let mut ride = Ride::under(leaves, 70.0, TrainInputs::default());
        for (i, demand) in [f64::NAN, 1e300, -1e300, f64::INFINITY, 0.0]
            .into_iter()
            .enumerate()
        {
            ride.inputs.demand = demand;
            ride.inputs.backward = i == 3;
            ride.run(4.0);
        }
        ride.speeds_mps
    };
    let (one, two) = (run(), run());
    assert!(one.iter().all(|v| v.is_finite() && v.abs() < 40.0));
    assert_eq!(one, two);
}

/// Goal: a neutral section takes traction and electric brake, and leaves the air. Method: full effort either way, then two
/// seconds of it without voltage.
#[test]
fn nothing_drives_and_nothing_is_regenerated_without_voltage() {
    for demand in [1.0, -1.0] {
        let mut ride = Ride::new(50.0, 0.0, demand);
        ride.run(2.0);
        let electric_n = |state: &TrainState| state.traction_n + state.electric_brake_n;
        assert!(electric_n(&ride.state) > 1e5, "{:?}", ride.state);
        let mut inputs = ride.inputs;
        inputs.without_voltage();
        for _ in 0..400 {
            ride.state = ride.train.step(STEP_S, &inputs);
        }
        assert!(electric_n(&ride.state) < 1e3, "{:?}", ride.state);
    }
}
