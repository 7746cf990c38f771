//! Explains a trace: its first deviation from the trace of a good unit, and what followed from there to the brake.

use fault_db::{Id, Store, TraceData};

use super::{Comparison, Deviation, Original, compare, good_twin, path};
use crate::data::ScriptsDirectory;
use crate::failure::Failure;

/// Signals and events named on the way from the first deviation to the brake.
const LONGEST_CHAIN: usize = 12;

#[derive(Debug)]
pub struct Explanation {
    pub id: Id,
    /// Procedure in which the trace was recorded.
    pub procedure: String,
    /// Expected trace, made by the good twin.
    pub twin: TraceData,
    /// Deviations of the trace from the expected one, the earliest first.
    pub comparison: Comparison,
    /// From the first deviation to the brake, or to the end of the trace when none came.
    pub chain: Vec<Link>,
    /// Limits of the comparison, as sentences.
    pub notes: Vec<String>,
}

/// One link of the chain.
#[derive(Clone, Debug, PartialEq)]
pub enum Link {
    /// A signal begins to deviate.
    Signal(Deviation),
    Fault {
        /// Seconds from the trigger.
        at_s: f64,
        code: i64,
        name: String,
        /// Part at which the fault points.
        lru: String,
    },
}

impl Link {
    /// Seconds from the trigger.
    pub fn at_s(&self) -> f64 {
        match self {
            Self::Signal(deviation) => deviation.first.at_s,
            Self::Fault { at_s, .. } => *at_s,
        }
    }
}

impl Explanation {
    pub fn first(&self) -> Option<&Deviation> {
        self.comparison.deviations.first()
    }
}

/// Explains a stored trace by its good twin.
///
/// # Errors
/// There is no such trace, it has no recording, or a file the bench was built from is gone.
pub fn explain(
    store: &Store,
    directory: &ScriptsDirectory,
    id: Id,
) -> Result<Explanation, Failure> {
    let original = &Original::read(store, id)?;
    let (twin, rule) = good_twin(original, directory)?;
    let comparison = compare(&original.trace, &twin, &rule, &[])?;
    let faults = faults(store, original)?;
    let chain = chain(&comparison, faults);
    let mut notes = Vec::new();
    if original.made.on_port() {
        notes.push(format!(
            "the unit was on a port ({}): times to within {} ms, and compared from 1 s after the \
             procedure's begin on",
            original.made.source,
            2 * original.trace.period_us / 1000
        ));
    }
    if let Some(first) = comparison.deviations.first()
        && first.first.at_s <= comparison.window_s.0
    {
        notes.push(format!(
            "{} deviates from the first row on: it began to before the trace",
            first.signal
        ));
    }
    Ok(Explanation {
        id: original.id,
        procedure: original.procedure.clone(),
        twin,
        comparison,
        chain,
        notes,
    })
}

/// Faults found in the trace's window.
fn faults(store: &Store, original: &Original) -> Result<Vec<Link>, Failure> {
    let fault = |occurrence: fault_db::RunOccurrence| Link::Fault {
        at_s: original.at_s(occurrence.bench_us),
        code: occurrence.code,
        name: occurrence.code_name,
        lru: occurrence.lru,
    };
    let occurrences = store.run_occurrences(original.run_id)?.into_iter();
    Ok(occurrences
        .filter(|occurrence| occurrence.trace_id == Some(original.id))
        .map(fault)
        .collect())
}

/// The first deviation, those on the way that follow until a brake deviates, and the
/// faults found until then; without a brake, until the first fault.
fn chain(comparison: &Comparison, faults: Vec<Link>) -> Vec<Link> {
    let Some(first) = comparison.deviations.first() else {
        return faults;
    };
    let brake = |deviation: &&Deviation| path::is_brake(&deviation.signal);
    let braked_s = comparison
        .deviations
        .iter()
        .find(brake)
        .map(|d| d.first.at_s);
    let found_s = faults
        .iter()
        .map(Link::at_s)
        .filter(|at_s| *at_s >= first.first.at_s)
        .reduce(f64::min);
    let end_s = braked_s.or(found_s).unwrap_or(f64::INFINITY);
    let follows = comparison.deviations.iter().skip(1);
    let follows = follows.filter(|d| path::is_link(&d.signal) && d.first.at_s <= end_s);
    let mut signals: Vec<_> = std::iter::once(first).chain(follows).collect();
    if signals.len() > LONGEST_CHAIN {
        // The way in and its end say most.
        let rest = signals.split_off(LONGEST_CHAIN - 1);
        let last = rest.iter().rev().find(|d| path::is_brake(&d.signal));
        signals.extend(last.or(rest.last()));
    }
    let end_s = found_s.map_or(end_s, |found_s| end_s.max(found_s));
    let mut faults = faults
        .into_iter()
        .filter(|fault| fault.at_s() <= end_s)
        .peekable();
    let mut chain = Vec::new();
    for signal in signals {
        // A fault is found after what shows it; signals keep their order on the way.
        while let Some(fault) = faults.next_if(|fault| fault.at_s() < signal.first.at_s) {
            chain.push(fault);
        }
        chain.push(Link::Signal(signal.clone()));
    }
    chain.extend(faults);
    chain
}
