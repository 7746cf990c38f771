//! The train of cars against what the papers print and what physics keeps.

use super::*;
use crate::conditions::Conditions;
use crate::tcms::{Consist, Demands, Effort, Order};

const DT: f64 = 0.005;
/// Full load (S3).
const FULL_KG: f64 = 160_000.0;
/// Braking mass, empty (S3).
const EMPTY_INERTIA_KG: f64 = 296_368.0;

/// A train, TCMS's sharing out of effort, and the steps it has made.
struct TrainRun {
    train: Train,
    effort: Effort,
    /// Ordered once in two steps, as TCMS does.
    demands: Demands,
    holding: bool,
    inputs: TrainInputs,
    state: TrainState,
    speeds_mps: Vec<f64>,
    distance_m: f64,
}

fn conditions(change: impl FnOnce(&mut Conditions)) -> Conditions {
    let mut conditions = Conditions::default();
    change(&mut conditions);
    conditions
}

impl TrainRun {
    fn new(conditions: Conditions, kmh: f64, inputs: TrainInputs) -> Self {
        let mut train = Train::new(&TrainData::line6(), &conditions);
        train.place(kmh / 3.6);
        let cars = CarsData::line6();
        Self {
            train,
            effort: Effort::new(Consist::new(&cars)),
            demands: Demands::default(),
            holding: false,
            inputs,
            state: TrainState::default(),
            speeds_mps: vec![kmh / 3.6],
            distance_m: 0.0,
        }
    }

    fn nominal(kmh: f64, demand: f64) -> Self {
        Self::new(Conditions::default(), kmh, demanding(demand))
    }

    fn step(&mut self) {
        if self.speeds_mps.len() % 2 == 1 {
            self.order();
        }
        (self.inputs.motor_n, self.inputs.air_n) = (self.demands.motor_n, self.demands.air_n);
        self.state = self.train.step(DT, &self.inputs);
        self.distance_m += self.state.pieces.iter().map(Piece::distance_m).sum::<f64>();
        self.speeds_mps.push(self.train.velocity_mps());
    }

    fn order(&mut self) {
        if self.effort.consist.load_kg != self.inputs.load_kg {
            self.effort.consist.weigh(self.inputs.load_kg);
        }
        let order = Order {
            share: self.inputs.demand,
            holding: self.holding,
            no_inverters: self.inputs.emergency,
            power_cut: false,
            speed_mps: self.train.velocity_mps().abs(),
            inverters_out: CarSet::NONE,
            brakes_out: CarSet::NONE,
        };
        let equipment = self.train.equipment();
        self.demands = self.effort.step(2.0 * DT, &order, Some(&equipment));
    }

    fn run(&mut self, seconds: f64) {
        for _ in 0..(seconds / DT).round() as usize {
            self.step();
        }
    }

    /// Steps until `done` and gives the time it took, s.
    fn run_until(&mut self, done: impl Fn(&Self) -> bool) -> f64 {
        for steps in 0..60_000 {
            if done(self) {
                return f64::from(steps) * DT;
            }
            self.step();
        }
        panic!("never: {:?}", self.state);
    }

    fn kmh(&self) -> f64 {
        self.train.velocity_mps() * 3.6
    }

    fn brake_n(&self) -> f64 {
        self.state.electric_brake_n + self.state.air_brake_n
    }

    /// Greatest change of acceleration in 200 ms by time, m/s³, as the bench records it.
    fn peak_jerk_mps3(&self) -> f64 {
        let accel = |i: usize| (self.speeds_mps[i] - self.speeds_mps[i - 10]) / (10.0 * DT);
        (50..self.speeds_mps.len())
            .map(|i| (accel(i) - accel(i - 40)).abs() / 0.2)
            .fold(0.0, f64::max)
    }
}

fn demanding(demand: f64) -> TrainInputs {
    TrainInputs {
        demand,
        ..TrainInputs::default()
    }
}

/// 3.0 km/h/s up to 35 km/h [S1, S3: P4] from empty to full, once the effort is there.
#[test]
fn full_power_accelerates_as_printed_empty_and_full() {
    for load_kg in [0.0, FULL_KG] {
        let mut ride = TrainRun::nominal(0.0, 1.0);
        ride.inputs.load_kg = load_kg;
        ride.run_until(|r| r.kmh() >= 10.0);
        let seconds = ride.run_until(|r| r.kmh() >= 35.0);
        let kmh_per_s = 25.0 / seconds;
        assert!(
            (kmh_per_s / 3.0 - 1.0).abs() < 0.03,
            "{load_kg}: {kmh_per_s}"
        );
    }
}

/// B7 is braking mass × 3.5 km/h/s (S3) at all speeds, whoever gives it: electric at 50 km/h with
/// air on top, air alone below 5 km/h. Resistance comes on top of it.
#[test]
fn full_service_brakes_as_printed_empty_and_full() {
    for load_kg in [0.0, FULL_KG] {
        let inertia_kg = EMPTY_INERTIA_KG + load_kg;
        let mut ride = TrainRun::nominal(80.0, -1.0);
        ride.inputs.load_kg = load_kg;
        for kmh in [60.0, 40.0, 20.0, 3.0] {
            ride.run_until(|r| r.kmh() <= kmh);
            let kmh_per_s = ride.brake_n() / inertia_kg * 3.6;
            assert!(
                (kmh_per_s / 3.5 - 1.0).abs() < 0.03,
                "{load_kg} {kmh}: {kmh_per_s}"
            );
            let electric = ride.state.electric_brake_n / ride.brake_n();
            match kmh {
                60.0 | 40.0 => assert!((0.7..0.95).contains(&electric), "{electric}"),
                3.0 => assert!(electric < 0.05, "{electric}"),
                _ => {}
            }
        }
    }
}

/// A motor car's electric brake reaches S3's limit of 87 kN; trailers brake first.
#[test]
fn electric_brake_reaches_its_limit_and_trailers_do_the_rest() {
    let mut ride = TrainRun::nominal(60.0, -1.0);
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
        let mut ride = TrainRun::nominal(80.0, 1.0);
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
        |r: &TrainRun, full_kmh_per_s: f64| r.brake_n() * 3.6 / full_kmh_per_s / EMPTY_INERTIA_KG;
    let mut service = TrainRun::nominal(60.0, -1.0);
    let tenth = service.run_until(|r| share(r, 3.5) >= 0.1);
    let most = tenth + service.run_until(|r| share(r, 3.5) >= 0.9);
    assert!((0.25..0.45).contains(&tenth), "{tenth}");
    assert!((1.3..1.7).contains(&most), "{most}");

    let mut emergency = TrainRun::nominal(60.0, 0.0);
    emergency.inputs.emergency = true;
    let tenth = emergency.run_until(|r| share(r, 4.5) >= 0.1);
    let most = tenth + emergency.run_until(|r| share(r, 4.5) >= 0.9);
    assert!((0.15..0.22).contains(&tenth), "{tenth}");
    assert!((0.80..0.88).contains(&most), "{most}");

    // Twice as slow a train: twice the dead time and time constant.
    let slow = conditions(|it| it.delay_factor = 2.0);
    let mut late = TrainRun::new(slow, 60.0, emergency.inputs);
    let late_most = late.run_until(|r| share(r, 4.5) >= 0.9);
    assert!((late_most / most - 2.0).abs() < 0.02, "{late_most}");
}

/// From full power to full brake and back, past the fade of the electric brake: jerk stays at the
/// limit [S1: 0.8 m/s³] until the train stops. When full service is released air empties more slowly
/// than the electric brake falls, so that for a moment both fall: a tenth on top.
#[test]
fn jerk_is_limited() {
    for load_kg in [0.0, FULL_KG] {
        let mut ride = TrainRun::nominal(0.0, 1.0);
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
        let mut free = TrainRun::new(Conditions::default(), 0.0, inputs);
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
        let mut ride = TrainRun::new(Conditions::default(), 0.0, inputs);
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
    let mut ride = TrainRun::new(leaves, 60.0, demanding(-1.0));
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
    let mut ride = TrainRun::new(leaves, 0.0, demanding(1.0));
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
    let mut ride = TrainRun::new(ice, 30.0, demanding(-1.0));
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
        disturbance: crate::conditions::Disturbance::Sine {
            amplitude_n_s_per_m: 2e3,
            hz: 0.3,
        },
        ..Conditions::default()
    };
    let mut ride = TrainRun::new(conditions, 20.0, TrainInputs::default());
    ride.inputs.load_kg = 80_000.0;
    ride.inputs.curvature_per_m = 1.0 / 600.0;
    let inertia_kg = EMPTY_INERTIA_KG + 80_000.0;
    let kinetic = |r: &TrainRun| 0.5 * inertia_kg * r.train.velocity_mps().powi(2);
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
        for _ in 0..(seconds / DT) as usize {
            let before = ride.distance_m;
            ride.step();
            let s = ride.state;
            let against = s.electric_brake_n + s.air_brake_n + s.resistance_n + s.gradient_n;
            work += (s.traction_n - against) * (ride.distance_m - before);
            traction += s.tractive_power_w * DT;
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
        let mut ride = TrainRun::new(leaves, 70.0, TrainInputs::default());
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
        let mut ride = TrainRun::nominal(50.0, demand);
        ride.run(2.0);
        let electric_n = |state: &TrainState| state.traction_n + state.electric_brake_n;
        assert!(electric_n(&ride.state) > 1e5, "{:?}", ride.state);
        let mut inputs = ride.inputs;
        inputs.without_voltage();
        for _ in 0..400 {
            ride.state = ride.train.step(DT, &inputs);
        }
        assert!(electric_n(&ride.state) < 1e3, "{:?}", ride.state);
    }
}
