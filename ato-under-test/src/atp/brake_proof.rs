//! Proof that the service brake works: whatever asks for it, the train must slow, or the emergency brake follows.

use protocol::config::OverspeedConfig;
use protocol::{Instant, Speed};

use crate::timer::{OnDelay, ms};

/// Scans over which the deceleration is measured (0.5 s).
const DECEL_SCANS: usize = 50;

/// State of the service brake in one scan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BrakeState {
    /// Deceleration, negative while the train gains speed, mm/s².
    pub decel_mms2: i32,
    /// The train slows as a braked one.
    pub proved: bool,
    /// The service brake has had its time and the train does not slow.
    pub ineffective: bool,
}

/// Demand for the service brake in one scan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Demand {
    /// The service brake is asked for, and the train must slow.
    pub holds: bool,
    /// A deceleration can be measured: the speed is not close to the one that the train is braked to.
    pub measurable: bool,
}

/// Measures the deceleration from scan to scan.
#[derive(Clone, Debug)]
pub struct BrakeProof {
    history: [f64; DECEL_SCANS],
    at: usize,
    effect_changes: OnDelay,
    effective: bool,
    measurable: OnDelay,
    demanded: OnDelay,
}

impl BrakeProof {
    pub fn step(
        &mut self,
        now: Instant,
        speed: Speed,
        demand: Demand,
        config: &OverspeedConfig,
    ) -> BrakeState {
        let before = core::mem::replace(&mut self.history[self.at], speed.mps());
        self.at = (self.at + 1) % DECEL_SCANS;
        let decel_mps2 = (before - speed.mps()) / (DECEL_SCANS as f64 * protocol::SCAN.as_secs());
        let proved = decel_mps2 >= config.brake_proof_mps2;
        // A pulse too many in a tachometer hides a deceleration, or feigns one, for as long as its speed window.
        let delay = ms(config.eb_delay_ms);
        let differs = proved != self.effective;
        if self.effect_changes.update(now, differs, delay) {
            self.effective = proved;
        }
        // Nor does such a pulse make a train that is at its limit count as faster.
        let measurable = self.measurable.update(now, demand.measurable, delay);
        let waited = (self.demanded).update(now, demand.holds, ms(config.brake_proof_ms));
        BrakeState {
            decel_mms2: libm::round(decel_mps2 * 1000.0) as i32,
            proved,
            ineffective: waited && measurable && !self.effective,
        }
    }
}

impl Default for BrakeProof {
    /// Standing, nothing asked for.
    fn default() -> Self {
        Self {
            history: [0.0; DECEL_SCANS],
            at: 0,
            effect_changes: OnDelay::default(),
            effective: false,
            measurable: OnDelay::default(),
            demanded: OnDelay::default(),
        }
    }
}
