//! The longest time that a procedure, a step and its parts can take.

use protocol::{Duration, Speed};

use super::plan::{Action, Expectation, Procedure, Step};
use crate::stimulus::Stimulus;

/// How much longer than its worst case a step may take before it is ended.
pub const TIME_LIMIT_MARGIN: Duration = Duration::from_ms(1000);
/// Time allowed for an exchange of the tester with the unit.
pub const REQUEST_TIME: Duration = Duration::from_ms(5000);
/// Time allowed to a tachometer ramp or travel beyond what its speeds need.
const MOTION_MARGIN_S: f64 = 2.0;
/// Highest speed from which the time allowed for a ramp lets a generator come down.
const TOP_SPEED: Speed = Speed::from_kmh(120.0);

impl Expectation {
    /// Longest time that the expectation takes after the actions.
    pub fn worst_case(&self) -> Duration {
        match self {
            Self::Becomes { within, .. } | Self::Logs { within, .. } => *within,
            Self::Holds { duration, .. } => *duration,
            Self::Never { .. } | Self::NeverLogs { .. } => Duration::ZERO,
        }
    }
}

impl Action {
    /// Longest time that the action takes.
    pub fn worst_case(&self) -> Duration {
        match self {
            Self::Stimulus(_) => Duration::ZERO,
            Self::Wait(span) => *span,
            Self::Until { within, .. } | Self::Settle { within } | Self::Prompt { within, .. } => {
                *within
            }
            Self::OnBench(action) | Self::OnTrain(action) => action.worst_case(),
        }
    }

    /// The wait that goes with a stimulus that takes its time: ramp, travel or tester request.
    pub fn settle_after(stimulus: &Stimulus) -> Self {
        let seconds = match stimulus {
            Stimulus::Speed { to, accel_mps2 } => {
                to.max(TOP_SPEED).mps() / accel_mps2 + MOTION_MARGIN_S
            }
            Stimulus::Travel {
                distance_m,
                speed,
                accel_mps2,
            } => {
                let moving = distance_m.abs() / speed.mps() + 2.0 * speed.mps() / accel_mps2;
                moving + TOP_SPEED.mps() / accel_mps2 + MOTION_MARGIN_S
            }
            _ => REQUEST_TIME.as_secs(),
        };
        Self::Settle {
            within: Duration::from_secs(seconds),
        }
    }
}

impl Step {
    /// Longest time that the step's actions, expectations and measures can take, cut by `limit` if one is set.
    pub fn compute_worst_case(&self, limit: Option<Duration>) -> Duration {
        let after = self
            .expectations
            .iter()
            .map(Expectation::worst_case)
            .chain(
                self.measures
                    .iter()
                    .filter(|m| m.is_awaited())
                    .map(|m| m.within),
            )
            .max()
            .unwrap_or(Duration::ZERO);
        let total = total_worst_case(&self.actions) + after;
        limit.map_or(total, |limit| total.min(limit))
    }
}

impl Procedure {
    /// Longest time that the procedure can take: setup, all steps with repetitions, clean-up.
    pub fn worst_case(&self) -> Duration {
        let mut total = total_worst_case(&self.setup) + total_worst_case(&self.cleanup);
        for step in &self.steps {
            total += Duration::from_us(step.worst_case.as_us() * u64::from(step.repeat));
        }
        total
    }
}

/// Sum of the longest times of `actions`.
pub fn total_worst_case(actions: &[Action]) -> Duration {
    actions
        .iter()
        .fold(Duration::ZERO, |sum, action| sum + action.worst_case())
}
