//! Model of a train of cars: demands of TCMS become forces of each car, and the forces become the train's motion.

use crate::conditions::Conditions;

use super::actuator::{Actuators, Times, share_per_step};
use super::data::CarsData;
use super::resistance::RunningResistance;
use super::wheels::{Efforts, TrainMotion, WheelSets, adhesion_share, direction};
use super::{
    CarSet, Equipment, EquipmentFaults, KGF_PER_T, MAX_CARS, PerCar, Piece, TrainInputs, TrainState,
};

/// Brake force per mass that counts as applied, m/s² [default].
const BRAKING_MPS2: f64 = 0.02;

/// Share of the emergency brake's pressure that counts as no pressure.
const EMPTY_SHARE: f64 = 1e-6;

/// Cut-outs, and other brakes, in the last step.
#[derive(Clone, Copy, Debug, Default)]
struct CutOut {
    regeneration: CarSet,
    others: bool,
}

#[derive(Clone, Debug)]
pub(super) struct Formation {
    data: CarsData,
    conditions: Conditions,
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
    /// Full service of each car, N.
    service_n: PerCar,
    motor_cars: CarSet,
    faults: EquipmentFaults,
    sound: bool,
    /// Pressure in each car's cylinders as force, N.
    cylinders_n: PerCar,
    /// Cut-outs and other brakes of the last step, for reports.
    cut_out: CutOut,
    efforts: Efforts,
    pub velocity_mps: f64,
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
        } else if self.share > EMPTY_SHARE {
            self.share -= self.share * share_per_step(dt_s, self.times.fall_s);
        } else {
            self.share = 0.0;
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
            motors: Actuators::new(data.motor_times()),
            air: Actuators::new(data.air_times()),
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
            service_n: none,
            motor_cars: data.motor_cars(),
            faults: EquipmentFaults::default(),
            sound: true,
            cylinders_n: none,
            cut_out: CutOut::default(),
            efforts: Efforts::default(),
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
            .set_times(self.data.motor_times().scaled(factor));
        self.air.set_times(self.data.air_times().scaled(factor));
        self.emergency.times = emergency_times(&self.data).scaled(factor);
    }

    pub fn place(&mut self, velocity_mps: f64) {
        self.motors.reset();
        self.air.reset();
        self.emergency.open_s = 0.0;
        self.emergency.share = 0.0;
        self.cylinders_n = [0.0; MAX_CARS];
        // Reports are about this drive, not about the one before.
        self.cut_out = CutOut::default();
        self.efforts = Efforts::default();
        self.wheels.reset();
        self.velocity_mps = velocity_mps;
        self.accel_mps2 = 0.0;
        self.seconds = 0.0;
    }

    pub fn set_faults(&mut self, faults: EquipmentFaults) {
        self.sound = faults == EquipmentFaults::default();
        self.faults = faults;
    }

    pub fn equipment(&self) -> Equipment {
        let speed_mps = self.velocity_mps.abs();
        let efforts = &self.efforts;
        // An inverter knows its motors' torque, not what becomes of it at the rims.
        let torque_share = 1.0 / self.conditions.brake_factor;
        let mut equipment = Equipment {
            axle_mps: [speed_mps; MAX_CARS],
            traction_n: efforts.traction_n,
            electric_n: efforts.electric_n.map(|n| n * torque_share),
            air_n: self.cylinders_n,
            inverters_silent: self.faults.inverters_dead,
            regeneration_cut_out: self.cut_out.regeneration,
            brake_units_silent: self.faults.brake_units_dead,
            other_brakes: self.cut_out.others,
        };
        if self.wheels.disturbed {
            for i in 0..MAX_CARS {
                equipment.axle_mps[i] = self.wheels.rim_mps(i).map_or(speed_mps, f64::abs);
                equipment.traction_n[i] *= self.wheels.left(i);
                equipment.electric_n[i] *= self.wheels.left(i);
            }
        }
        equipment
    }

    pub fn step(&mut self, dt_s: f64, inputs: &TrainInputs) -> TrainState {
        if inputs.load_kg != self.load_kg {
            self.weigh(inputs.load_kg);
        }
        let speed_mps = self.velocity_mps.abs();
        self.follow_demands(dt_s, inputs);
        let rolling = TrainMotion {
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
        let resistance_n = (self.resistance).at(speed_mps, inputs.curvature_per_m, inputs.open_air)
            + disturbance_n;
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

    /// Demands become efforts, as far as the equipment is sound and not cut out.
    fn follow_demands(&mut self, dt_s: f64, inputs: &TrainInputs) {
        let no_motor = self.faults.inverters_dead.with(inputs.inverters_cut_out);
        let refused = if inputs.regeneration_refused {
            self.motor_cars
        } else {
            CarSet::NONE
        };
        let no_electric = self.faults.regeneration_lost.with(refused);
        let no_service = self.faults.brake_units_dead.with(inputs.brakes_cut_out);
        self.cut_out = CutOut {
            regeneration: no_electric.without(no_motor),
            others: inputs.emergency || inputs.security || inputs.parking,
        };
        // Equipment is sound nearly always, and a train is simulated many thousand times.
        let all_sound = self.sound
            && (no_motor.with(no_electric).with(no_service)).is_empty()
            && !inputs.security;
        if all_sound {
            self.motors.step(dt_s, &inputs.motor_n);
            self.air.step(dt_s, &inputs.air_n);
        } else {
            let (motor_n, air_n) = self.reach_equipment(inputs, no_motor, no_electric, no_service);
            self.motors.step(dt_s, &motor_n);
            self.air.step(dt_s, &air_n);
        }
        let emergency = self.emergency.step(dt_s, inputs.emergency);
        let mut cylinders_n = self.air.effort_n;
        if emergency > 0.0 || !self.sound {
            self.fill_cylinders(&mut cylinders_n, emergency, inputs);
        }
        self.cylinders_n = cylinders_n;
        let factor = self.conditions.brake_factor;
        let motor_n = &self.motors.effort_n;
        let efforts = &mut self.efforts;
        for i in 0..MAX_CARS {
            efforts.traction_n[i] = motor_n[i].max(0.0);
            efforts.electric_n[i] = factor * (-motor_n[i]).max(0.0);
            efforts.air_n[i] = factor * cylinders_n[i];
        }
        if inputs.parking {
            let share = factor * self.data.service_brake.parking_share;
            for (air, service) in efforts.air_n.iter_mut().zip(&self.service_n) {
                *air = air.max(share * service);
            }
        }
    }

    /// Demands on inverters and air brakes that reach equipment which is able to follow, N.
    #[cold]
    fn reach_equipment(
        &self,
        inputs: &TrainInputs,
        no_motor: CarSet,
        no_electric: CarSet,
        no_service: CarSet,
    ) -> (PerCar, PerCar) {
        let (mut motor_n, mut air_n) = (inputs.motor_n, inputs.air_n);
        let full = self.data.service_brake.security_share;
        for i in 0..MAX_CARS {
            if no_motor.contains(i) || motor_n[i] < 0.0 && no_electric.contains(i) {
                motor_n[i] = 0.0;
            }
            motor_n[i] *= 1.0 - self.faults.motor_lost[i];
            if no_service.contains(i) {
                air_n[i] = 0.0;
            }
            air_n[i] *= 1.0 - self.faults.pressure_lost[i];
            if inputs.security && !inputs.brakes_cut_out.contains(i) {
                air_n[i] = air_n[i].max(full * self.service_n[i]);
            }
        }
        (motor_n, air_n)
    }

    /// Adds the effort of the emergency brake's valve, and the effort that stuck cylinders keep, N.
    #[cold]
    fn fill_cylinders(&self, cylinders_n: &mut PerCar, emergency: f64, inputs: &TrainInputs) {
        for (i, cylinder_n) in cylinders_n.iter_mut().enumerate() {
            if inputs.brakes_cut_out.contains(i) {
                continue;
            }
            *cylinder_n = cylinder_n.max(emergency * self.emergency_n[i]);
            if self.faults.brakes_stuck.contains(i) && !inputs.forced_release {
                *cylinder_n = cylinder_n.max(self.cylinders_n[i]);
            }
        }
    }

    /// Spreads passengers over the train, each car by what it can carry.
    fn weigh(&mut self, load_kg: f64) {
        self.load_kg = load_kg;
        let full_kg: f64 = self.data.cars.iter().map(|car| car.full_load_kg).sum();
        // `max` turns not-a-number into an empty train.
        let share = load_kg.max(0.0) / full_kg.max(1.0);
        let (mut weight_kg, mut inertia_kg) = ([0.0; MAX_CARS], [0.0; MAX_CARS]);
        for (i, car) in self.data.cars.iter().enumerate() {
            weight_kg[i] = car.weight_kg(share);
            inertia_kg[i] = weight_kg[i] + car.rotating_kg;
            self.service_n[i] = inertia_kg[i] * self.data.service_brake.kmh_per_s / 3.6;
            self.emergency_n[i] = inertia_kg[i] * self.data.emergency_brake.kmh_per_s / 3.6;
        }
        self.weight_kg = weight_kg.iter().sum();
        self.resistance.weigh(&weight_kg);
        self.wheels.weigh(&weight_kg);
    }
}

fn emergency_times(data: &CarsData) -> Times {
    Times {
        dead_s: data.emergency_brake.dead_time_s,
        rise_s: data.emergency_brake.build_up_s,
        fall_s: data.emergency_brake.release_s,
    }
}
