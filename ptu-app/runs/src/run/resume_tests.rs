//! Every step of every procedure can be repeated when the tester's computer stood still in it.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};

use btu_rig::procedure::{Procedure, RunEvent, Runner, Verdict};
use btu_rig::rig::Rig;
use fuzzing::draw;
use protocol::{Duration, Instant};

use super::workers::{TO_THE_END, run_on_fresh};
use super::{BenchSetup, RunControl, SessionEvent, Task};
use crate::stop::Stop;
use crate::test_support::{Heard, procedures, setup};

/// Stands still once in each step, so many scans after it began, if it lasts so long.
struct StandsStill {
    after: u32,
    seen: Mutex<Seen>,
}

#[derive(Default)]
struct Seen {
    /// Steps that began, by their name.
    begun: BTreeSet<String>,
    /// Scans until the present one, which began for the first time, is spoiled.
    scans_left: Option<u32>,
}

impl RunControl for StandsStill {
    fn before_scan(&self, runner: &mut Runner) {
        let mut seen = self.seen.lock().expect("steps");
        seen.scans_left = match seen.scans_left {
            Some(1) => {
                runner.stood_still(Duration::from_ms(300));
                None
            }
            left => left.map(|left| left - 1),
        };
    }

    fn after_cycle(&self, _: Instant, _: &Rig) {}
}

impl StandsStill {
    fn take(&self, event: &RunEvent) {
        let mut seen = self.seen.lock().expect("steps");
        match event {
            RunEvent::StepStarted { name, .. } => {
                let first = seen.begun.insert(name.clone());
                seen.scans_left = first.then_some(self.after);
            }
            RunEvent::StepFinished(_) => seen.scans_left = None,
            _ => {}
        }
    }
}

/// Differences from a run in which the computer did not stand still.
fn amiss(setup: &mut BenchSetup, procedure: &Arc<Procedure>, after: u32) -> Vec<String> {
    let stands_still = Arc::new(StandsStill {
        after,
        seen: Mutex::default(),
    });
    setup.run_control = Some(stands_still.clone());
    let task = Task::from(procedure.clone());
    let mut heard = Heard::default();
    let mut sink = |event| {
        if let SessionEvent::Run(event) = &event {
            stands_still.take(event);
        }
        heard.take(event);
    };
    run_on_fresh(setup, &task, &Stop::default(), &mut sink, &TO_THE_END);
    heard.amiss(|step| step.verdict == Verdict::Skipped)
}

/// Goal: a step that is repeated after a new set-up finds the state it needs: it says if it continues from the one
/// before. Method: each procedure on a good unit, and the computer stands still in each of its steps, early or, in the long
/// suite, after a second.
#[test]
fn every_step_can_be_repeated() {
    every_step_repeated(1);
}

#[test]
#[ignore = "long suite: the same a second into each step"]
fn every_step_can_be_repeated_once_it_is_under_way() {
    every_step_repeated(100);
}

fn every_step_repeated(after: u32) {
    let mut setup = setup(&[]);
    let mut wrong = Vec::new();
    for procedure in draw::drawn(procedures(&setup), 3) {
        let said = amiss(&mut setup, &procedure, after);
        if !said.is_empty() {
            wrong.push(format!("{}: {said:#?}", procedure.id));
        }
    }
    assert!(wrong.is_empty(), "{after} scans: {}", wrong.join("\n"));
}
