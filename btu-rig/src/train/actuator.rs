//! Effort that follows its demand: dead time, then a first-order lag.

use super::{MAX_CARS, PerCar};
use crate::conditions::MAX_DELAY_FACTOR;

/// Longest dead time or time constant, s.
pub(super) const MAX_TIME_S: f64 = 5.0;
/// Longest dead time that a checked train on a checked day can have, s: bounds the number of demands that are kept.
const MAX_DEAD_S: f64 = MAX_TIME_S * MAX_DELAY_FACTOR;

/// Times of an actuator, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Times {
    /// Time before the effort begins to follow its demand.
    pub dead_s: f64,
    /// Time constant while effort rises.
    pub rise_s: f64,
    /// Time constant while it falls.
    pub fall_s: f64,
}

impl Times {
    /// All of them longer by a factor.
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            dead_s: self.dead_s * factor,
            rise_s: self.rise_s * factor,
            fall_s: self.fall_s * factor,
        }
    }
}

/// The actuators of one kind, one on each car.
#[derive(Clone, Debug)]
pub(crate) struct Actuators {
    times: Times,
    dt_s: f64,
    rise: f64,
    fall: f64,
    /// Demands on their way, oldest at `next`.
    line: Vec<PerCar>,
    next: usize,
    /// Effort at the end of the last step.
    pub effort_n: PerCar,
}

impl Actuators {
    pub fn new(times: Times) -> Self {
        Self {
            times,
            dt_s: 0.0,
            rise: 1.0,
            fall: 1.0,
            line: Vec::new(),
            next: 0,
            effort_n: [0.0; MAX_CARS],
        }
    }

    /// Changes the times from now on; demands on their way are lost if the dead time changes.
    pub fn set_times(&mut self, times: Times) {
        self.times = times;
        self.tune(self.dt_s);
    }

    /// No effort, and none on its way.
    pub fn reset(&mut self) {
        self.line.fill([0.0; MAX_CARS]);
        self.effort_n = [0.0; MAX_CARS];
    }

    /// One step toward the demand of a dead time ago.
    pub fn step(&mut self, dt_s: f64, demand_n: &PerCar) -> &PerCar {
        if dt_s != self.dt_s {
            self.tune(dt_s);
        }
        let (rise, fall) = (self.rise, self.fall);
        let follow = |effort: &mut f64, due: f64| {
            let change = due - *effort;
            *effort += change * if change > 0.0 { rise } else { fall };
        };
        if let Some(place) = self.line.get_mut(self.next) {
            let due_n = *place;
            *place = *demand_n;
            for (effort, due) in self.effort_n.iter_mut().zip(due_n) {
                follow(effort, due);
            }
            self.next += 1;
            if self.next == self.line.len() {
                self.next = 0;
            }
        } else {
            for (effort, demand) in self.effort_n.iter_mut().zip(demand_n) {
                follow(effort, *demand);
            }
        }
        &self.effort_n
    }

    fn tune(&mut self, dt_s: f64) {
        self.dt_s = dt_s;
        self.rise = share_per_step(dt_s, self.times.rise_s);
        self.fall = share_per_step(dt_s, self.times.fall_s);
        let steps = if dt_s > 0.0 {
            (self.times.dead_s.min(MAX_DEAD_S) / dt_s).round() as usize
        } else {
            0
        };
        if steps != self.line.len() {
            self.line = vec![self.effort_n; steps];
            self.next = 0;
        }
    }
}

/// Share of a difference that a first-order lag makes up for in one step: 1 − e^(−dt/τ) to the
/// second order, without the exponential.
pub(super) fn share_per_step(dt_s: f64, lag_s: f64) -> f64 {
    if lag_s > 0.0 {
        (dt_s / (lag_s + 0.5 * dt_s)).min(1.0)
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 0.005;

    /// A jump of demand: nothing for the dead time, 63.2 % a time constant later, and the fall
    /// takes its own time.
    #[test]
    fn dead_time_then_lag_each_way() {
        let times = Times {
            dead_s: 0.2,
            rise_s: 0.4,
            fall_s: 0.8,
        };
        let mut actuators = Actuators::new(times);
        let mut after = |seconds: f64, demand: f64| {
            let steps = (seconds / DT).round() as usize;
            (0..steps).fold(0.0, |_, _| actuators.step(DT, &[demand; MAX_CARS])[3])
        };
        assert_eq!(after(0.2, 100.0), 0.0);
        let built = after(0.4, 100.0);
        assert!((built - 63.2).abs() < 0.1, "{built}");
        assert!((after(8.0, 100.0) - 100.0).abs() < 1e-3);
        let released = after(1.0, 0.0);
        assert!((released - 36.8).abs() < 0.1, "{released}");
    }

    /// The longest dead time the checks admit, on the slowest day they admit, is kept whole.
    #[test]
    fn the_longest_dead_time_is_not_cut() {
        let longest = Times {
            dead_s: MAX_TIME_S,
            rise_s: 0.0,
            fall_s: 0.0,
        };
        let mut actuators = Actuators::new(longest.scaled(MAX_DELAY_FACTOR));
        let steps = (MAX_TIME_S * MAX_DELAY_FACTOR / DT).round() as usize;
        let moved = (0..steps + 9).position(|_| actuators.step(DT, &[1.0; MAX_CARS])[0] > 0.0);
        assert_eq!(moved, Some(steps));
    }
}
