//! A train on the rails with TCMS's sharing out of effort.

use btu_rig::conditions::Conditions;
use btu_rig::tcms::{Consist, Demands, Effort, Order};
use btu_rig::train::{CarSet, CarsData, Piece, Train, TrainData, TrainInputs, TrainState};

/// Full load (S3), kg.
pub const FULL_KG: f64 = 160_000.0;
/// Step of the train, s.
pub const STEP_S: f64 = 0.005;

pub struct Ride {
    pub train: Train,
    pub effort: Effort,
    /// Ordered once in two steps, as TCMS does.
    pub demands: Demands,
    pub holding: bool,
    pub brakes_out: CarSet,
    /// What acts on the train; `demand` is the share of full effort that is ordered.
    pub inputs: TrainInputs,
    pub state: TrainState,
    /// Speed at the beginning, and after each step, m/s.
    pub speeds_mps: Vec<f64>,
    pub distance_m: f64,
    steps: u32,
}

impl Ride {
    pub fn new(kmh: f64, load_kg: f64, demand: f64) -> Self {
        let inputs = TrainInputs {
            load_kg,
            demand,
            ..TrainInputs::default()
        };
        Self::under(Conditions::default(), kmh, inputs)
    }

    pub fn under(conditions: Conditions, kmh: f64, inputs: TrainInputs) -> Self {
        let mut train = Train::new(&TrainData::line6(), &conditions);
        train.place(kmh / 3.6);
        Self {
            train,
            effort: Effort::new(Consist::new(&CarsData::line6())),
            demands: Demands::default(),
            holding: false,
            brakes_out: CarSet::NONE,
            inputs,
            state: TrainState::default(),
            speeds_mps: vec![kmh / 3.6],
            distance_m: 0.0,
            steps: 0,
        }
    }

    pub fn step(&mut self) {
        if self.steps.is_multiple_of(2) {
            self.order();
        }
        self.steps += 1;
        (self.inputs.motor_n, self.inputs.air_n) = (self.demands.motor_n, self.demands.air_n);
        self.state = self.train.step(STEP_S, &self.inputs);
        self.distance_m += self.state.pieces.iter().map(Piece::distance_m).sum::<f64>();
        self.speeds_mps.push(self.train.velocity_mps());
    }

    fn order(&mut self) {
        if self.effort.consist.load_kg != self.inputs.load_kg {
            self.effort.consist.weigh(self.inputs.load_kg);
        }
        self.inputs.brakes_cut_out = self.brakes_out;
        let order = Order {
            share: self.inputs.demand,
            holding: self.holding,
            no_inverters: self.inputs.emergency || self.inputs.security,
            power_cut: false,
            speed_mps: self.train.velocity_mps().abs(),
            inverters_out: self.inputs.inverters_cut_out,
            brakes_out: self.brakes_out,
        };
        let equipment = self.train.equipment();
        self.demands = self.effort.step(2.0 * STEP_S, &order, Some(&equipment));
    }

    /// Two steps, with one order.
    fn scan(&mut self) {
        self.step();
        self.step();
    }

    pub fn run(&mut self, seconds: f64) {
        for _ in 0..(seconds / STEP_S).round() as usize {
            self.step();
        }
    }

    /// Steps until `done` and gives the time it took, s.
    pub fn run_until(&mut self, done: impl Fn(&Self) -> bool) -> f64 {
        for steps in 0..60_000 {
            if done(self) {
                return f64::from(steps) * STEP_S;
            }
            self.step();
        }
        panic!("never: {:?}", self.state);
    }

    /// Least and most effort over demand down to a speed.
    pub fn run_to(&mut self, kmh: f64) -> (f64, f64) {
        let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
        while self.kmh() > kmh {
            self.scan();
            let of_demand = self.brake_n() / self.demands.brake_n;
            (low, high) = (low.min(of_demand), high.max(of_demand));
        }
        (low, high)
    }

    /// Time until effort is within 2 % of the demand for good, in the next 3 s, and the extremes of
    /// effort over demand.
    pub fn transient(&mut self) -> (f64, f64, f64) {
        let (mut last_s, mut low, mut high) = (0.0, f64::INFINITY, 0.0_f64);
        for scans in 1..=300 {
            self.scan();
            let of_demand = self.brake_n() / self.demands.brake_n;
            if (of_demand - 1.0).abs() > 0.02 {
                last_s = f64::from(scans) * 2.0 * STEP_S;
            }
            (low, high) = (low.min(of_demand), high.max(of_demand));
        }
        (last_s, low, high)
    }

    pub fn kmh(&self) -> f64 {
        self.train.velocity_mps() * 3.6
    }

    pub fn brake_n(&self) -> f64 {
        self.state.electric_brake_n + self.state.air_brake_n
    }

    /// Greatest change of acceleration in 200 ms by time, m/s³, as the bench records it.
    pub fn peak_jerk_mps3(&self) -> f64 {
        let accel = |i: usize| (self.speeds_mps[i] - self.speeds_mps[i - 10]) / (10.0 * STEP_S);
        (50..self.speeds_mps.len())
            .map(|i| (accel(i) - accel(i - 40)).abs() / 0.2)
            .fold(0.0, f64::max)
    }
}
