//! What the tests of this crate begin with: the scripts of this repository, benches of its defaults, and a listener.

use std::path::Path;
use std::sync::Arc;

use btu_rig::procedure::{Procedure, RunEvent, StepResult, Verdict, loader};

use crate::data::ScriptsDirectory;
use crate::run::{BenchChoice, BenchSetup, SessionEvent};

/// `scripts/` of this repository.
pub fn scripts() -> ScriptsDirectory {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts");
    ScriptsDirectory::find(Some(&path)).expect("scripts")
}

/// A bench of the defaults, these faults injected.
pub fn setup(faults: &[&str]) -> BenchSetup {
    let choice = BenchChoice {
        faults: faults.iter().map(|fault| (*fault).to_owned()).collect(),
        ..BenchChoice::default()
    };
    choice.setup(&scripts()).expect("a bench")
}

pub fn procedures(setup: &BenchSetup) -> Vec<Arc<Procedure>> {
    let texts = scripts().procedures().expect("procedures");
    let (config, line) = (&setup.config.content, &setup.line.content);
    loader::load(&texts, config, line, &setup.train).procedures
}

/// Events of a procedure, gathered.
#[derive(Default)]
pub struct Heard {
    pub steps: Vec<StepResult>,
    /// Name, part and finding of each fault.
    pub faults: Vec<String>,
    pub verdict: Option<Verdict>,
    /// Findings of the whole procedure.
    pub message: String,
}

impl Heard {
    pub fn take(&mut self, event: SessionEvent) {
        match event {
            SessionEvent::Run(RunEvent::StepFinished(step)) => self.steps.push(step),
            SessionEvent::Run(RunEvent::ProcedureFinished {
                verdict, findings, ..
            }) => (self.verdict, self.message) = (Some(verdict), findings.to_string()),
            SessionEvent::Fault(fault) => {
                let told = format!("{} {:?}: {}", fault.name, fault.lru, fault.finding);
                self.faults.push(told);
            }
            _ => {}
        }
    }

    /// All that a good unit would not say; `is_due` tells which steps that did not pass are as they should be.
    pub fn amiss(&self, is_due: impl Fn(&StepResult) -> bool) -> Vec<String> {
        let steps = self.steps.iter();
        let steps = steps.filter(|step| step.verdict != Verdict::Passed && !is_due(step));
        let steps =
            steps.map(|step| format!("line {}, {}: {}", step.line, step.name, step.findings));
        let message = Some(self.message.clone()).filter(|message| !message.is_empty());
        steps.chain(message).chain(self.faults.clone()).collect()
    }
}
