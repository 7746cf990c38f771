//! Effort of the train: the ordered share with limited jerk, then demands on each car.

use crate::train::{Actuators, CarSet, Equipment, MAX_CARS, PerCar};

use super::braking::{BrakingInputs, braking};
use super::consist::Consist;
use super::powering::powering;

/// What effort is ordered in one scan.
#[derive(Clone, Copy, Debug)]
pub struct Order {
    /// Share of full effort, −1 full service .. 1 full power.
    pub share: f64,
    /// Holding brake.
    pub holding: bool,
    /// Emergency or security brake: no effort of the inverters (S3).
    pub no_inverters: bool,
    /// Speed, m/s, a size.
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
    /// Braking effort wanted of the whole train, a size.
    pub brake_n: f64,
}

/// The sharing out of effort.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Cars and their load.
    pub consist: Consist,
    /// Effort asked for, as acceleration: jerk limited.
    effort_mps2: f64,
    /// The same of the holding brake.
    held_mps2: f64,
    /// What inverters should be giving by now.
    expected: Actuators,
}

impl Effort {
    /// None yet.
    pub fn new(consist: Consist) -> Self {
        Self {
            expected: Actuators::new(consist.data.motor_times()),
            effort_mps2: 0.0,
            held_mps2: 0.0,
            consist,
        }
    }

    /// Asks for nothing.
    pub fn reset(&mut self) {
        self.effort_mps2 = 0.0;
        self.held_mps2 = 0.0;
        self.expected.reset();
    }

    /// Traction there is at a speed with the present load, N.
    pub fn power_n(&self, speed_mps: f64) -> f64 {
        powering(&self.consist, 1.0, speed_mps, CarSet::NONE)
            .iter()
            .sum()
    }

    /// One scan's demands. Without equipment, inverters give what they are asked for.
    pub fn step(&mut self, dt_s: f64, order: &Order, equipment: Option<&Equipment>) -> Demands {
        self.limit_jerk(dt_s, order);
        let mut demands = Demands::default();
        let brake_mps2 = (-self.effort_mps2).max(self.held_mps2);
        if self.effort_mps2 > 0.0 {
            let share = self.effort_mps2 / self.consist.power_mps2();
            demands.motor_n = powering(&self.consist, share, order.speed_mps, order.inverters_out);
        }
        if brake_mps2 > 0.0 {
            let cut_out = equipment.map_or(CarSet::NONE, |e| e.regeneration_cut_out);
            let powers = self.effort_mps2 > 0.0 || order.no_inverters;
            let no_electric = if powers { self.consist.motors } else { cut_out };
            let lost_n = self.lost(equipment);
            let brakes = braking(
                &self.consist,
                &BrakingInputs {
                    share: brake_mps2 / self.consist.service_mps2(),
                    speed_mps: order.speed_mps,
                    no_electric: no_electric.with(order.inverters_out),
                    no_air: order.brakes_out,
                    lost_n: &lost_n,
                },
            );
            demands.air_n = brakes.air_n;
            demands.brake_n = brakes.train_n;
            for (motor, electric) in demands.motor_n.iter_mut().zip(&brakes.electric_n) {
                *motor -= electric;
            }
        }
        self.expected.step(dt_s, &demands.motor_n);
        demands
    }

    /// Lets the effort asked for go to the ordered one.
    fn limit_jerk(&mut self, dt_s: f64, order: &Order) {
        let full = if order.share < 0.0 {
            self.consist.service_mps2()
        } else {
            self.consist.power_mps2()
        };
        // The emergency brake's contacts take power off without a ramp.
        if order.no_inverters {
            self.effort_mps2 = self.effort_mps2.min(0.0);
        }
        let step = self.consist.data.traction.jerk_mps3 * dt_s;
        let change = order.share * full - self.effort_mps2;
        self.effort_mps2 += change.clamp(-step, step);
        if order.holding {
            let held = self.consist.data.service_brake.holding_share * self.consist.service_mps2();
            self.held_mps2 = self.held_mps2.max(-self.effort_mps2).min(held);
            self.held_mps2 += (held - self.held_mps2).clamp(0.0, step);
        } else {
            self.held_mps2 = 0.0;
        }
    }

    /// Electric brake that should be there and is not, N (S3 eq. 8: DBE1 − EFM, less what is only on
    /// its way).
    fn lost(&self, equipment: Option<&Equipment>) -> PerCar {
        let expected = self.expected.effort_n();
        equipment.map_or([0.0; MAX_CARS], |equipment| {
            std::array::from_fn(|i| (-expected[i] - equipment.electric_n[i]).max(0.0))
        })
    }
}
