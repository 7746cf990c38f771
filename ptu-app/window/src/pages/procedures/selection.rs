//! The selected procedures and steps.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use btu_rig::procedure::plan::Connection;
use btu_rig::procedure::{Procedure, PromptPolicy, RunOptions, Verdict};
use protocol::{Duration, LruId};

use ptu_runs::bench_worker::Progress;
use ptu_runs::run::Task;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Share {
    None,
    Some,
    All,
}

/// Whether a procedure can run over a connection: a procedure for the bench needs the bench's harness.
pub fn possible(procedure: &Procedure, connection: Connection) -> bool {
    procedure.needs.lacks(connection).is_none()
}

/// Names of the chosen steps of each procedure; names stay valid when scripts are loaded again.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection(BTreeMap<String, BTreeSet<String>>);

impl Selection {
    /// Procedures of a run without names: all that this connection can do, except those on request
    /// only.
    pub fn usual(procedures: &[Arc<Procedure>], connection: Connection) -> Self {
        let mut usual = Self::default();
        for procedure in procedures {
            if possible(procedure, connection) && !procedure.on_request {
                usual.set(procedure, true);
            }
        }
        usual
    }

    /// Procedures that show whether a repair of `part` holds: the failed ones, and those with a step that suspects it.
    pub fn proof(
        procedures: &[Arc<Procedure>],
        connection: Connection,
        failed: &BTreeSet<String>,
        part: &str,
    ) -> Self {
        let is_it = |suspect: &Option<LruId>| suspect.as_ref().is_some_and(|lru| *lru == *part);
        let mut proof = Self::default();
        for procedure in procedures {
            let suspects = is_it(&procedure.suspect)
                || procedure.steps.iter().any(|step| is_it(&step.suspect));
            let wanted = failed.contains(&procedure.id) || suspects && !procedure.on_request;
            if possible(procedure, connection) && wanted {
                proof.set(procedure, true);
            }
        }
        proof
    }

    /// One step of a procedure; nothing if the procedure has no step of this name.
    pub fn only(procedure: &Procedure, step: &str) -> Self {
        let mut only = Self::default();
        if let Some(place) = procedure.steps.iter().position(|known| known.name == step) {
            only.set_step(procedure, place, true);
        }
        only
    }

    /// Rest of a run that broke off: from the procedure under way, which is set up again, the broken-off step and the
    /// steps after it; and all procedures still to come.
    pub fn rest(run: &Progress) -> Self {
        let mut rest = Self::default();
        for of in &run.procedures {
            let is_told = |verdict: Verdict| !matches!(verdict, Verdict::Error | Verdict::Aborted);
            if of.verdict.is_some_and(is_told) {
                continue;
            }
            let told = |place: &usize| {
                let mut results = of.results.iter().filter(|step| step.index == *place);
                results.any(|step| is_told(step.verdict) && step.verdict != Verdict::Skipped)
            };
            for place in of.chosen.iter().skip_while(|place| told(place)) {
                rest.set_step(&of.procedure, *place, true);
            }
        }
        rest
    }

    pub fn share(&self, procedure: &Procedure) -> Share {
        let chosen = self.places(procedure).len();
        match chosen {
            0 => Share::None,
            all if all == procedure.steps.len() => Share::All,
            _ => Share::Some,
        }
    }

    /// Share of several procedures that is chosen.
    pub fn share_of<'a>(&self, procedures: impl IntoIterator<Item = &'a Arc<Procedure>>) -> Share {
        let mut shares = procedures
            .into_iter()
            .map(|procedure| self.share(procedure));
        let first = shares.next().unwrap_or(Share::None);
        shares.fold(
            first,
            |all, share| if all == share { all } else { Share::Some },
        )
    }

    pub fn has(&self, procedure: &Procedure, step: usize) -> bool {
        let name = procedure.steps.get(step).map(|step| &step.name);
        let chosen = self.0.get(&procedure.id);
        name.zip(chosen)
            .is_some_and(|(name, chosen)| chosen.contains(name))
    }

    /// Chooses a whole procedure, or nothing of it.
    pub fn set(&mut self, procedure: &Procedure, on: bool) {
        if on {
            let names = procedure.steps.iter().map(|step| step.name.clone());
            self.0.insert(procedure.id.clone(), names.collect());
        } else {
            self.0.remove(&procedure.id);
        }
    }

    /// Chooses a step, or not.
    pub fn set_step(&mut self, procedure: &Procedure, step: usize, on: bool) {
        let Some(step) = procedure.steps.get(step) else {
            return;
        };
        let chosen = self.0.entry(procedure.id.clone()).or_default();
        if on {
            chosen.insert(step.name.clone());
        } else {
            chosen.remove(&step.name);
        }
    }

    /// Tasks for the chosen steps, in order; procedures without a chosen step are left out.
    pub fn tasks(
        &self,
        procedures: &[Arc<Procedure>],
        repeat: u32,
        stop_on_fail: bool,
    ) -> Vec<Task> {
        let task = |procedure: &Arc<Procedure>| {
            let places = self.places(procedure);
            (!places.is_empty()).then(|| Task {
                procedure: procedure.clone(),
                options: RunOptions {
                    chosen: (places.len() < procedure.steps.len()).then_some(places),
                    repeat,
                    stop_on_fail,
                    prompts: PromptPolicy::Ask,
                    ..RunOptions::default()
                },
            })
        };
        procedures.iter().filter_map(task).collect()
    }

    /// Number of chosen steps, and their worst-case time without repetition.
    pub fn extent(&self, procedures: &[Arc<Procedure>]) -> (usize, Duration) {
        procedures
            .iter()
            .flat_map(|procedure| {
                let places = self.places(procedure).into_iter();
                places.filter_map(|place| procedure.steps.get(place))
            })
            .fold((0, Duration::ZERO), |(steps, time), step| {
                (steps + 1, time + step.worst_case)
            })
    }

    /// Indices of a procedure's chosen steps.
    fn places(&self, procedure: &Procedure) -> Vec<usize> {
        (0..procedure.steps.len())
            .filter(|place| self.has(procedure, *place))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ptu_runs::data::ScriptsDirectory;
    use ptu_runs::run::{BenchChoice, Suite};

    fn procedures() -> Vec<Arc<Procedure>> {
        let scripts = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts");
        let directory = ScriptsDirectory::find(Some(&scripts)).expect("scripts");
        let setup = BenchChoice::default().setup(&directory).expect("setup");
        Suite::load(&directory, &[], &setup)
            .expect("suite")
            .procedures
    }

    #[test]
    fn everything_but_what_is_on_request_is_chosen_at_first() {
        let procedures = procedures();
        let usual = Selection::usual(&procedures, Connection::Btu);
        for procedure in &procedures {
            let expected = if procedure.on_request {
                Share::None
            } else {
                Share::All
            };
            assert_eq!(usual.share(procedure), expected, "{}", procedure.id);
        }
        let tasks = usual.tasks(&procedures, 1, false);
        assert!(tasks.iter().all(|task| task.options.chosen.is_none()));
        assert_eq!(
            usual.extent(&procedures).0,
            tasks
                .iter()
                .map(|task| task.procedure.steps.len())
                .sum::<usize>()
        );
    }

    #[test]
    fn a_laptop_runs_the_procedures_that_need_no_bench() {
        let procedures = procedures();
        let usual = Selection::usual(&procedures, Connection::Ptu);
        let tasks = usual.tasks(&procedures, 1, false);
        assert!(!tasks.is_empty());
        let ptu = |task: &Task| task.procedure.needs == Connection::Ptu;
        assert!(tasks.iter().all(ptu));
    }

    #[test]
    fn one_step_left_out_is_not_run_and_stays_out_when_scripts_are_loaded_again() {
        let before = procedures();
        let mut selection = Selection::default();
        selection.set(&before[0], true);
        selection.set_step(&before[0], 1, false);
        let again = procedures();
        assert_eq!(selection.share(&again[0]), Share::Some);
        let tasks = selection.tasks(&again, 3, true);
        assert_eq!(tasks.len(), 1);
        let chosen = tasks[0].options.chosen.clone().expect("chosen");
        assert!(!chosen.contains(&1) && chosen.len() == again[0].steps.len() - 1);
        assert_eq!(tasks[0].options.repeat, 3);
    }

    #[test]
    fn a_step_that_is_not_there_chooses_nothing() {
        let procedures = procedures();
        let only = Selection::only(&procedures[0], "no such step");
        assert!(only.tasks(&procedures, 1, false).is_empty());
        assert_eq!(only.share_of(&procedures), Share::None);
    }
}
