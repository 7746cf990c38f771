//! A breach that was found, as it is told.

use std::fmt;

use protocol::Instant;
use protocol::signal::Signal;

use super::monitor::Breach;
use super::observed::Observed;
use super::plan::Act;

/// First breach of an invariant in a plan.
#[derive(Debug)]
pub struct Find {
    pub breach: Breach,
    pub at: Instant,
    /// Signals and true motion at the breach.
    pub state: String,
    /// Greatest difference by which the unit tells a lower speed than the true one, km/h.
    pub hidden_kmh: f64,
    /// Faults that were injected, and those of tachometers that the bench made.
    pub faults: Vec<String>,
    /// Acts until then, in order.
    pub acts: Vec<(Instant, Act)>,
}

impl fmt::Display for Find {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            at,
            state,
            faults,
            acts,
            ..
        } = self;
        writeln!(f, "at {at} with {faults:?}: {state}")?;
        let acts = acts.iter();
        let acts = acts.map(|(at, act)| format!("{:.2} s {act}", at.as_us() as f64 / 1e6));
        write!(f, "    {}", acts.collect::<Vec<_>>().join("; "))
    }
}

/// Signals and true motion of a scan.
pub(super) fn state(seen: Observed<'_>) -> String {
    let signals = [
        Signal::Mode,
        Signal::TcmsMode,
        Signal::Limit,
        Signal::Speed,
        Signal::Eb,
        Signal::EbLoop,
        Signal::EbCause,
        Signal::Fsb,
        Signal::FsbCause,
        Signal::Standstill,
        Signal::Position,
        Signal::Aligned,
        Signal::TwcSection,
    ];
    let values = signals.map(|signal| {
        let value = seen
            .sample
            .get(signal)
            .map_or("-".to_owned(), |value| format!("{value:.1}"));
        format!("{} {value}", signal.name())
    });
    format!(
        "section {}, {:.2} km/h, {:.2} m to the stop point, {:.0} N, {}",
        seen.section,
        seen.speed_mps * 3.6,
        seen.to_stop_m.unwrap_or(f64::NAN),
        seen.traction_n,
        values.join(", ")
    )
}
