//! Conclusions of a diagnosis, their reasons and warnings: a sentence in both languages for each kind.

use diagnosis::{CheckName, FaultText, NextCheck, Reason};
use fault_db::RunDetail;
use protocol::LruId;
use protocol::injection::Lru;
use ptu_runs::run_diagnosis::Answer;

use super::super::Words;
use super::both::checked;
use super::conclusion::{all_called, concluded, tells};
use super::reasons::{
    deviated, deviated_share, fault_text, logged, step_expected, step_found, told,
};

impl Words {
    /// Conclusion of a diagnosis, and the next check.
    pub fn concluded(&self, answer: &Answer) -> String {
        let diagnosis = &answer.diagnosis;
        let next = diagnosis.next_check.as_ref();
        self.choose(concluded(&diagnosis.conclusion, next, &answer.names))
    }

    /// Parts by name alone, within a sentence.
    pub fn parts(&self, parts: &[LruId], names: &[Lru]) -> String {
        self.choose(all_called(parts, names))
    }

    /// What a check would tell, as text; empty if that is not known.
    pub fn tells(&self, next: &NextCheck, names: &[Lru]) -> String {
        self.choose(tells(next, names))
    }

    /// Procedure and step.
    pub fn check(&self, check: &CheckName) -> String {
        self.choose(checked(check))
    }

    /// Sentence that says what is wrong under a fault.
    pub fn fault_text(&self, text: &FaultText) -> String {
        self.choose(fault_text(text))
    }

    /// A reason in short, with what its step found in the run.
    pub fn reason(&self, reason: &Reason, run: &RunDetail) -> String {
        let procedure = reason.step().map(|check| &check.procedure);
        let path = procedure.map_or_else(String::new, |procedure| format!("{procedure}: "));
        path + &self.reason_in_procedure(reason, run)
    }

    /// Reason as text, without the path of its procedure.
    pub fn reason_in_procedure(&self, reason: &Reason, run: &RunDetail) -> String {
        self.choose(match reason {
            Reason::Step(step) => step_found(step, run),
            Reason::Logged(sign) => logged(sign),
            Reason::Deviated { signal, .. } => deviated(signal),
            Reason::Known(known) => told(known),
        })
    }

    /// A reason compared with the fault dictionary; `None` for a reason on which the dictionary says nothing.
    pub fn reason_detail(&self, reason: &Reason) -> Option<String> {
        match reason {
            Reason::Step(step) => Some(self.choose(step_expected(step))),
            Reason::Deviated { signal, shares } => {
                Some(self.choose(deviated_share(signal, *shares)))
            }
            Reason::Logged(_) | Reason::Known(_) => None,
        }
    }
}
