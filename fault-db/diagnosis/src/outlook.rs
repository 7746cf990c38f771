//! What each check may show: its outcomes, numbered, and how often each effect has them.

use super::cell::{Cell, StepOutcome};
use super::dictionary::{Column, Dictionary};

/// Number of an outcome, and its share of the runs.
type Shares = Vec<(usize, f64)>;

/// The outcomes of one check.
#[derive(Clone, Debug, Default)]
pub struct Outlook {
    pub outcomes: Vec<StepOutcome>,
    /// On a healthy unit.
    pub healthy: Shares,
    /// Under the effects that differ from a healthy unit here, each by its index.
    pub effects: Vec<(usize, Shares)>,
}

/// The outlook of each check of a dictionary, in order; `columns` are its effects.
pub fn outlooks<'a>(
    dictionary: &'a Dictionary,
    columns: impl Iterator<Item = &'a Column> + Clone,
) -> Vec<Outlook> {
    let of_check = |place: usize| {
        let mut known: Vec<&StepOutcome> = Vec::new();
        let mut shares = |cell: &'a Cell| -> Shares {
            let runs = f64::from(cell.runs());
            let outcomes = cell.signatures.iter().map(|(outcome, count)| {
                let number = known.iter().position(|known| *known == outcome);
                let number = number.unwrap_or_else(|| {
                    known.push(outcome);
                    known.len() - 1
                });
                (number, f64::from(*count) / runs)
            });
            outcomes.collect()
        };
        let healthy = dictionary.healthy.cells.get(&place);
        let healthy = healthy.map(&mut shares).unwrap_or_default();
        let acting = columns.clone().enumerate();
        let acting =
            acting.filter_map(|(effect, column)| Some((effect, column.cells.get(&place)?)));
        let effects = acting
            .map(|(effect, cell)| (effect, shares(cell)))
            .collect();
        Outlook {
            outcomes: known.into_iter().cloned().collect(),
            healthy,
            effects,
        }
    };
    (0..dictionary.checks.len()).map(of_check).collect()
}
