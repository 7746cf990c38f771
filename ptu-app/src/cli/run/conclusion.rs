//! Conclusions of a run beyond its verdict: the diagnosis, and the proof of repairs.

use std::collections::BTreeSet;

use fault_db::{RunDetail, Store, Verdict};

use super::RunArguments;
use crate::cli::print_out;
use ptu_report::diagnosis::diagnosis_text;
use ptu_report::words::{Words, fill};
use ptu_report::{Departure, proof_text};
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::run::Outcome;
use ptu_runs::run_diagnosis::{Answer, RepairProof, diagnose_run};
use ptu_runs::stdio;

impl RunArguments {
    /// The diagnosis of an adaptive run, and of any other run that failed.
    pub(super) fn diagnosis(
        &self,
        store: &Store,
        directory: &ScriptsDirectory,
        outcome: &Outcome,
    ) -> Option<Result<Answer, Failure>> {
        let is_begun = outcome.prevented.is_none();
        let is_wanted = self.adaptive && is_begun || outcome.exit == Exit::Failed;
        is_wanted.then(|| diagnose_run(store, directory, outcome.id))
    }

    /// Prints the diagnosis of an adaptive run, or the conclusion of any other failed run; no conclusion if the
    /// dictionary was not made with these scripts.
    pub(super) fn say_diagnosis(&self, answer: Result<Answer, Failure>) -> Result<(), Failure> {
        let words = Words::shown();
        if self.adaptive {
            let answer = answer?;
            let warnings = answer.warnings.iter();
            warnings.for_each(|warning| stdio::note(&words.told(warning)));
            print_out(&format!("\n{}", diagnosis_text(&answer, false, words)))?;
        } else if let Ok(answer) = answer
            && answer.warnings.is_empty()
        {
            let run = answer.run.run.id.short();
            let why = fill(words.terminal.after_run, &[("run", &run)]);
            print_out(&format!("\n{}{why}", words.concluded(&answer)))?;
        }
        Ok(())
    }
}

/// Prints until when a departure test holds, or why it does not hold; after a failed test also how to find the part.
pub(super) fn say_validity(run: &RunDetail) -> Result<(), Failure> {
    let Some(departure) = Departure::of(run) else {
        return Ok(());
    };
    let words = Words::shown();
    let (name, value) = departure.fact(words);
    let between = match departure.why_not.is_empty() {
        true => " ",
        false => ": ",
    };
    print_out(&format!("{name}{between}{value}"))?;
    if run.run.verdict == Some(Verdict::Failed) {
        let parts = run.faults.iter().map(|fault| words.part(&fault.lru));
        let parts: BTreeSet<_> = parts.collect();
        let parts = parts.into_iter().collect::<Vec<_>>().join(", ");
        let said = fill(words.terminal.departure_goes_on, &[("parts", &parts)]);
        print_out(&said)?;
    }
    Ok(())
}

/// Prints which earlier repairs a passed run proves.
pub(super) fn say_proofs(proofs: &[RepairProof]) -> Result<(), Failure> {
    if !proofs.is_empty() {
        let words = Words::shown();
        let said = proof_text(proofs, words);
        let proved = proofs.iter().find(|proof| proof.says.is_proven());
        let sheet = proved.map_or_else(String::new, |proof| {
            let fault = proof.fault.short();
            fill(words.terminal.case_sheet, &[("fault", &fault)]) + "\n"
        });
        print_out(&format!("{said}\n{sheet}"))?;
    }
    Ok(())
}
