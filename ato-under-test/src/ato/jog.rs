//! Jogging: a train that stands away from its stop point inches there, forward after a short stop and backward
//! after an overrun.
//!
//! A try begins and ends at standstill. The direction is told to TCMS while the train is still held, then the
//! train goes at `kmh` at most and brakes to the stop point. It is over when the train is aligned; when the
//! tries are used up, or the stop point is too far to jog to, the train stays where it stands, and the wayside
//! or the driver decides. Whatever controller drives the run, this law jogs: speed by the distance left, with
//! a proportional correction.

use protocol::CYCLE;
use protocol::config::JogConfig;

use super::controller::Demand;
use super::profile::Setpoint;

/// Cycles at rest before a try: the brakes have settled, and the tachometers have been silent.
const REST_CYCLES: u32 = 20;
/// Cycles from the direction's order until the train is powered: TCMS has it, and ATP has permitted it.
const TURN_CYCLES: u32 = 16;
/// Cycles after which a train that was powered and has not moved ends its try.
const PATIENCE_CYCLES: u32 = 120;
/// Cycles after which a try is braked to its end: the train has had time for the longest way twice [default].
const LONGEST_CYCLES: u32 = 500;
/// Acceleration that is asked for at least until the train moves, m/s²: the holding brake goes by motor current (S4).
const START_MPS2: f64 = 0.15;
/// Speed that is asked for until the train moves, m/s.
const START_MPS: f64 = 0.15;
/// Correction by speed error, 1/s.
const GAIN_PER_S: f64 = 1.5;
/// Distance to the stop point within which the deceleration stays as it is, m: speed² over twice the distance is
/// undefined at 0.
const HOLD_M: f64 = 0.05;

/// Inputs of jogging in a cycle.
#[derive(Clone, Copy, Debug)]
pub struct JogInputs {
    /// ATO drives.
    pub drives: bool,
    pub stands: bool,
    /// Neither limit nor order nor brake keeps the train standing.
    pub may_go: bool,
    /// Distance to the stop point, m, negative past it; `None` = not known.
    pub to_stop_m: Option<f64>,
    /// Distance from the stop point that counts as aligned, m.
    pub aligned_m: f64,
    /// The section's last marker was seen, so that not the wheels alone show an overrun.
    pub last_marker: bool,
    pub jogs: bool,
}

/// Result of a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JogOutcome {
    /// The run is over: aligned, or given up.
    pub ended: bool,
    /// A try begins: way to go, m, backward negative.
    pub begun_m: Option<f64>,
    /// Jogging was given up: distance to the stop point, m.
    pub failed_m: Option<f64>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Phase {
    /// The run's own controller drives.
    #[default]
    Idle,
    /// The train is held before a try: cycles so far.
    Rests(u32),
    /// The train is held with the direction ordered: cycles so far.
    Turns(u32),
    /// The train is powered: cycles so far, and whether it has moved.
    Goes(u32, bool),
}

/// Jogging of one stop.
#[derive(Clone, Debug, Default)]
pub struct Jog {
    phase: Phase,
    tries: u8,
    backward: bool,
    /// Jogging has given the stop point up.
    pub gave_up: bool,
    may_go: bool,
    brakes: bool,
    setpoint: Setpoint,
}

impl Jog {
    pub fn step(&mut self, inputs: &JogInputs, config: &JogConfig) -> JogOutcome {
        let Some(to_stop_m) = inputs.to_stop_m.filter(|m| inputs.drives && m.is_finite()) else {
            *self = Self::default();
            return JogOutcome::default();
        };
        self.may_go = inputs.may_go;
        if let Phase::Goes(cycles, moved) = self.phase {
            let moved = moved || !inputs.stands;
            self.brakes |= cycles > LONGEST_CYCLES;
            let over = inputs.stands && (moved || cycles > PATIENCE_CYCLES);
            self.phase = match over {
                true => Phase::Rests(0),
                false => Phase::Goes(cycles + 1, moved),
            };
            return JogOutcome::default();
        }
        if !inputs.stands {
            // The train was pushed while held: the rest begins again.
            if self.phase != Phase::Idle {
                self.phase = Phase::Rests(0);
            }
            return JogOutcome::default();
        }
        self.stand(to_stop_m, inputs, config)
    }

    /// A cycle of a train that stands, and is not powered.
    fn stand(&mut self, to_stop_m: f64, inputs: &JogInputs, config: &JogConfig) -> JogOutcome {
        let distance_m = libm::fabs(to_stop_m);
        if distance_m <= inputs.aligned_m {
            self.phase = Phase::Idle;
            return JogOutcome {
                ended: true,
                ..JogOutcome::default()
            };
        }
        let short = to_stop_m > 0.0;
        let near = distance_m <= config.max_m && inputs.jogs;
        if short && distance_m > config.max_m {
            // The run's own controller drives to the stop point.
            self.phase = Phase::Idle;
            return JogOutcome::default();
        }
        let rested = matches!(self.phase, Phase::Rests(cycles) if cycles >= REST_CYCLES);
        let spent = rested && self.tries >= config.tries;
        // Only the wheels show an overrun: the place of the stop point is unknown, and the missing marker
        // is reported.
        let unproved = !short && !inputs.last_marker;
        if !near || spent || unproved {
            self.phase = Phase::Rests(0);
            self.gave_up = true;
            return JogOutcome {
                ended: true,
                failed_m: (!unproved).then_some(to_stop_m),
                begun_m: None,
            };
        }
        self.phase = match self.phase {
            Phase::Rests(cycles) if cycles < REST_CYCLES => Phase::Rests(cycles + 1),
            Phase::Rests(_) if inputs.may_go => {
                self.backward = !short;
                Phase::Turns(0)
            }
            Phase::Turns(_) if self.backward == short => Phase::Rests(0),
            Phase::Turns(cycles) if cycles < TURN_CYCLES => Phase::Turns(cycles + 1),
            // A refused try counts, so that jogging ends.
            Phase::Turns(_) if !inputs.may_go => {
                self.tries += 1;
                Phase::Rests(0)
            }
            Phase::Turns(_) => {
                self.tries += 1;
                self.brakes = false;
                self.setpoint = Setpoint::default();
                self.phase = Phase::Goes(0, false);
                return JogOutcome {
                    begun_m: Some(to_stop_m),
                    ..JogOutcome::default()
                };
            }
            Phase::Rests(cycles) => Phase::Rests(cycles),
            Phase::Idle | Phase::Goes(..) => Phase::Rests(0),
        };
        JogOutcome::default()
    }

    /// Jogging drives the train; the run's controller does not.
    pub fn acts(&self) -> bool {
        self.phase != Phase::Idle
    }

    /// Ordered direction, from before the train is powered until it stands again: backward or not.
    pub fn direction(&self) -> Option<bool> {
        matches!(self.phase, Phase::Turns(_) | Phase::Goes(..)).then_some(self.backward)
    }

    pub fn backward(&self) -> bool {
        self.direction() == Some(true)
    }

    /// A try has begun in this cycle.
    pub fn begins(&self) -> bool {
        self.phase == Phase::Goes(0, false)
    }

    /// Acceleration that is asked for at least, whatever the track costs, m/s².
    pub fn least_mps2(&self) -> Option<f64> {
        (matches!(self.phase, Phase::Goes(_, false)) && self.may_go).then_some(START_MPS2)
    }

    /// Demand with `left_m` to go at `speed_mps`, both in the direction of the jog.
    pub fn demand(
        &mut self,
        left_m: f64,
        speed_mps: f64,
        mass_kg: f64,
        jerk_mps3: f64,
        config: &JogConfig,
    ) -> Demand {
        if !matches!(self.phase, Phase::Goes(..)) {
            self.setpoint = Setpoint::default();
            return Demand {
                target_mps: 0.0,
                force_n: -config.accel_mps2 * mass_kg,
            };
        }
        if matches!(self.phase, Phase::Goes(_, false)) && self.may_go {
            // The holding brake releases late: a setpoint that ran ahead would be at its end before the train moves.
            self.setpoint = Setpoint {
                speed_mps: START_MPS,
                accel_mps2: config.accel_mps2,
            };
        } else {
            self.advance(left_m, jerk_mps3, config);
        }
        let Setpoint {
            speed_mps: target_mps,
            accel_mps2,
        } = self.setpoint;
        let ends = self.brakes && target_mps <= 0.0;
        let asked_mps2 = match ends {
            true => -config.accel_mps2 - GAIN_PER_S * speed_mps,
            false => accel_mps2 + GAIN_PER_S * (target_mps - speed_mps),
        };
        Demand {
            target_mps,
            force_n: asked_mps2 * mass_kg,
        }
    }

    /// Moves the setpoint on by a cycle.
    fn advance(&mut self, left_m: f64, jerk_mps3: f64, config: &JogConfig) {
        let dt = CYCLE.as_secs();
        let Setpoint {
            speed_mps,
            accel_mps2,
        } = self.setpoint;
        let rate = config.accel_mps2;
        // While the rate is built up at the jerk limit, the speed counts as unchanged for half of that
        // time.
        let turns_s = (accel_mps2.max(0.0) + rate) / jerk_mps3;
        let braking_m = speed_mps * speed_mps / (2.0 * rate) + speed_mps * turns_s / 2.0;
        self.brakes |= !self.may_go || left_m <= braking_m;
        let wanted = if !self.brakes {
            let most_mps = config.kmh / 3.6;
            // The acceleration that the jerk limit takes away by the time the speed is reached.
            let rises = libm::sqrt(2.0 * jerk_mps3 * (most_mps - speed_mps).max(0.0));
            rate.min(rises)
        } else if left_m > HOLD_M {
            // At most twice the rate: more gains nothing in the last decimetre.
            -(speed_mps * speed_mps / (2.0 * left_m)).clamp(0.5 * rate, 2.0 * rate)
        } else {
            accel_mps2.min(-rate)
        };
        let step = jerk_mps3 * dt;
        let accel_mps2 = accel_mps2 + (wanted - accel_mps2).clamp(-step, step);
        self.setpoint = Setpoint {
            speed_mps: (speed_mps + accel_mps2 * dt).max(0.0),
            accel_mps2,
        };
    }
}

#[cfg(test)]
mod tests;
