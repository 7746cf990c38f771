//! Where a procedure can be taken up again, as after a standstill of the tester's computer.

use std::sync::Arc;

use btu_rig::procedure::{Procedure, RunEvent, RunOptions, Verdict};

use super::workers::run_here;
use super::{BenchSetup, SessionEvent, Task};
use crate::stop::Stop;
use crate::test_support::{procedures, setup};

/// What does not pass when only the steps from `first` on are run.
fn not_passed(setup: &BenchSetup, procedure: &Arc<Procedure>, first: usize) -> Vec<String> {
    let task = Task {
        procedure: procedure.clone(),
        options: RunOptions {
            chosen: Some((first..procedure.steps.len()).collect()),
            ..RunOptions::default()
        },
    };
    let mut said = Vec::new();
    run_here(setup, &task, &Stop::default(), &mut |event| match event {
        SessionEvent::Run(RunEvent::StepFinished(step))
            if !matches!(step.verdict, Verdict::Passed | Verdict::Skipped) =>
        {
            said.push(format!("{}: {}", step.name, step.message));
        }
        SessionEvent::Run(RunEvent::ProcedureFinished { message, .. }) => {
            said.extend(Some(message).filter(|message| !message.is_empty()));
        }
        _ => {}
    });
    said
}

/// Goal: a step can be repeated after a new set-up, unless it says that it continues. Method: each procedure is run
/// from each such step to its end, on a good unit.
#[test]
fn every_step_that_does_not_continue_can_be_the_first() {
    let setup = setup(&[]);
    let mut wrong = Vec::new();
    for procedure in procedures(&setup) {
        for (first, step) in procedure.steps.iter().enumerate().skip(1) {
            if step.continues {
                continue;
            }
            let said = not_passed(&setup, &procedure, first);
            if !said.is_empty() {
                wrong.push(format!(
                    "{}#{first}@{} {}: {}",
                    procedure.id, step.line, step.name, said[0]
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{} {wrong:#?}", wrong.len());
}
