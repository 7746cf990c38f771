//! Repetitions of a procedure, reported as one procedure with the steps of all repetitions.

use btu_rig::procedure::{Finding, Findings, Outside, OutsideStep, RunEvent, Verdict};
use protocol::Instant;

/// Different results of repetitions that are kept; what went wrong in thousands is clear from the first few.
const KEPT: usize = 8;

/// Count of ended repetitions of a procedure, and their common verdict.
pub(super) struct RepetitionTally {
    of: u32,
    begun: bool,
    /// Number of repetitions that are over: the place of the present one, from 0.
    pub(super) over: u32,
    verdict: Verdict,
    findings: Vec<Findings>,
    /// Differing results beyond [`KEPT`].
    more: u32,
}

impl RepetitionTally {
    /// A tally of `of` repetitions, before the first.
    pub(super) fn new(of: u32) -> Self {
        Self {
            of,
            begun: false,
            over: 0,
            verdict: Verdict::Skipped,
            findings: Vec::new(),
            more: 0,
        }
    }

    pub(super) fn left(&self) -> bool {
        self.over < self.of
    }

    pub(super) fn passed(&self) -> bool {
        matches!(self.verdict, Verdict::Passed | Verdict::Skipped)
    }

    /// Events of the present repetition as events of the whole procedure: the procedure begins with the first
    /// repetition, and the end of each is kept for [`finished`](Self::finished). `goes_on` = the repetition is not
    /// over: one of its steps is begun again.
    pub(super) fn take(&mut self, event: RunEvent, goes_on: bool) -> Option<RunEvent> {
        match event {
            RunEvent::ProcedureStarted { steps, at } => {
                let steps = steps * self.of as usize;
                let first = !std::mem::replace(&mut self.begun, true);
                first.then_some(RunEvent::ProcedureStarted { steps, at })
            }
            RunEvent::ProcedureFinished {
                verdict, findings, ..
            } => {
                self.note(verdict, findings);
                self.over += u32::from(!goes_on);
                None
            }
            other => Some(other),
        }
    }

    /// Notes what failed between two repetitions, and returns the event that reports it.
    pub(super) fn outside(
        &mut self,
        place: Outside,
        verdict: Verdict,
        finding: Finding,
        at: Instant,
    ) -> RunEvent {
        self.note(verdict, finding.clone().into());
        RunEvent::OutsideStep(OutsideStep {
            place,
            verdict,
            finding,
            at,
        })
    }

    fn note(&mut self, verdict: Verdict, findings: Findings) {
        self.verdict = self.verdict.and(verdict);
        if findings.is_empty() || self.findings.contains(&findings) {
            return;
        }
        if self.findings.len() < KEPT {
            self.findings.push(findings);
        } else {
            self.more += 1;
        }
    }

    /// The end of the procedure; `link_lost` = nothing could be judged any more, so that a verdict on the unit becomes
    /// an error.
    pub(super) fn finished(self, link_lost: bool, at: Instant) -> RunEvent {
        let mut findings = Findings::default();
        for found in self.findings.iter().flat_map(Findings::iter) {
            findings.add(found.finding.clone(), found.times);
        }
        if self.more > 0 {
            findings.add(Finding::More { n: self.more }, 1);
        }
        RunEvent::ProcedureFinished {
            verdict: match self.verdict {
                Verdict::Failed | Verdict::Passed if link_lost => Verdict::Error,
                verdict => verdict,
            },
            findings,
            at,
        }
    }
}
