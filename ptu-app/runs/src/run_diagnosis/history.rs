//! Prior probabilities of parts from the history of their unit, with the reasons.

use std::collections::{BTreeMap, BTreeSet};

use diagnosis::{Diagnosis, Known, Reason, Repaired, Settings};
use fault_db::{PartHistory, PartRepair, RunDetail, RunOccurrence, Store};

use protocol::lru::{LruId, from_stored};

use crate::clock::now_us;
use crate::failure::Failure;
use crate::symptoms::Symptom;

/// More earlier runs than these say no more: a unit may lie on the bench for days with one fault.
const MOST_RUNS: u32 = 4;
const DAY_US: i64 = 86_400_000_000;
/// In a list of reasons, what the history tells comes after so many others.
const AFTER: usize = 1;

/// What a unit's history says of its parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OwnHistory {
    /// Factor on the prior of a part.
    pub factors: BTreeMap<LruId, f64>,
    for_it: BTreeMap<LruId, Vec<Known>>,
    against: BTreeMap<LruId, Known>,
}

impl OwnHistory {
    /// The history of the run's unit before the run.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn before(
        run: &RunDetail,
        occurrences: &[RunOccurrence],
        store: &Store,
        settings: &Settings,
    ) -> Result<Self, Failure> {
        let span = span(run.run.started_at_us, settings);
        let parts = store.part_history(&run.run.unit_serial, span, Some(run.run.id))?;
        let seen = occurrences.iter().map(|seen| (seen.code, seen.lru.clone()));
        Ok(Self::of(&parts, &seen.collect(), settings))
    }

    /// The history of a unit up to now, for a run that is about to begin.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn up_to_now(serial: &str, store: &Store, settings: &Settings) -> Result<Self, Failure> {
        let parts = store.part_history(serial, span(now_us(), settings), None)?;
        Ok(Self::of(&parts, &BTreeSet::new(), settings))
    }

    /// Weighs the parts' histories and the faults `seen` now, by number and the part that each names.
    fn of(
        parts: &BTreeMap<String, PartHistory>,
        seen: &BTreeSet<(i64, String)>,
        settings: &Settings,
    ) -> Self {
        let mut history = Self::default();
        for (part, known) in parts {
            // Faults that name no part say nothing of any.
            let Some(part) = from_stored(part) else {
                continue;
            };
            let in_vain = known.repair.as_ref().filter(|repair| {
                repair.came_back || repair.faults.intersection(seen).next().is_some()
            });
            let factor = if let Some(repair) = in_vain {
                // After a repair in vain, faults that name the part do not speak for it, however often.
                let known = Known::CameBack(repaired(repair));
                history.against.insert(part.clone(), known);
                settings.replaced_in_vain_factor
            } else if known.runs > 0 {
                let since = known.repair.as_ref().map(repaired);
                let runs = known.runs;
                history.add_for(&part, Known::Recurred { runs, since });
                let runs = known.runs.min(MOST_RUNS);
                settings.recurrence_factor.powi(runs as i32)
            } else {
                continue;
            };
            history.factors.insert(part, factor);
        }
        history
    }

    /// Adds the symptom that was reported with the unit.
    pub(super) fn add_symptom(&mut self, symptom: &Symptom, settings: &Settings) {
        for part in &symptom.parts {
            let symptom = symptom.name.clone();
            self.add_for(part, Known::BroughtWith { symptom });
            *self.factors.entry(part.clone()).or_insert(1.0) *= settings.symptom_factor;
        }
    }

    /// Adds what speaks for a part.
    pub(super) fn add_for(&mut self, part: &LruId, known: Known) {
        self.for_it.entry(part.clone()).or_default().push(known);
    }

    /// Adds what is known to the reasons of a diagnosis.
    pub fn explain(&self, diagnosis: &mut Diagnosis) {
        for candidate in &mut diagnosis.candidates {
            let for_it = self.for_it.get(&candidate.lru).into_iter().flatten();
            add(&mut candidate.for_it, for_it);
            let against = self.against.get(&candidate.lru).into_iter();
            add(&mut candidate.against, against);
        }
    }
}

/// Adds knowledge of the history to reasons, after the strongest: it is of another kind than what the steps show, and
/// is read with these.
fn add<'a>(reasons: &mut Vec<Reason>, known: impl Iterator<Item = &'a Known>) {
    let place = reasons.len().min(AFTER);
    reasons.splice(place..place, known.cloned().map(Reason::Known));
}

/// How far a history goes back from a time, µs UTC.
fn span(until_us: i64, settings: &Settings) -> (i64, i64) {
    (
        until_us - i64::from(settings.history_days) * DAY_US,
        until_us,
    )
}

fn repaired(repair: &PartRepair) -> Repaired {
    Repaired {
        replaced: repair.replaced,
        at_us: repair.at_us,
    }
}

#[cfg(test)]
mod tests {
    use diagnosis::{Basis, CheckName, Dictionary, ModeName, Model, Observation, ObservedStep};

    use btu_rig::procedure::Verdict;

    use super::*;

    /// 2026-11-02 12:00:00 UTC.
    const REPAIRED_US: i64 = 1_793_620_800_000_000;

    fn known(runs: u32, came_back: Option<bool>) -> PartHistory {
        let repair = came_back.map(|came_back| PartRepair {
            at_us: REPAIRED_US,
            replaced: true,
            faults: BTreeSet::from([(230, "eb_relay".to_owned())]),
            came_back,
        });
        PartHistory { runs, repair }
    }

    /// Diagnosis of a check that fails alike with either of two parts, the relay's history known.
    fn diagnosed(relay: PartHistory, seen: &[(i64, &str)]) -> (OwnHistory, Diagnosis, f64) {
        let settings = Settings::default();
        let parts = BTreeMap::from([("eb_relay".to_owned(), relay)]);
        let seen = seen.iter().map(|(code, lru)| (*code, (*lru).to_owned()));
        let history = OwnHistory::of(&parts, &seen.collect(), &settings);
        let check = CheckName {
            procedure: "atp/brake".into(),
            step: "applied in time".into(),
        };
        let came = |result| Observation {
            steps: vec![ObservedStep {
                check: check.clone(),
                result,
                time_s: 1.0,
                values: Vec::new(),
                signs: BTreeSet::new(),
            }],
            ..Observation::default()
        };
        let mut dictionary = Dictionary::new(Basis::default(), vec![1, 2], vec![check.clone()]);
        dictionary.set_healthy(&[came(Verdict::Passed), came(Verdict::Passed)]);
        for part in ["eb_relay", "io_board"] {
            let mode = ModeName {
                id: format!("{part}.slow"),
                lru: LruId::from_static(part),
                text: String::new(),
                kind: "permanent".into(),
                unsafe_: false,
                weight: 1.0,
            };
            dictionary.add(
                &mode,
                String::new(),
                &[came(Verdict::Failed), came(Verdict::Failed)],
            );
        }
        let model = Model::new(&dictionary, &settings, &history.factors);
        let mut diagnosis = Diagnosis::of(&model, &came(Verdict::Failed));
        history.explain(&mut diagnosis);
        let relay = diagnosis.parts.iter().find(|part| part.lru == "eb_relay");
        let probability = relay.expect("the relay").probability;
        (history, diagnosis, probability)
    }

    /// What the history says for a part and against it.
    fn told(diagnosis: &Diagnosis, lru: &str) -> [Vec<Known>; 2] {
        let candidate = diagnosis.candidates.iter().find(|c| c.lru == lru);
        let candidate = candidate.expect("a candidate");
        [&candidate.for_it, &candidate.against].map(|reasons| {
            let known = reasons.iter().filter_map(|reason| match reason {
                Reason::Known(known) => Some(known.clone()),
                _ => None,
            });
            known.collect()
        })
    }

    fn replaced() -> Repaired {
        Repaired {
            replaced: true,
            at_us: REPAIRED_US,
        }
    }

    #[test]
    fn a_recurrence_raises_a_part_and_says_so() {
        let (_, none, without) = diagnosed(known(0, None), &[]);
        assert!(told(&none, "eb_relay")[1].is_empty());
        let (_, diagnosis, with) = diagnosed(known(3, None), &[]);
        assert!(with > 1.4 * without, "{with} against {without}");
        let [for_it, _] = told(&diagnosis, "eb_relay");
        let (runs, since) = (3, None);
        assert_eq!(for_it, [Known::Recurred { runs, since }]);
        assert!(told(&diagnosis, "io_board")[0].is_empty());
        assert_eq!(
            diagnosed(known(40, None), &[]).2,
            diagnosed(known(4, None), &[]).2
        );
    }

    #[test]
    fn a_part_replaced_without_effect_is_less_likely_however_often_it_is_named() {
        let (_, _, without) = diagnosed(known(0, None), &[]);
        let (_, diagnosis, with) = diagnosed(known(4, Some(true)), &[]);
        assert!(with < 0.8 * without, "{with} against {without}");
        let [_, against] = told(&diagnosis, "eb_relay");
        assert_eq!(against, [Known::CameBack(replaced())]);
    }

    #[test]
    fn the_first_run_after_a_repair_shows_that_it_had_no_effect() {
        let (same, _, _) = diagnosed(known(0, Some(false)), &[(230, "eb_relay")]);
        assert_eq!(same.factors["eb_relay"], 0.5);
        let (other, _, _) = diagnosed(known(0, Some(false)), &[(221, "speed_sensor_1")]);
        assert!(other.factors.is_empty(), "{other:?}");
        let (since, diagnosis, _) = diagnosed(known(2, Some(false)), &[]);
        assert_eq!(since.factors["eb_relay"], 1.5 * 1.5);
        let (runs, since) = (2, Some(replaced()));
        let [for_it, _] = told(&diagnosis, "eb_relay");
        assert_eq!(for_it, [Known::Recurred { runs, since }]);
    }
}
