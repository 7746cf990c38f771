//! A train of cars.

use crate::conditions::Conditions;

use super::actuator::{Actuators, Times, share_per_step};
use super::blending::{Blending, Command};
use super::data::CarsData;
use super::resistance::RunningResistance;
use super::wheels::{Efforts, Rolling, WheelSets, adhesion_share, direction};
use super::{KGF_PER_T, MAX_CARS, PerCar, Piece, TrainInputs, TrainState};

/// Brake force per mass that counts as applied, m/s² [default].
const BRAKING_MPS2: f64 = 0.02;

/// A train of cars.
#[derive(Clone, Debug)]
pub(super) struct Formation {
    data: CarsData,
    conditions: Conditions,
    blending: Blending,
    motors: Actuators,
    air: Actuators,
    emergency: Emergency,
    resistance: RunningResistance,
    wheels: WheelSets,
    load_kg: f64,
    /// Weight of the whole train, kg.
    weight_kg: f64,
    /// Force of each car's emergency brake, N.
    emergency_n: PerCar,
    efforts: Efforts,
    velocity_mps: f64,
    accel_mps2: f64,
    seconds: f64,
}

/// The emergency brake's valve: the loop opens, a dead time passes, air builds up on all cars.
#[derive(Clone, Copy, Debug)]
struct Emergency {
    times: Times,
    open_s: f64,
    share: f64,
}

impl Emergency {
    fn step(&mut self, dt_s: f64, applied: bool) -> f64 {
        self.open_s = if applied { self.open_s + dt_s } else { 0.0 };
        if self.open_s > self.times.dead_s {
            self.share += (1.0 - self.share) * share_per_step(dt_s, self.times.rise_s);
        } else if self.share > 0.0 {
            self.share -= self.share * share_per_step(dt_s, self.times.fall_s);
        }
        self.share
    }
}

impl Formation {
    pub fn new(data: &CarsData, conditions: &Conditions) -> Self {
        let none = [0.0; MAX_CARS];
        let mut rotating_kg = none;
        for (rotating, car) in rotating_kg.iter_mut().zip(&data.cars) {
            *rotating = car.rotating_kg;
        }
        let mut train = Self {
            conditions: *conditions,
            blending: Blending::new(data),
            motors: Actuators::new(motor_times(data)),
            air: Actuators::new(air_times(data)),
            emergency: Emergency {
                times: emergency_times(data),
                open_s: 0.0,
                share: 0.0,
            },
            resistance: RunningResistance::new(&data.resistance),
            wheels: WheelSets::new(&data.wheels, rotating_kg),
            load_kg: 0.0,
            weight_kg: 0.0,
            emergency_n: none,
            efforts: Efforts {
                traction_n: none,
                electric_n: none,
                air_n: none,
            },
            velocity_mps: 0.0,
            accel_mps2: 0.0,
            seconds: 0.0,
            data: data.clone(),
        };
        train.weigh(0.0);
        train.set_conditions(conditions);
        train
    }

    pub fn set_conditions(&mut self, conditions: &Conditions) {
        self.conditions = *conditions;
        let factor = conditions.delay_factor;
        self.motors
            .set_times(motor_times(&self.data).scaled(factor));
        self.air.set_times(air_times(&self.data).scaled(factor));
        self.emergency.times = emergency_times(&self.data).scaled(factor);
    }

    pub fn place(&mut self, velocity_mps: f64) {
        self.blending.reset();
        self.motors.reset();
        self.air.reset();
        self.emergency.open_s = 0.0;
        self.emergency.share = 0.0;
        self.wheels.reset();
        self.velocity_mps = velocity_mps;
        self.accel_mps2 = 0.0;
        self.seconds = 0.0;
    }

    pub fn velocity_mps(&self) -> f64 {
        self.velocity_mps
    }

    pub fn step(&mut self, dt_s: f64, inputs: &TrainInputs) -> TrainState {
        if inputs.load_kg != self.load_kg {
            self.weigh(inputs.load_kg);
        }
        let speed_mps = self.velocity_mps.abs();
        self.follow_commands(dt_s, speed_mps, inputs);
        let rolling = Rolling {
            velocity_mps: self.velocity_mps,
            accel_mps2: self.accel_mps2,
            reverser: if inputs.backward { -1.0 } else { 1.0 },
            adhesion: self.conditions.adhesion * adhesion_share(speed_mps),
        };
        let rails = self.wheels.grip(&self.efforts, rolling);
        let brake_n = rails.electric_n + rails.air_n;
        let permille = inputs.gradient_permille + self.conditions.gradient_offset_permille;
        let gradient_n = permille * KGF_PER_T * self.weight_kg;
        let drive_n = rolling.reverser * rails.traction_n - gradient_n;
        let disturbance_n = self.conditions.disturbance.at(self.seconds + 0.5 * dt_s) * speed_mps;
        let resistance_n = self.resistance.at(speed_mps, inputs.curvature_per_m) + disturbance_n;
        self.seconds += dt_s;

        let from_mps = self.velocity_mps;
        let against = if from_mps != 0.0 {
            direction(from_mps)
        } else if drive_n.abs()
            <= self.wheels.hold_n(&self.efforts, rolling.adhesion) + resistance_n
        {
            0.0
        } else {
            direction(drive_n)
        };
        self.accel_mps2 = if against == 0.0 {
            0.0
        } else {
            (drive_n - against * (brake_n + resistance_n)) / rails.inertia_kg
        };
        let to_mps = from_mps + self.accel_mps2 * dt_s;
        let stops = from_mps != 0.0 && to_mps * from_mps <= 0.0;
        self.velocity_mps = if stops { 0.0 } else { to_mps };
        let pieces = Piece::between(from_mps, to_mps, dt_s);
        let axle = self.turn_wheels(dt_s, from_mps, pieces);
        TrainState {
            pieces,
            axle,
            traction_n: rails.traction_n,
            electric_brake_n: rails.electric_n,
            air_brake_n: rails.air_n,
            resistance_n,
            gradient_n,
            tractive_power_w: rails.traction_n * 0.5 * (from_mps + self.velocity_mps).abs(),
            braking: brake_n > BRAKING_MPS2 * rails.inertia_kg,
            sliding: self.wheels.sliding(),
        }
    }

    /// Turns the wheels through the step and gives what the tachometers' axle did.
    fn turn_wheels(&mut self, dt_s: f64, from_mps: f64, pieces: [Piece; 2]) -> [Piece; 2] {
        let car = self.data.tachometer_car - 1;
        let rim_before = self.wheels.rim_mps(car);
        self.wheels.turn(dt_s, from_mps, self.velocity_mps);
        match (rim_before, self.wheels.rim_mps(car)) {
            (None, _) => pieces,
            (Some(before), after) => {
                Piece::between(before, after.unwrap_or(self.velocity_mps), dt_s)
            }
        }
    }

    /// Commands become demands on each car, those efforts.
    fn follow_commands(&mut self, dt_s: f64, speed_mps: f64, inputs: &TrainInputs) {
        let lost_n = self.wheels.electric_lost_n(&self.efforts);
        let command = Command {
            share: inputs.share(self.data.service_brake.holding_share),
            emergency: inputs.emergency,
            speed_mps,
            electric_lost_n: lost_n.as_ref(),
        };
        let demands = self.blending.step(dt_s, command);
        let motor_n = self.motors.step(dt_s, &demands.motor_n);
        let air_n = self.air.step(dt_s, &demands.air_n);
        let emergency = self.emergency.step(dt_s, inputs.emergency);
        let factor = self.conditions.brake_factor;
        let efforts = &mut self.efforts;
        for i in 0..MAX_CARS {
            efforts.traction_n[i] = motor_n[i].max(0.0);
            efforts.electric_n[i] = factor * (-motor_n[i]).max(0.0);
            efforts.air_n[i] = factor * air_n[i].max(emergency * self.emergency_n[i]);
        }
    }

    /// Spreads passengers over the train, each car by what it can carry.
    fn weigh(&mut self, load_kg: f64) {
        self.load_kg = load_kg;
        let full_kg: f64 = self.data.cars.iter().map(|car| car.full_load_kg).sum();
        // `max` also takes what is not a number for an empty train.
        let share = load_kg.max(0.0) / full_kg.max(1.0);
        let (mut weight_kg, mut inertia_kg) = ([0.0; MAX_CARS], [0.0; MAX_CARS]);
        for (i, car) in self.data.cars.iter().enumerate() {
            weight_kg[i] = car.empty_kg + share * car.full_load_kg;
            inertia_kg[i] = weight_kg[i] + car.rotating_kg;
            self.emergency_n[i] = inertia_kg[i] * self.data.emergency_brake.kmh_per_s / 3.6;
        }
        self.weight_kg = weight_kg.iter().sum();
        self.blending.weigh(&weight_kg, &inertia_kg);
        self.resistance.weigh(&weight_kg);
        self.wheels.weigh(&weight_kg);
    }
}

fn motor_times(data: &CarsData) -> Times {
    Times {
        dead_s: data.traction.dead_time_s,
        rise_s: data.traction.lag_s,
        fall_s: data.traction.lag_s,
    }
}

fn air_times(data: &CarsData) -> Times {
    Times {
        dead_s: data.service_brake.dead_time_s,
        rise_s: data.service_brake.build_up_s,
        fall_s: data.service_brake.release_s,
    }
}

fn emergency_times(data: &CarsData) -> Times {
    Times {
        dead_s: data.emergency_brake.dead_time_s,
        rise_s: data.emergency_brake.build_up_s,
        fall_s: data.emergency_brake.release_s,
    }
}
