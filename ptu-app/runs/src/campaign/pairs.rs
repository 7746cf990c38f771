//! How well a dictionary tells two faults at once.

use std::collections::BTreeMap;

use diagnosis::{Diagnosis, Dictionary, Finding, Model, Relations, Settings};
use protocol::LruId;

use super::evaluate::Share;
use super::samples::Sample;
use super::suite::SuiteRun;

/// The two parts are looked for among so many parts, the likeliest.
const AMONG: usize = 3;

/// The figures over all detected runs of units with two faults of different parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PairFigures {
    /// Both parts are among the first three.
    pub both: Share,
    /// At least one of both parts is among the first three.
    pub one: Share,
    /// Sound parts alone are named for certain.
    pub wrong: Share,
    /// Both faults, and the answer, of the runs in which not both parts are among the first three.
    pub not_both: Vec<(String, String)>,
}

impl PairFigures {
    /// Diagnoses these runs.
    pub(super) fn of(
        dictionary: &Dictionary,
        (settings, relations): (&Settings, &Relations),
        runs: &[(&Sample, &SuiteRun)],
    ) -> Self {
        let model = Model::new(dictionary, settings, &BTreeMap::new()).with_relations(relations);
        let mut figures = Self::default();
        for (sample, run) in runs.iter().filter(|(_, run)| !run.passed) {
            let diagnosis = Diagnosis::of(&model, &run.seen);
            let is_bad = |part: &LruId| sample.faults.iter().any(|fault| fault.lru == *part);
            let first = diagnosis.parts.iter().take(AMONG);
            let found = first.filter(|part| is_bad(&part.lru)).count();
            let finding = diagnosis.conclusion.finding();
            let is_certain = !matches!(finding, Finding::CannotTell | Finding::NotEnough);
            let sound = is_certain && !diagnosis.conclusion.parts().iter().any(is_bad);
            figures.both.count(found == 2);
            figures.one.count(found > 0);
            figures.wrong.count(sound);
            if found < 2 {
                figures
                    .not_both
                    .push((sample.modes(), finding.label().to_owned()));
            }
        }
        figures
    }
}
