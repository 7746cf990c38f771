//! Form for the speed signals of the tachometer generators or the TEST board.

use btu_rig::stimulus::{Stimulus, TachoCondition};
use protocol::Speed;

/// Both speed inputs that the TEST board can drive, as bits.
const BOTH_CHANNELS: u8 = 0b11;

#[derive(Clone, Debug)]
pub struct MotionForm {
    /// Speed to go to, km/h.
    pub to_kmh: f64,
    /// Size of the acceleration, km/h/s; 0 = at once, on the TEST board only.
    pub accel_kmhps: f64,
    /// Distance to travel, m.
    pub distance_m: f64,
    /// Spurious pulses of a noisy channel, mean per second.
    pub noise_per_s: f64,
    /// Pulses of a scaled channel, times those of a good one.
    pub factor: f64,
    /// Inputs the TEST board drives: bit 0 = input 1, bit 1 = input 2.
    pub channels: u8,
    /// The TEST board's signal stands for backward motion.
    pub backward: bool,
}

impl Default for MotionForm {
    fn default() -> Self {
        Self {
            to_kmh: 40.0,
            accel_kmhps: 3.0,
            distance_m: 100.0,
            noise_per_s: 500.0,
            factor: 1.2,
            channels: BOTH_CHANNELS,
            backward: false,
        }
    }
}

impl MotionForm {
    pub fn go_to(&self) -> Stimulus {
        self.to(Speed::from_kmh(self.to_kmh))
    }

    pub fn stand(&self) -> Stimulus {
        self.to(Speed::ZERO)
    }

    /// Travel over the entered distance at the entered speed.
    pub fn travel(&self) -> Stimulus {
        Stimulus::Travel {
            distance_m: self.distance_m,
            speed: Speed::from_kmh(self.to_kmh),
            accel_mps2: self.accel_mps2(),
        }
    }

    /// Conditions that a channel can be given, in the order of the labels of the signals `tacho1` and `tacho2`.
    pub fn tacho_conditions(&self) -> [TachoCondition; 5] {
        let (per_s, factor) = (self.noise_per_s, self.factor);
        [
            TachoCondition::Good,
            TachoCondition::Dead,
            TachoCondition::Noisy { per_s },
            TachoCondition::Scaled { factor },
            TachoCondition::Reversed,
        ]
    }

    /// Brings the TEST board's signal to the entered speed.
    pub fn test_go(&self) -> Stimulus {
        self.test_to(Speed::from_kmh(self.to_kmh))
    }

    /// Brings the TEST board's signal to standstill.
    pub fn test_stand(&self) -> Stimulus {
        self.test_to(Speed::ZERO)
    }

    fn to(&self, to: Speed) -> Stimulus {
        Stimulus::Speed {
            to,
            accel_mps2: self.accel_mps2(),
        }
    }

    fn test_to(&self, to: Speed) -> Stimulus {
        Stimulus::PtuSpeed {
            channels: self.channels,
            backward: self.backward,
            to,
            accel_mps2: self.accel_mps2(),
        }
    }

    fn accel_mps2(&self) -> f64 {
        Speed::from_kmh(self.accel_kmhps).mps()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_and_accelerations_become_metres_and_seconds() {
        let form = MotionForm {
            to_kmh: 72.0,
            accel_kmhps: 3.6,
            distance_m: 55.0,
            ..MotionForm::default()
        };
        let twenty = Speed::from_kmh(72.0);
        assert_eq!(
            form.go_to(),
            Stimulus::Speed {
                to: twenty,
                accel_mps2: 1.0
            }
        );
        assert_eq!(
            form.stand(),
            Stimulus::Speed {
                to: Speed::ZERO,
                accel_mps2: 1.0
            }
        );
        assert_eq!(
            form.travel(),
            Stimulus::Travel {
                distance_m: 55.0,
                speed: twenty,
                accel_mps2: 1.0
            }
        );
    }

    #[test]
    fn a_tachometer_fault_has_the_chosen_kind_and_size() {
        let form = MotionForm {
            noise_per_s: 40.0,
            factor: 0.5,
            ..MotionForm::default()
        };
        let expected = [
            TachoCondition::Good,
            TachoCondition::Dead,
            TachoCondition::Noisy { per_s: 40.0 },
            TachoCondition::Scaled { factor: 0.5 },
            TachoCondition::Reversed,
        ];
        assert_eq!(form.tacho_conditions(), expected);
    }

    #[test]
    fn the_test_board_drives_the_inputs_chosen() {
        let form = MotionForm {
            channels: 0b10,
            backward: true,
            accel_kmhps: 0.0,
            ..MotionForm::default()
        };
        let (go, stand) = (Speed::from_kmh(40.0), Speed::ZERO);
        for (sent, to) in [(form.test_go(), go), (form.test_stand(), stand)] {
            let expected = Stimulus::PtuSpeed {
                channels: 0b10,
                backward: true,
                to,
                accel_mps2: 0.0,
            };
            assert_eq!(sent, expected);
        }
    }
}
