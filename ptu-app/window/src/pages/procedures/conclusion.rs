//! Conclusion of an ended run: its diagnosis, or its proof of earlier repairs.

use std::sync::Arc;

use super::ProceduresPage;
use crate::PageContext;
use crate::request::Request;
use ptu_report::proof_text;
use ptu_runs::failure::Exit;
use ptu_runs::run_diagnosis::{Answer, RepairProof, diagnose_run, prove_repairs};
use ptu_runs::stored::findings;

/// Conclusion of an ended run.
pub struct Concluded {
    /// Conclusion of the diagnosis, or what the run says about earlier repairs.
    pub text: String,
    /// The diagnosis of a run that failed.
    pub answer: Option<Arc<Answer>>,
    /// Proofs of repairs by a run that passed.
    pub proofs: Vec<RepairProof>,
}

impl ProceduresPage {
    /// Requests the diagnosis of a failed run, or what a passed run says about earlier repairs.
    pub(super) fn conclude(&mut self, context: &PageContext<'_>) {
        self.conclusion.poll();
        self.traced.poll();
        let run = context.units.chosen().run.as_ref();
        let Some(outcome) = run.and_then(|run| run.ended.as_ref()?.as_ref()) else {
            return;
        };
        if self.concluded == Some(outcome.id) {
            return;
        }
        self.concluded = Some(outcome.id);
        let id = outcome.id;
        self.traced = Request::Pending(context.queries.run(move |paths| {
            let seen = paths.read()?.run_occurrences(id)?.into_iter();
            let traced = seen.filter_map(|seen| Some((findings(&seen.findings), seen.trace_id?)));
            Ok(traced.collect())
        }));
        self.conclusion = match outcome.exit {
            Exit::Failed => {
                let words = context.words;
                Request::Pending(context.queries.run(move |paths| {
                    let store = paths.open()?;
                    let answer = diagnose_run(&store, &paths.scripts, id)?;
                    let conclusion = words.concluded(&answer);
                    let text = match answer.attribute(&store) {
                        Ok(()) => conclusion,
                        // The part is told even though it could not be stored as the cause of the faults.
                        Err(failure) => {
                            format!("{conclusion} ({})", words.trouble(&failure.message))
                        }
                    };
                    Ok(Concluded {
                        text,
                        answer: Some(Arc::new(answer)),
                        proofs: Vec::new(),
                    })
                }))
            }
            Exit::Passed => {
                let words = context.words;
                Request::Pending(context.queries.run(move |paths| {
                    let proofs = prove_repairs(&paths.open()?, &paths.scripts, id)?;
                    Ok(Concluded {
                        text: proof_text(&proofs, words),
                        answer: None,
                        proofs,
                    })
                }))
            }
            _ => Request::Idle,
        };
    }
}
