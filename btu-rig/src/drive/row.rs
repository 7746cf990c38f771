//! What is recorded of a drive each 50 ms cycle: every signal, and the truth that no signal has.

use protocol::signal::Signal;

use crate::lever::Lever;
use crate::recorder;
use crate::rig::{PAIR_DEMANDS, PairEfforts};
use crate::tcms::PowerCuts;

/// MT pairs that are recorded.
pub const PAIRS: usize = PAIR_DEMANDS.len();

/// One cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Every signal.
    pub signals: recorder::Row,
    /// Time since the run's zero, s.
    pub t_s: f64,
    /// Head of the train in the section, m; true.
    pub x_m: f64,
    /// True speed, km/h; forward positive, in a run by hand a size.
    pub speed_kmh: f64,
    /// Position of the master controller.
    pub lever: Lever,
    /// Power of traction at the wheels, mean of the cycle, W.
    pub power_w: f64,
    /// What the equipment of the MT pairs gives, from the head.
    pub pairs: [PairEfforts; PAIRS],
    /// A car slips or slides.
    pub sliding: bool,
}

impl Row {
    /// A signal's value; not-a-number when it was not known.
    pub fn value(&self, signal: Signal) -> f64 {
        self.signals.value(signal)
    }

    /// All service brakes on the rails, N.
    pub fn brake_n(&self) -> f64 {
        self.value(Signal::ElectricBrake) + self.value(Signal::AirBrake)
    }

    /// Brake effort less what is demanded, as a share of it; none where nothing is demanded, other
    /// brakes are on, or the train stands.
    pub fn deviation(&self) -> Option<f64> {
        let demand_n = self.value(Signal::BrakeDemand);
        let counts = demand_n > 0.0 && self.speed_kmh > 0.0 && !self.other_brakes();
        counts.then(|| self.brake_n() / demand_n - 1.0)
    }

    /// Emergency, security or parking brake is on: more than TCMS demands.
    fn other_brakes(&self) -> bool {
        let bits = self.value(Signal::PowerCutCauses) as u16;
        [
            PowerCuts::EMERGENCY,
            PowerCuts::SECURITY,
            PowerCuts::PARKING,
        ]
        .iter()
        .any(|cut| bits & cut.bits() != 0)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use protocol::Instant;
    use protocol::signal::Sample;

    use super::*;

    /// A row of a train that rolls, with these signals.
    pub fn row_at(t_s: f64, speed_kmh: f64, signals: &[(Signal, f64)]) -> Row {
        let mut sample = Sample::default();
        for (signal, value) in signals {
            sample.set(*signal, *value);
        }
        Row {
            signals: recorder::Row {
                at: Instant::ZERO,
                sample,
            },
            t_s,
            x_m: 0.0,
            speed_kmh,
            lever: Lever::Neutral,
            power_w: 0.0,
            pairs: Default::default(),
            sliding: false,
        }
    }
}
