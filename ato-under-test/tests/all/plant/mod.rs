//! Trains of a few lines for the speed controllers: S1's ideal one, and one whose effort comes late.

use ato_under_test::ato::controller::{ControllerInput, Demand, SpeedController};
use protocol::config::AtoConfig;

/// Control cycle, s.
pub const CYCLE_S: f64 = 0.05;
pub const KMH: f64 = 1.0 / 3.6;
const G: f64 = 9.80665;
/// Distance from the markers of section 61 to its stop point, m.
pub const MARKERS_TO_STOP_M: [f64; 4] = [546.0, 108.5, 21.0, 3.5];
/// Distance of one tachometer pulse, m.
const PULSE_M: f64 = 0.027;

pub fn config() -> AtoConfig {
    crate::common::config().ato
}

/// Conditions of a run.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Passengers, kg.
    pub load_kg: f64,
    /// Gradient the track database knows, ‰.
    pub known_permille: f64,
    /// Gradient beside it, ‰.
    pub unknown_permille: f64,
    /// Braking effort given for one asked.
    pub brake_factor: f64,
    /// Speed is known to ± this, m/s, and distance to a tachometer pulse; 0 = exactly.
    pub speed_noise_mps: f64,
    /// Powering is cut until then, s.
    pub cut_until_s: f64,
    /// Distance to the stop point at the start, m.
    pub distance_m: Option<f64>,
}

impl Run {
    pub const LEVEL: Self = Self {
        load_kg: 0.0,
        known_permille: 0.0,
        unknown_permille: 0.0,
        brake_factor: 1.0,
        speed_noise_mps: 0.0,
        cut_until_s: 0.0,
        distance_m: None,
    };
}

/// One cycle of a run.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub at_s: f64,
    pub position_m: f64,
    pub speed_mps: f64,
    pub accel_mps2: f64,
    pub demand: Demand,
}

/// A train whose effort follows after dead time and lag, and an exact image of it in the unit.
pub struct Train<'a> {
    config: &'a AtoConfig,
    run: Run,
    position_m: f64,
    speed_mps: f64,
    /// Acceleration by the effort alone, m/s².
    effort_mps2: f64,
    asked: Vec<f64>,
    granted_mps2: f64,
    random: u64,
}

impl<'a> Train<'a> {
    pub fn new(config: &'a AtoConfig, run: Run) -> Self {
        let dead = (config.train.dead_time_ms / 1000.0 / CYCLE_S).round() as usize;
        Self {
            config,
            run,
            position_m: 0.0,
            speed_mps: 0.0,
            effort_mps2: 0.0,
            asked: vec![0.0; dead],
            granted_mps2: 0.0,
            random: 1,
        }
    }

    fn weight_kg(&self) -> f64 {
        self.config.train.empty_kg + self.run.load_kg
    }

    fn mass_kg(&self) -> f64 {
        self.weight_kg() + self.config.train.rotating_kg
    }

    /// Acceleration by a gradient, m/s².
    fn gravity(&self, permille: f64) -> f64 {
        -G * permille / 1000.0 * self.weight_kg() / self.mass_kg()
    }

    fn noise(&mut self) -> f64 {
        self.random = self
            .random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.random >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    }

    fn input(&mut self, cruise_mps: f64) -> ControllerInput {
        let noisy = self.run.speed_noise_mps > 0.0;
        let (mut position, mut speed) = (self.position_m, self.speed_mps);
        if noisy {
            position = (position / PULSE_M).floor() * PULSE_M;
            speed = (speed + self.noise() * self.run.speed_noise_mps).max(0.0);
        }
        let known = self.gravity(self.run.known_permille);
        let mut effort = self.effort_mps2;
        for &asked in &self.asked {
            effort += (asked - effort) * self.share();
            position += speed * CYCLE_S;
            speed += (effort + known) * CYCLE_S;
        }
        // With a first-order lag, v + lag·a follows the command at once.
        let accel = effort + known;
        let lag_s = self.config.train.lag_ms / 1000.0;
        position += (speed + 0.5 * accel * lag_s) * lag_s;
        speed += accel * lag_s;
        ControllerInput {
            cruise_mps,
            speed_mps: speed.max(0.0),
            accel_mps2: accel,
            to_stop_m: self.run.distance_m.map(|distance| distance - position),
            markers_to_stop_m: MARKERS_TO_STOP_M,
            mass_kg: self.mass_kg(),
            brake_mps2: 3.5 / 3.6 - known,
            granted_n: (self.granted_mps2 + known) * self.mass_kg(),
        }
    }

    fn share(&self) -> f64 {
        (CYCLE_S / (self.config.train.lag_ms / 1000.0)).min(1.0)
    }

    /// Grants a demand as REG does, and moves the train by a cycle.
    fn act(&mut self, demand: Demand, at_s: f64) {
        let train = &self.config.train;
        let asked = (demand.force_n / self.mass_kg()).clamp(
            -self.config.decel_kmh_per_s * KMH,
            self.config.accel_kmh_per_s * KMH,
        );
        let asked = asked - self.gravity(self.run.known_permille);
        let step = train.jerk_mps3 * CYCLE_S;
        let base = train.base_speed_kmh * KMH;
        let power = if at_s < self.run.cut_until_s {
            0.0
        } else {
            train.power_kmh_per_s * KMH * base / self.speed_mps.max(base)
        };
        let brake = train.brake_kmh_per_s * KMH;
        self.granted_mps2 = asked
            .clamp(self.granted_mps2 - step, self.granted_mps2 + step)
            .clamp(-brake, power);
        self.asked.push(self.granted_mps2);
        let acts = self.asked.remove(0);
        let given = if acts < 0.0 {
            acts * self.run.brake_factor
        } else {
            acts
        };
        let parts = 10;
        let dt = CYCLE_S / f64::from(parts);
        let gravity = self.gravity(self.run.known_permille + self.run.unknown_permille);
        for _ in 0..parts {
            self.effort_mps2 += (given - self.effort_mps2) * self.share() / f64::from(parts);
            let accel = self.effort_mps2 + gravity - train.drag_per_s * self.speed_mps;
            let before = self.speed_mps;
            self.speed_mps = (before + accel * dt).max(0.0);
            self.position_m += 0.5 * (before + self.speed_mps) * dt;
        }
    }
}

/// Drives for `seconds`, cruising speed by position.
pub fn drive(
    controller: &mut dyn SpeedController,
    config: &AtoConfig,
    run: Run,
    seconds: f64,
    cruise_mps: impl Fn(f64) -> f64,
) -> Vec<Row> {
    let mut train = Train::new(config, run);
    let cycles = (seconds / CYCLE_S) as u32;
    (0..cycles)
        .map(|cycle| {
            let at_s = f64::from(cycle) * CYCLE_S;
            let input = train.input(cruise_mps(train.position_m));
            let demand = controller.step(&input);
            let (position_m, before) = (train.position_m, train.speed_mps);
            train.act(demand, at_s);
            Row {
                at_s,
                position_m,
                speed_mps: before,
                accel_mps2: (train.speed_mps - before) / CYCLE_S,
                demand,
            }
        })
        .collect()
}

/// S1's train: `M·dv/dt + f_d(t)·v = u` with 432 t, `f_d = 2e4·sin(2πt)` N·s/m and at most 400 kN up to
/// 40 km/h, constant power beyond. Gives profile less speed, m/s, every cycle of the ramp to 60 km/h and
/// 30 s of cruise.
pub fn s1_errors(controller: &mut dyn SpeedController) -> Vec<f64> {
    const MASS_KG: f64 = 432e3;
    const PARTS: u32 = 50;
    let dt = CYCLE_S / f64::from(PARTS);
    let (mut speed, mut accel, mut granted_n) = (0.0_f64, 0.0, 0.0);
    (0..(51.0 / CYCLE_S) as u32)
        .map(|cycle| {
            let demand = controller.step(&ControllerInput {
                cruise_mps: 60.0 * KMH,
                speed_mps: speed,
                accel_mps2: accel,
                to_stop_m: None,
                markers_to_stop_m: MARKERS_TO_STOP_M,
                mass_kg: MASS_KG,
                brake_mps2: 3.5 / 3.6,
                granted_n,
            });
            let error = demand.target_mps - speed;
            let before = speed;
            for part in 0..PARTS {
                let at_s = f64::from(cycle) * CYCLE_S + f64::from(part) * dt;
                let most = 400e3 * 40.0 * KMH / speed.max(40.0 * KMH);
                granted_n = demand.force_n.clamp(-most, most);
                let drag = 2e4 * (2.0 * std::f64::consts::PI * at_s).sin();
                speed += (granted_n - drag * speed) / MASS_KG * dt;
            }
            accel = (speed - before) / CYCLE_S;
            error
        })
        .collect()
}

pub fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values
        .into_iter()
        .fold((0.0, 0.0), |(sum, count), x| (sum + x * x, count + 1.0));
    (sum / count).sqrt()
}
