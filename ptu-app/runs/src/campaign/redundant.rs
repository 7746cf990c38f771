//! Finds the steps that tell fault modes apart by their verdict alone; measured values and their signs are not
//! counted.

use std::collections::BTreeSet;

use diagnosis::{CheckName, Dictionary};
use protocol::LruId;

/// A step tells two hypotheses apart when one fails it at least this much more often.
const APART: f64 = 0.8;

/// Steps that are needed to detect and isolate, and those that are not.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Redundancy {
    /// Steps that are enough, the most telling first.
    pub needed: Vec<CheckName>,
    /// Steps that no fault mode of the catalogue fails.
    pub never_failed: Vec<CheckName>,
    /// All other steps.
    pub redundant: Vec<CheckName>,
}

/// Chooses steps greedily, each time the one that tells most hypotheses apart that were not yet.
pub fn redundancy(dictionary: &Dictionary) -> Redundancy {
    let mut columns = vec![(None, &dictionary.healthy)];
    for mode in &dictionary.modes {
        columns.extend(
            mode.columns
                .iter()
                .map(|column| (Some(&mode.name.lru), column)),
        );
    }
    let fails: Vec<Vec<f64>> = (0..dictionary.checks.len())
        .map(|place| {
            let of = |(_, column): &(Option<&LruId>, &diagnosis::Column)| {
                column
                    .cells
                    .get(&place)
                    .map_or(0.0, |cell| cell.not_passed())
            };
            columns.iter().map(of).collect()
        })
        .collect();
    let mut pairs = Vec::new();
    for (i, (first, _)) in columns.iter().enumerate() {
        for (j, (second, _)) in columns.iter().enumerate().skip(i + 1) {
            if first != second {
                pairs.push((i, j));
            }
        }
    }
    let apart =
        |place: usize, (i, j): (usize, usize)| (fails[place][i] - fails[place][j]).abs() >= APART;
    let mut open: Vec<_> = pairs;
    let mut needed = Vec::new();
    loop {
        let told = |place: usize| open.iter().filter(|pair| apart(place, **pair)).count();
        let best = (0..fails.len()).map(|place| (told(place), place));
        let Some((most, place)) = best.max_by_key(|(told, place)| (*told, usize::MAX - place))
        else {
            break;
        };
        if most == 0 {
            break;
        }
        open.retain(|pair| !apart(place, *pair));
        needed.push(place);
    }
    let chosen: BTreeSet<_> = needed.iter().copied().collect();
    let name = |place: usize| dictionary.checks[place].clone();
    let (never, redundant): (Vec<_>, Vec<_>) = (0..fails.len())
        .filter(|place| !chosen.contains(place))
        .partition(|place| fails[*place].iter().all(|p| *p == 0.0));
    Redundancy {
        needed: needed.into_iter().map(name).collect(),
        never_failed: never.into_iter().map(name).collect(),
        redundant: redundant.into_iter().map(name).collect(),
    }
}
