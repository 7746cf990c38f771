//! Speed over time from one speed to another under an acceleration and a jerk limit [S1 eq. 2-4].
//!
//! Terms: *ramp* = the change from one speed to another in three phases: jerk to the peak acceleration,
//! constant acceleration, jerk back to none; *peak* = the greatest acceleration of a ramp.
//!
//! The printed formulas begin at standstill and hold for changes of at least `a_L²/J`. Here each
//! step plans the rest of the ramp from the speed and the acceleration it stands at, so that
//! * a ramp down has its own limit,
//! * a small change of speed only reaches the peak it has room for (two phases),
//! * a new command in the middle of a ramp goes on from there: speed and acceleration stay continuous
//!   and pass the new speed only as far as the acceleration already there makes unavoidable.
//!
//! A plan made on the way repeats the one before it, so nothing but speed and acceleration is kept.

use protocol::config::ProfileConfig;

use super::Setpoint;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JerkLimited {
    accel_mps2: f64,
    decel_mps2: f64,
    jerk_mps3: f64,
    now: Setpoint,
}

/// Part of a ramp with constant jerk.
#[derive(Clone, Copy, Debug)]
struct Phase {
    jerk_mps3: f64,
    lasts_s: f64,
}

impl JerkLimited {
    pub fn new(config: &ProfileConfig) -> Self {
        Self {
            accel_mps2: config.accel_mps2,
            decel_mps2: config.decel_mps2,
            jerk_mps3: config.jerk_mps3,
            now: Setpoint::default(),
        }
    }

    pub fn setpoint(&self) -> Setpoint {
        self.now
    }

    /// Goes on from `from`, whose acceleration is cut to the limits.
    pub fn place(&mut self, from: Setpoint) {
        self.now = Setpoint {
            accel_mps2: from.accel_mps2.clamp(-self.decel_mps2, self.accel_mps2),
            ..from
        };
    }

    /// Goes on for `dt_s` toward `target_mps`, which it reaches exactly and without acceleration. A target that is not
    /// finite counts as standstill.
    pub fn step(&mut self, target_mps: f64, dt_s: f64) -> Setpoint {
        let target_mps = if target_mps.is_finite() {
            target_mps
        } else {
            0.0
        };
        let mut left_s = dt_s;
        for phase in self.ramp(target_mps) {
            let lasts_s = phase.lasts_s.min(left_s);
            self.advance(phase.jerk_mps3, lasts_s);
            left_s -= lasts_s;
            if left_s <= 0.0 {
                return self.now;
            }
        }
        self.now = Setpoint {
            speed_mps: target_mps,
            accel_mps2: 0.0,
        };
        self.now
    }

    /// Duration of a whole ramp between two speeds, s. The ramp is symmetric, so its mean speed is the mean of both.
    pub fn ramp_s(&self, from_mps: f64, to_mps: f64) -> f64 {
        let mut from = *self;
        from.place(Setpoint {
            speed_mps: from_mps,
            accel_mps2: 0.0,
        });
        from.ramp(to_mps).iter().map(|phase| phase.lasts_s).sum()
    }

    fn advance(&mut self, jerk_mps3: f64, dt_s: f64) {
        let change = jerk_mps3 * dt_s;
        self.now.speed_mps += (self.now.accel_mps2 + 0.5 * change) * dt_s;
        self.now.accel_mps2 += change;
    }

    /// The rest of the ramp. Upward in the sense of the ramp is positive here, whichever way it goes.
    fn ramp(&self, target_mps: f64) -> [Phase; 3] {
        let jerk = self.jerk_mps3;
        let Setpoint {
            speed_mps,
            accel_mps2,
        } = self.now;
        // Speed that is left when the acceleration is taken back at once.
        let rest = speed_mps + accel_mps2 * libm::fabs(accel_mps2) / (2.0 * jerk);
        let (sense, most) = if target_mps >= rest {
            (1.0, self.accel_mps2)
        } else {
            (-1.0, self.decel_mps2)
        };
        let accel = sense * accel_mps2;
        let change = sense * (target_mps - speed_mps);
        // (peak² − accel²)/2J to the peak and peak²/2J from it make the change.
        let peak = libm::sqrt((jerk * change + 0.5 * accel * accel).max(0.0)).min(most);
        let toward = if peak < accel { -1.0 } else { 1.0 };
        let ends = (toward * (peak * peak - accel * accel) + peak * peak) / (2.0 * jerk);
        let hold_s = if peak > 0.0 {
            ((change - ends) / peak).max(0.0)
        } else {
            0.0
        };
        [
            Phase {
                jerk_mps3: sense * toward * jerk,
                lasts_s: libm::fabs(peak - accel) / jerk,
            },
            Phase {
                jerk_mps3: 0.0,
                lasts_s: hold_s,
            },
            Phase {
                jerk_mps3: -sense * jerk,
                lasts_s: peak / jerk,
            },
        ]
    }
}

#[cfg(test)]
mod tests {
    use proptest::collection::vec;
    use proptest::prelude::*;
    use protocol::CYCLE;

    use super::*;

    const KMH: f64 = 1.0 / 3.6;

    /// S1's limits, and a harder one downward so that a mix-up shows.
    fn config() -> ProfileConfig {
        ProfileConfig {
            accel_mps2: 3.0 * KMH,
            decel_mps2: 3.5 * KMH,
            jerk_mps3: 0.8,
            ..crate::for_tests::sg100().ato.profile
        }
    }

    /// Time until speed and acceleration are those of the end, from `from_mps`, s.
    fn ramp_s(from_mps: f64, to_mps: f64) -> f64 {
        JerkLimited::new(&config()).ramp_s(from_mps, to_mps)
    }

    /// From, to, km/h, and the duration, s, worked by hand from t_01 = a_L/J, v_1 = J·t_01²/2,
    /// t_12 = (v_2 − v_1)/a_L; for the two short ones 2·sqrt(Δv/J).
    #[test]
    fn a_ramp_takes_the_time_of_the_printed_formulas() {
        let (up, down) = (3.0 * KMH, 3.5 * KMH);
        for (from, to, expected) in [
            (0.0, 60.0, 20.0 + up / 0.8),
            (0.0, 80.0, 27.708),
            (40.0, 45.0, 5.0 / 3.0 + up / 0.8),
            (60.0, 40.0, 20.0 / 3.5 + down / 0.8),
            (50.0, 52.0, 2.0 * libm::sqrt(2.0 * KMH / 0.8)),
            (52.0, 50.0, 2.0 * libm::sqrt(2.0 * KMH / 0.8)),
            (40.0, 40.0, 0.0),
        ] {
            let got = ramp_s(from * KMH, to * KMH);
            assert!((got - expected).abs() < 1e-3, "{from} to {to} km/h: {got}");
        }
    }

    /// After 1.5 s of 0 → 60 km/h at the limit of jerk and acceleration the command falls to 2 km/h,
    /// less than the 4.2 km/h the train will have before it stops accelerating.
    #[test]
    fn a_new_command_passes_its_speed_no_further_than_it_must() {
        let mut profile = JerkLimited::new(&config());
        let begun = profile.step(60.0 * KMH, 1.5);
        let unavoidable = begun.speed_mps + begun.accel_mps2 * begun.accel_mps2 / 1.6;
        let mut most = 0.0_f64;
        for _ in 0..200 {
            most = most.max(profile.step(2.0 * KMH, CYCLE.as_secs()).speed_mps);
        }
        assert!(
            most <= unavoidable + 1e-12,
            "{most} instead of {unavoidable}"
        );
        assert_eq!(profile.setpoint().speed_mps, 2.0 * KMH);
        assert_eq!(profile.setpoint().accel_mps2, 0.0);
    }

    #[test]
    fn a_target_that_is_no_number_is_standstill() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut profile = JerkLimited::new(&config());
            profile.step(5.0, 20.0);
            profile.step(bad, 20.0);
            assert_eq!(profile.setpoint(), Setpoint::default());
        }
    }

    proptest! {
        /// Commands at random times: limits hold in every cycle, the speed agrees with the
        /// acceleration, and the last command is reached exactly.
        #[test]
        fn any_commands_keep_the_limits(commands in vec((0.0..25.0_f64, 1..200_u32), 1..8)) {
            let (config, dt) = (config(), CYCLE.as_secs());
            let mut profile = JerkLimited::new(&config);
            let settle = commands.last().map(|c| (c.0, 1200));
            for (target, cycles) in commands.iter().copied().chain(settle) {
                for _ in 0..cycles {
                    let before = profile.setpoint();
                    let now = profile.step(target, dt);
                    let jerk = (now.accel_mps2 - before.accel_mps2) / dt;
                    prop_assert!(jerk.abs() <= config.jerk_mps3 + 1e-9, "jerk {jerk}");
                    prop_assert!(now.accel_mps2 <= config.accel_mps2 + 1e-9);
                    prop_assert!(now.accel_mps2 >= -config.decel_mps2 - 1e-9);
                    // Trapezoid rule: no further off than the jerk changes within the cycle.
                    let mean = 0.5 * (now.accel_mps2 + before.accel_mps2) * dt;
                    let off = now.speed_mps - before.speed_mps - mean;
                    prop_assert!(off.abs() <= 0.25 * config.jerk_mps3 * dt * dt + 1e-9, "off {off}");
                }
            }
            let target = commands.last().map_or(0.0, |c| c.0);
            prop_assert_eq!(profile.setpoint(), Setpoint { speed_mps: target, accel_mps2: 0.0 });
        }

        /// However the time is cut into steps, the same ramp.
        #[test]
        fn steps_of_any_length_give_the_same_ramp(to in 0.5..25.0_f64, dt in 0.001..3.0_f64) {
            let mut whole = JerkLimited::new(&config());
            let mut parts = whole;
            let cycles = libm::ceil(9.0 / dt) as u32;
            let whole = whole.step(to, f64::from(cycles) * dt);
            for _ in 0..cycles {
                parts.step(to, dt);
            }
            let parts = parts.setpoint();
            prop_assert!((whole.speed_mps - parts.speed_mps).abs() < 1e-6);
            prop_assert!((whole.accel_mps2 - parts.accel_mps2).abs() < 1e-5);
        }
    }
}
