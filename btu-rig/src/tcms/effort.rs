//! Effort of the train: the ordered share with limited jerk, then demands on each car.

use crate::train::{Actuators, CarSet, Equipment, PerCar};

use super::braking::{self, BrakingInputs, Inverters, Sharing};
use super::consist::Consist;
use super::powering::{self, powering};

/// Deceleration below which air no longer holds a train back that departs, m/s² [default].
const RELEASED_MPS2: f64 = 0.02;

/// Time constants after which air that is no longer asked for has gone, to 1 part in 20 000.
const SETTLED: f64 = 10.0;

/// Ordered effort in one scan.
#[derive(Clone, Copy, Debug)]
pub struct Order {
    /// Share of full effort, −1 full service .. 1 full power.
    pub share: f64,
    /// Holding brake.
    pub holding: bool,
    /// Emergency or security brake: no effort of the inverters (S3).
    pub no_inverters: bool,
    /// Powering is cut: traction goes at once, not by the jerk limit (S3, S4).
    pub power_cut: bool,
    /// Speed, m/s, never negative.
    pub speed_mps: f64,
    /// Inverters that are cut out or failed.
    pub inverters_out: CarSet,
    /// Brakes that are cut out or failed.
    pub brakes_out: CarSet,
}

/// Demands on the train's cars, N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Demands {
    /// Inverters: powering above 0, electric brake below.
    pub motor_n: PerCar,
    /// Air brakes.
    pub air_n: PerCar,
    /// Braking effort asked of the whole train, N, never negative.
    pub brake_n: f64,
}

/// Turns the ordered effort into demands on the cars, scan by scan.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Cars and their load.
    pub consist: Consist,
    /// Effort asked for, as acceleration: jerk limited.
    effort_mps2: f64,
    /// Effort of the holding brake, as acceleration: jerk limited.
    held_mps2: f64,
    /// The holding brake was on, and its air has not gone yet.
    departs: bool,
    /// Efforts that inverters should give by now, powering above 0.
    motors_due: Actuators,
    /// Pressure that cylinders should hold by now.
    air_due: Actuators,
    /// Time since air was last asked for, s.
    air_rests_s: f64,
    /// Time by which air answers later than inverters, s.
    air_later_s: f64,
    sharing: Sharing,
    shared_for: SharingInputs,
}

/// Inputs for which the sharing was worked out.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SharingInputs {
    load_kg: f64,
    no_electric: CarSet,
    no_air: CarSet,
}

impl Effort {
    pub fn new(consist: Consist) -> Self {
        let (motors, air) = (consist.data.motor_times(), consist.data.air_times());
        Self {
            motors_due: Actuators::new(motors),
            air_due: Actuators::new(air),
            air_rests_s: 0.0,
            air_later_s: (air.dead_s + air.rise_s - motors.dead_s - motors.rise_s).max(0.0),
            effort_mps2: 0.0,
            held_mps2: 0.0,
            departs: false,
            sharing: Sharing::new(&consist, CarSet::NONE, CarSet::NONE),
            shared_for: SharingInputs {
                load_kg: consist.load_kg,
                no_electric: CarSet::NONE,
                no_air: CarSet::NONE,
            },
            consist,
        }
    }

    /// Starts again without any effort.
    pub fn reset(&mut self) {
        self.effort_mps2 = 0.0;
        self.held_mps2 = 0.0;
        self.departs = false;
        self.motors_due.reset();
        self.air_due.reset();
    }

    /// Traction available at a speed with the present load, N.
    pub fn power_n(&self, speed_mps: f64) -> f64 {
        let most_n: f64 = self.consist.power_n.iter().sum();
        most_n * powering::pattern(&self.consist, speed_mps)
    }

    /// Force that each car's air brake should have by now, N, from past demands and its response times.
    pub fn air_due_n(&self) -> &PerCar {
        &self.air_due.effort_n
    }

    /// One scan's demands. Without equipment, inverters give what they are asked for.
    pub fn step(&mut self, dt_s: f64, order: &Order, equipment: Option<&Equipment>) -> Demands {
        self.limit_jerk(dt_s, order, equipment);
        let mut demands = Demands::default();
        let brake_mps2 = (-self.effort_mps2).max(self.held_mps2);
        if self.effort_mps2 > 0.0 {
            let share = self.effort_mps2 / self.consist.power_mps2;
            demands.motor_n = powering(&self.consist, share, order.speed_mps, order.inverters_out);
        }
        if brake_mps2 > 0.0 {
            self.brake(brake_mps2, order, equipment, &mut demands);
        }
        self.motors_due.step(dt_s, &demands.motor_n);
        self.expect_air(dt_s, brake_mps2 > 0.0, &demands.air_n);
        demands
    }

    /// Works out the pressure that cylinders should hold; there is nothing to work out once they
    /// have long been empty.
    fn expect_air(&mut self, dt_s: f64, asked: bool, air_n: &PerCar) {
        let service = &self.consist.data.service_brake;
        let settled_s = service.dead_time_s + SETTLED * service.release_s;
        if asked {
            self.air_rests_s = 0.0;
        } else if self.air_rests_s > settled_s {
            return;
        }
        self.air_rests_s += dt_s;
        self.air_due.step(dt_s, air_n);
        if self.air_rests_s > settled_s {
            self.air_due.reset();
        }
    }

    fn brake(
        &mut self,
        brake_mps2: f64,
        order: &Order,
        equipment: Option<&Equipment>,
        demands: &mut Demands,
    ) {
        let cut_out = equipment.map_or(CarSet::NONE, |e| e.regeneration_cut_out);
        let powers = self.effort_mps2 > 0.0 || order.no_inverters;
        let no_electric = if powers { self.consist.motors } else { cut_out };
        self.share_between(no_electric.with(order.inverters_out), order.brakes_out);
        // Speed when air arrives: it falls by the braking; gradients and resistance change little in this time.
        let ahead_mps = order.speed_mps - brake_mps2 * self.air_later_s;
        let brakes = self.sharing.braking(&BrakingInputs {
            share: brake_mps2 / self.consist.service_mps2,
            pattern: braking::pattern(&self.consist, order.speed_mps),
            pattern_ahead: braking::pattern(&self.consist, ahead_mps),
            // S3 eq. 8: DBE1 − EFM, without the effort that is only delayed.
            inverters: equipment.map(|equipment| Inverters {
                due_n: &self.motors_due.effort_n,
                electric_n: &equipment.electric_n,
            }),
        });
        demands.air_n = brakes.air_n;
        demands.brake_n = brakes.train_n;
        for (motor, electric) in demands.motor_n.iter_mut().zip(&brakes.electric_n) {
            *motor -= electric;
        }
    }

    /// Recalculates the shares when load or cut-outs have changed.
    fn share_between(&mut self, no_electric: CarSet, no_air: CarSet) {
        let wanted = SharingInputs {
            load_kg: self.consist.load_kg,
            no_electric,
            no_air,
        };
        if wanted != self.shared_for {
            self.sharing = Sharing::new(&self.consist, no_electric, no_air);
            self.shared_for = wanted;
        }
    }

    /// Moves the effort asked for toward the ordered one by the jerk limit.
    fn limit_jerk(&mut self, dt_s: f64, order: &Order, equipment: Option<&Equipment>) {
        // An order that is not a number is not trusted: full service.
        let share = if order.share.is_nan() {
            -1.0
        } else {
            order.share.clamp(-1.0, 1.0)
        };
        let full = if share < 0.0 {
            self.consist.service_mps2
        } else {
            self.consist.power_mps2
        };
        // A cut of powering, by the emergency brake's contacts too, takes traction off without a ramp; only brakes then
        // build up by the jerk limit.
        if order.no_inverters || order.power_cut {
            self.effort_mps2 = self.effort_mps2.min(0.0);
        }
        let step = self.consist.data.traction.jerk_mps3 * dt_s;
        let change = share * full - self.effort_mps2;
        let rise = self.rise_at_departure(step, dt_s, order.holding, equipment);
        self.effort_mps2 += change.clamp(-step, rise);
        if order.holding {
            let held = self.consist.data.service_brake.holding_share * self.consist.service_mps2;
            self.held_mps2 = self.held_mps2.max(-self.effort_mps2).min(held);
            self.held_mps2 += (held - self.held_mps2).clamp(0.0, step);
        } else {
            self.held_mps2 = 0.0;
        }
    }

    /// Greatest rise of effort in a scan, m/s²: while the holding brake's air goes out under traction, its fall uses up
    /// a part of the jerk limit.
    fn rise_at_departure(
        &mut self,
        step: f64,
        dt_s: f64,
        holding: bool,
        equipment: Option<&Equipment>,
    ) -> f64 {
        if holding {
            self.departs = true;
            return step;
        }
        if !self.departs {
            return step;
        }
        let inertia_kg: f64 = self.consist.pairs.iter().map(|pair| pair.inertia_kg).sum();
        let air_n: f64 = equipment.map_or(0.0, |equipment| equipment.air_n.iter().sum());
        let air_mps2 = air_n / inertia_kg;
        self.departs = air_mps2 > RELEASED_MPS2 && self.effort_mps2 >= 0.0;
        if self.departs {
            let falls = air_mps2 / self.consist.data.service_brake.release_s.max(dt_s);
            (step - falls * dt_s).max(0.0)
        } else {
            step
        }
    }
}
