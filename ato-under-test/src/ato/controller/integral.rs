//! Integral part of a controller, with anti-windup.

use protocol::CYCLE;

use super::ControllerInput;

/// Difference between asked and granted that is only rounding, m/s²: a few steps of the 10 bits of an effort.
const ROUNDING_MPS2: f64 = 0.005;

/// The integral, in the unit of the law that it is part of: N or m/s².
///
/// It rests while REG withholds force (clipped, jerk limited, powering cut) and the error asks for
/// still more of it; an error the other way takes it down at once.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Integral {
    pub(super) value: f64,
    asked_n: f64,
}

impl Integral {
    /// One cycle at `rate` per second, which has the sign of the error.
    pub(super) fn add(&mut self, rate: f64, input: &ControllerInput) {
        let withheld_n = self.asked_n - input.granted_n;
        let clipped = libm::fabs(withheld_n) > ROUNDING_MPS2 * input.mass_kg;
        if !(clipped && (withheld_n > 0.0) == (rate > 0.0)) {
            self.value += rate * CYCLE.as_secs();
        }
    }

    /// Remembers the whole force asked for, N.
    pub(super) fn asked(&mut self, force_n: f64) {
        self.asked_n = force_n;
    }
}
