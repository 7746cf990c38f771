//! Adhesion: forces that the rails carry, slip and slide of each car, and the protection against them.
//!
//! While a car holds, its rotating parts move with the train. When it is asked for more than
//! adhesion carries it breaks away: the rails carry sliding friction, the rest turns the wheels away
//! from the train's speed until the protection has taken enough effort off them.

use super::data::Wheels;
use super::{MAX_CARS, PerCar};

/// Acceleration of gravity, m/s².
const GRAVITY_MPS2: f64 = 9.80665;

/// Effort at the wheels of each car.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Efforts {
    /// Traction, N, without a sign.
    pub traction_n: PerCar,
    /// Electric brake, N, without a sign.
    pub electric_n: PerCar,
    /// Air brake, N, without a sign.
    pub air_n: PerCar,
}

/// The train's motion that decides on slip and slide.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrainMotion {
    /// Train's speed, m/s, forward positive.
    pub velocity_mps: f64,
    /// Acceleration in the step before, m/s².
    pub accel_mps2: f64,
    /// Traction pulls forward 1 or backward −1.
    pub reverser: f64,
    /// Adhesion coefficient at this speed.
    pub adhesion: f64,
}

/// Efforts that the rails carry in one step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rails {
    /// Traction, N, without a sign.
    pub traction_n: f64,
    /// Electric brake, N, without a sign.
    pub electric_n: f64,
    /// Air brake, N, without a sign.
    pub air_n: f64,
    /// Mass accelerated, kg: wheels that slip or slide do not belong to it.
    pub inertia_kg: f64,
}

#[derive(Clone, Debug)]
pub(super) struct WheelSets {
    data: Wheels,
    rotating_kg: PerCar,
    weight_n: PerCar,
    inertia_kg: f64,
    /// A car slips or slides, or is still kept below its effort.
    pub disturbed: bool,
    breaks_away: [bool; MAX_CARS],
    /// Speed of the rims of cars that slip or slide, m/s, forward positive.
    rim_mps: PerCar,
    /// Share of effort the protection leaves.
    left: PerCar,
    /// Torque balance of cars that slip or slide, N: drive, brake, friction of the rail.
    drive_n: PerCar,
    brake_n: PerCar,
    friction_n: PerCar,
}

impl WheelSets {
    pub fn new(data: &Wheels, rotating_kg: PerCar) -> Self {
        Self {
            data: data.clone(),
            rotating_kg,
            weight_n: [0.0; MAX_CARS],
            inertia_kg: 0.0,
            disturbed: false,
            breaks_away: [false; MAX_CARS],
            rim_mps: [0.0; MAX_CARS],
            left: [1.0; MAX_CARS],
            drive_n: [0.0; MAX_CARS],
            brake_n: [0.0; MAX_CARS],
            friction_n: [0.0; MAX_CARS],
        }
    }

    /// Takes the weight of each car.
    pub fn weigh(&mut self, weight_kg: &PerCar) {
        self.weight_n = weight_kg.map(|kg| kg * GRAVITY_MPS2);
        let rotating: f64 = self.rotating_kg.iter().sum();
        self.inertia_kg = weight_kg.iter().sum::<f64>() + rotating;
    }

    /// All wheels roll with the train and the protection rests.
    pub fn reset(&mut self) {
        self.breaks_away = [false; MAX_CARS];
        self.left = [1.0; MAX_CARS];
        self.disturbed = false;
    }

    /// A car slips or slides.
    pub fn sliding(&self) -> bool {
        self.disturbed && self.breaks_away.contains(&true)
    }

    /// Speed of a car's rims if it slips or slides.
    pub fn rim_mps(&self, car: usize) -> Option<f64> {
        self.breaks_away[car].then(|| self.rim_mps[car])
    }

    /// Share of a car's effort the protection leaves.
    pub fn left(&self, car: usize) -> f64 {
        self.left[car]
    }

    /// Brake force with which rails hold a standing train, N.
    pub fn hold_n(&self, efforts: &Efforts, adhesion: f64) -> f64 {
        (0..MAX_CARS)
            .map(|i| {
                let brake_n = efforts.electric_n[i] + efforts.air_n[i];
                brake_n.min(adhesion * self.weight_n[i])
            })
            .sum()
    }

    /// The part of the efforts that the rails carry.
    pub fn grip(&mut self, efforts: &Efforts, rolling: TrainMotion) -> Rails {
        if self.disturbed || self.exceeds(efforts, rolling) {
            return self.grip_each(efforts, rolling);
        }
        Rails {
            traction_n: sum(&efforts.traction_n),
            electric_n: sum(&efforts.electric_n),
            air_n: sum(&efforts.air_n),
            inertia_kg: self.inertia_kg,
        }
    }

    /// Some car is asked for more than its rails carry.
    fn exceeds(&self, efforts: &Efforts, rolling: TrainMotion) -> bool {
        let against = direction(rolling.velocity_mps);
        let mut exceeds = false;
        for i in 0..MAX_CARS {
            let brake_n = efforts.electric_n[i] + efforts.air_n[i];
            let rim_n = rolling.reverser * efforts.traction_n[i] - against * brake_n;
            let rail_n = rim_n - self.rotating_kg[i] * rolling.accel_mps2;
            exceeds |= rail_n.abs() > rolling.adhesion * self.weight_n[i];
        }
        exceeds
    }

    /// [`Self::grip`] with each car's wheels on their own.
    #[cold]
    fn grip_each(&mut self, efforts: &Efforts, rolling: TrainMotion) -> Rails {
        let against = direction(rolling.velocity_mps);
        let mut rails = Rails {
            inertia_kg: self.inertia_kg,
            ..Rails::default()
        };
        for i in 0..MAX_CARS {
            let traction_n = self.left[i] * efforts.traction_n[i];
            let electric_n = self.left[i] * efforts.electric_n[i];
            let air_n = self.left[i] * efforts.air_n[i];
            let (drive_n, brake_n) = (rolling.reverser * traction_n, electric_n + air_n);
            let limit_n = rolling.adhesion * self.weight_n[i];
            let rail_n = drive_n - against * brake_n - self.rotating_kg[i] * rolling.accel_mps2;
            if !self.breaks_away[i] {
                if rail_n.abs() <= limit_n {
                    rails.traction_n += traction_n;
                    rails.electric_n += electric_n;
                    rails.air_n += air_n;
                    continue;
                }
                self.breaks_away[i] = true;
                self.rim_mps[i] = rolling.velocity_mps;
            }
            rails.inertia_kg -= self.rotating_kg[i];
            let slip_mps = self.rim_mps[i] - rolling.velocity_mps;
            let sense = if slip_mps == 0.0 { rail_n } else { slip_mps };
            let friction_n = self.data.sliding_share * limit_n * direction(sense);
            // Friction counts for the effort that turns the wheel away from the train: of two brakes for the greater.
            if friction_n * rolling.reverser > 0.0 {
                rails.traction_n += friction_n.abs();
            } else if electric_n > air_n {
                rails.electric_n += friction_n.abs();
            } else {
                rails.air_n += friction_n.abs();
            }
            (self.drive_n[i], self.brake_n[i], self.friction_n[i]) = (drive_n, brake_n, friction_n);
        }
        self.disturbed = true;
        rails
    }

    /// Turns the wheels that slip or slide through a step that ended at this speed of the train. The protection takes
    /// effort off them, or gives effort back.
    pub fn turn(&mut self, dt_s: f64, before_mps: f64, velocity_mps: f64) {
        if !self.disturbed {
            return;
        }
        for i in 0..MAX_CARS {
            if self.breaks_away[i] {
                self.turn_car(i, dt_s, before_mps, velocity_mps);
            }
            let slip_mps = (self.rim_mps[i] - velocity_mps).abs();
            let takes_off = self.breaks_away[i] && slip_mps > self.data.protection_mps;
            let change = if takes_off {
                -dt_s / self.data.release_s
            } else {
                dt_s / self.data.restore_s
            };
            self.left[i] = (self.left[i] + change).clamp(0.0, 1.0);
        }
        self.disturbed = self.breaks_away.contains(&true) || self.left.iter().any(|&l| l < 1.0);
    }

    fn turn_car(&mut self, i: usize, dt_s: f64, before_mps: f64, velocity_mps: f64) {
        let rim = self.rim_mps[i];
        let gain = dt_s / self.rotating_kg[i].max(1.0);
        let free = rim + (self.drive_n[i] - self.friction_n[i]) * gain;
        // A brake slows the wheel down and never turns it the other way.
        let braked = self.brake_n[i] * gain;
        let turned = free - free.clamp(-braked, braked);
        let slip_before = rim - before_mps;
        let slip = turned - velocity_mps;
        self.rim_mps[i] = turned;
        // The rim has come back to the train's speed, or the train has stopped with it.
        if slip * slip_before < 0.0 || slip == 0.0 || velocity_mps == 0.0 && turned == 0.0 {
            self.breaks_away[i] = false;
        }
    }
}

/// Adhesion at a speed over adhesion at standstill [Curtius and Kniffler 1944:
/// 0.161 + 7.5/(44 + V), V in km/h].
pub(super) fn adhesion_share(speed_mps: f64) -> f64 {
    (0.161 + 7.5 / (44.0 + 3.6 * speed_mps)) / (0.161 + 7.5 / 44.0)
}

/// 1, −1 or 0.
pub(super) fn direction(value: f64) -> f64 {
    if value > 0.0 {
        1.0
    } else if value < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// Sum of all cars, in pairs so that additions do not wait for each other.
fn sum(of: &PerCar) -> f64 {
    let (one, two, three) = (&of[0..4], &of[4..8], &of[8..12]);
    let quarter = |i: usize| one[i] + two[i] + three[i];
    (quarter(0) + quarter(1)) + (quarter(2) + quarter(3))
}
