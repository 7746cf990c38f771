//! A stand-in for bench and unit whose signals the test sets by hand, and the run of one script on it.

use std::collections::BTreeMap;
use std::sync::Arc;

use btu_rig::procedure::link_trouble::LinkTrouble;
use btu_rig::procedure::loader::load;
use btu_rig::procedure::{
    Driver, EventSource, Evidence, Findings, Poll, Procedure, Refusal, RunEvent, RunOptions,
    Runner, StepResult, UnitEvent, Verdict,
};
use btu_rig::stimulus::Stimulus;
use btu_rig::train::TrainData;
use protocol::event::Event;
use protocol::message::{SelfTest, SelfTestItem};
use protocol::signal::{Sample, Signal};
use protocol::{Instant, SCAN};

/// Scans after which a run that does not end is a bug.
const MOST_SCANS: u32 = 60_000;

/// A step whose only check costs no time and passes on any data, for tests about something else.
const LOOK: &str =
    "def look(name, **more):\n    step(name, measure = value('looked', speed), **more)\n";

fn procedure(script: &str) -> Arc<Procedure> {
    let (unit, line) = crate::shipped();
    let scripts = BTreeMap::from([("test.star".to_owned(), format!("{LOOK}{script}"))]);
    let loaded = load(&scripts, &unit, &line, &TrainData::line6());
    assert!(loaded.errors.is_empty(), "{:?}", loaded.errors);
    Arc::clone(&loaded.procedures[0])
}

/// Records what is applied; says what it is told to.
#[derive(Debug, Default)]
pub struct Fake {
    pub applied: Vec<Stimulus>,
    pub refuse: bool,
    pub unsettled: bool,
    pub refusal: Option<&'static str>,
    /// Items of the self-test that the unit makes, all of them passed.
    pub self_test: SelfTest,
    pub made_safe: u32,
    pub never_safe: bool,
    pub evidence: Evidence,
}

impl Driver for Fake {
    fn apply(&mut self, _: Instant, stimulus: &Stimulus) -> Result<(), Refusal> {
        self.applied.push(*stimulus);
        if self.refuse {
            return Err(Refusal("unit refused arming: key_off".into()));
        }
        Ok(())
    }

    fn settled(&mut self) -> Result<bool, Refusal> {
        match self.refusal {
            Some(refusal) => Err(Refusal(refusal.to_owned())),
            None => Ok(!self.unsettled),
        }
    }

    fn self_test_item(&self, item: SelfTest) -> Option<SelfTestItem> {
        self.self_test.contains(item).then_some(SelfTestItem {
            item,
            passed: 1,
            ..SelfTestItem::default()
        })
    }

    fn make_safe(&mut self, _: Instant) {
        self.made_safe += 1;
    }

    fn safe(&self) -> bool {
        !self.never_safe
    }

    fn evidence(&self) -> Evidence {
        self.evidence
    }
}

/// State that a test may change before each scan.
pub struct World {
    pub scan: u32,
    pub sample: Sample,
    pub events: Vec<UnitEvent>,
    pub link_error: Option<LinkTrouble>,
    pub fake: Fake,
    pub runner: Runner,
}

impl World {
    pub fn ms(&self) -> u32 {
        self.scan * 10
    }

    pub fn log(&mut self, event: Event) {
        self.log_by(EventSource::Unit, event);
    }

    pub fn log_by(&mut self, source: EventSource, event: Event) {
        self.events.push(UnitEvent {
            source,
            ..UnitEvent::at_stand(0, event, 0)
        });
    }
}

pub struct Outcome {
    pub events: Vec<RunEvent>,
    pub fake: Fake,
    pub scans: u32,
}

impl Outcome {
    pub fn steps(&self) -> Vec<&StepResult> {
        let steps = self.events.iter().filter_map(|event| match event {
            RunEvent::StepFinished(result) => Some(result),
            _ => None,
        });
        steps.collect()
    }

    /// Name, verdict and message of each step.
    pub fn summary(&self) -> Vec<(&str, Verdict, &str)> {
        self.steps()
            .into_iter()
            .map(|r| (r.name.as_str(), r.verdict, told(&r.findings)))
            .collect()
    }

    /// Number of brakes and events of the unit that no step provoked.
    pub fn unsolicited(&self) -> usize {
        let told = self.events.iter().filter(|event| {
            matches!(
                event,
                RunEvent::UnsolicitedBrake { .. } | RunEvent::UnsolicitedEvent(_)
            )
        });
        told.count()
    }

    pub fn finished(&self) -> (Verdict, &str) {
        match self.events.last() {
            Some(RunEvent::ProcedureFinished {
                verdict, findings, ..
            }) => (*verdict, told(findings)),
            other => panic!("{other:?}"),
        }
    }
}

/// Options as ever but for this.
pub fn options(change: impl FnOnce(&mut RunOptions)) -> RunOptions {
    let mut options = RunOptions::default();
    change(&mut options);
    options
}

pub fn run_with(script: &str, options: RunOptions, each_scan: impl FnMut(&mut World)) -> Outcome {
    run_round(script, options, 0, each_scan)
}

pub fn run_round(
    script: &str,
    options: RunOptions,
    round: u32,
    mut each_scan: impl FnMut(&mut World),
) -> Outcome {
    let procedure = procedure(script);
    let mut sample = Sample::default();
    sample.set(Signal::Eb, 0.0);
    sample.set(Signal::Speed, 0.0);
    let mut world = World {
        scan: 0,
        sample,
        events: Vec::new(),
        link_error: None,
        fake: Fake::default(),
        runner: Runner::new(procedure.clone(), options.clone(), round),
    };
    let mut events = Vec::new();
    for scan in 0..MOST_SCANS {
        world.scan = scan;
        (world.events, world.link_error) = (Vec::new(), None);
        each_scan(&mut world);
        let (runner, link_error) = (&mut world.runner, world.link_error.as_ref());
        let now = Instant::from_us(u64::from(scan) * SCAN.as_us());
        let poll = runner.advance(
            now,
            &world.sample,
            &world.events,
            link_error,
            &mut world.fake,
        );
        events.extend(runner.take_events());
        if poll == Poll::Done {
            let Some(rest) = runner.to_be_resumed().cloned() else {
                return Outcome {
                    events,
                    fake: world.fake,
                    scans: scan,
                };
            };
            *runner = Runner::resumed(procedure.clone(), options.clone(), round, rest);
        }
    }
    panic!("the run does not end: {:?}", events.last());
}

pub fn run(script: &str, each_scan: impl FnMut(&mut World)) -> Outcome {
    run_with(script, RunOptions::default(), each_scan)
}

pub const HEAD: &str =
    "procedure(title = 'x', setup = [cab.key(True)], cleanup = [cab.key(False)])\n";
pub const ON: Stimulus = Stimulus::MaintenanceKey { on: true };
pub const OFF: Stimulus = Stimulus::MaintenanceKey { on: false };

/// Findings as the English text that tests compare.
fn told(findings: &Findings) -> &'static str {
    findings.to_string().leak()
}
