//! The possible outcomes of each check, numbered, and how often each occurs under each effect.

use super::cell::{Cell, StepOutcome};
use super::dictionary::{Column, Dictionary};

/// Outcomes by their numbers, each with its share of the runs.
type Shares = Vec<(usize, f64)>;

/// The outcomes of one check.
#[derive(Clone, Debug, Default)]
pub struct Outlook {
    pub outcomes: Vec<StepOutcome>,
    /// Shares of the outcomes on a healthy unit.
    pub healthy: Shares,
    /// Shares of the outcomes under each effect that differs from a healthy unit at this check, by the effect's index.
    pub effects: Vec<(usize, Shares)>,
}

/// The outlook of each check of a dictionary, in order; `columns` are its effects.
pub fn outlooks<'a>(
    dictionary: &'a Dictionary,
    columns: impl Iterator<Item = &'a Column>,
) -> Vec<Outlook> {
    let mut outlooks = vec![Outlook::default(); dictionary.checks.len()];
    for (place, cell) in &dictionary.healthy.cells {
        outlooks[*place].healthy = outlooks[*place].shares(cell);
    }
    for (effect, column) in columns.enumerate() {
        for (place, cell) in &column.cells {
            let shares = outlooks[*place].shares(cell);
            outlooks[*place].effects.push((effect, shares));
        }
    }
    outlooks
}

impl Outlook {
    /// Shares of a cell's outcomes; numbers new outcomes.
    fn shares(&mut self, cell: &Cell) -> Shares {
        let runs = f64::from(cell.runs());
        let outcomes = cell.signatures.iter().map(|(outcome, count)| {
            let number = self.outcomes.iter().position(|known| known == outcome);
            let number = number.unwrap_or_else(|| {
                self.outcomes.push(outcome.clone());
                self.outcomes.len() - 1
            });
            (number, f64::from(*count) / runs)
        });
        outcomes.collect()
    }
}
