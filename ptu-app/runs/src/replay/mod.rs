//! Repeats recorded stimuli: traces of a good unit for comparison, differences between traces, replays.
//!
//! * [`Original`]: a stored trace with the recording it was cut from;
//! * [`good_twin`]: the same stimuli at the same times, the same seed, on an embedded unit without the
//!   fault. Stimuli are open loop; the train follows the twin's own demands;
//! * [`compare`](fn@compare): where two traces part, signal by signal;
//! * [`explain`]: first deviation of a trace from its twin, and the chain from there to the brake;
//! * [`rerun`]: the same stimuli on the embedded unit or one on a port, recorded as a run of its own.

mod compare;
mod explain;
mod original;
mod path;
mod replay_embedded;
mod rerun;
mod residual;

pub use compare::{Comparison, Deviation, Difference, Rule, compare};
pub use explain::{Explanation, Link, explain};
pub use original::{Original, rule_between};
pub use rerun::{ReplayMatch, Rerun, Rerunning, rerun};
pub use residual::{first_deviation, first_traces, residuals};

pub use replay_embedded::good_twin;
