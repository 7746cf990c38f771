//! Reads the streams of the procedures in order, numbers steps and faults through the run, passes
//! them to the store and to the listener, and computes the verdict of the run.

use btu_rig::procedure::{Finding, Outside, OutsideStep, Procedure, RunEvent, StepResult, Verdict};
use btu_rig::recorder::RecordedWindow;
use btu_rig::rig::LinkTrouble;
use fault_db::{Id, RecordingRecord, StepCounter, StepCounts, StepRecord};
use protocol::{Duration, Instant};

use super::bench_contents::BenchContents;
use super::event::{RecordedStimuli, SessionEvent};
use super::fault_watch::FaultSeen;
use super::run_start::RunStart;
use super::store_thread::{Entry, LinePrinter, RunStore};
use super::trace_data::trace_data;
use crate::failure::{Exit, Failure, Trouble, prevented_by};
use crate::stored::{WHOLE_RUN, fault_record, outside_record, step_record, stored, whole_run};

/// Receives the events of a run while it goes on.
pub trait Listener {
    /// Called for each event of `procedure`.
    fn on_event(&mut self, procedure: &Procedure, event: &SessionEvent);

    /// The line to print once everything recorded before the event is in the file.
    fn line(&self, _procedure: &Procedure, _event: &SessionEvent) -> Option<String> {
        None
    }

    /// What prints the lines of [`Listener::line`].
    fn line_printer(&self) -> Option<LinePrinter> {
        None
    }
}

/// Events are not shown.
impl Listener for () {
    fn on_event(&mut self, _: &Procedure, _: &SessionEvent) {}
}

#[derive(Clone, Debug)]
pub struct Outcome {
    pub id: Id,
    /// Verdict over all procedures.
    pub verdict: Verdict,
    /// Bench time of all procedures.
    pub bench_time: Duration,
    /// Exit code that goes with the verdict.
    pub exit: Exit,
    /// Why the history does not hold the run, and where the run is kept.
    pub lost: Option<Trouble>,
    /// Why nothing was begun.
    pub prevented: Option<Trouble>,
    /// How many of the run's steps were due, passed, failed and so on.
    pub counts: StepCounts,
}

/// Takes what the benches of a run say, and has it stored and shown.
pub struct Collector<'a> {
    store: RunStore,
    began: RunStart,
    listener: &'a mut dyn Listener,
    made: BenchContents,
    /// Place of the present procedure in the run, counted from 1.
    ordinal: u32,
    procedure: Option<std::sync::Arc<Procedure>>,
    /// Bench time of the procedures before the present one.
    before: Duration,
    steps: u32,
    steps_before: u32,
    /// Bench time and date of each fault of the run.
    dates: Vec<(i64, i64)>,
    faults_before: usize,
    verdict: Verdict,
    /// Failures outside the steps of the present procedure, stored after its last step, so that the places of
    /// steps stay.
    outside: Vec<OutsideStep>,
    /// A record of the present procedure did not pass, and so says why the procedure failed.
    says_why: bool,
    run_says_why: bool,
    /// Procedures that ran to their end.
    finished: u32,
    /// Different steps that are due.
    planned: usize,
    /// The run searches for a fault: if it passes without all steps, the unit is not accepted.
    search: bool,
    /// Steps by procedure and place in it.
    counter: StepCounter<(String, usize)>,
    link_lost: Option<LinkTrouble>,
    /// The tester itself could not go on.
    broken_off: bool,
}

impl<'a> Collector<'a> {
    /// A collector that records in `store` a run in which `planned` different steps are due; `search` = only as many of
    /// them as it takes to find a fault.
    pub fn new(
        store: RunStore,
        began: RunStart,
        listener: &'a mut dyn Listener,
        made: BenchContents,
        (planned, search): (usize, bool),
    ) -> Self {
        Self {
            store,
            began,
            listener,
            made,
            ordinal: 0,
            procedure: None,
            before: Duration::ZERO,
            steps: 0,
            steps_before: 0,
            dates: Vec::new(),
            faults_before: 0,
            verdict: Verdict::Skipped,
            outside: Vec::new(),
            says_why: false,
            run_says_why: false,
            finished: 0,
            planned,
            search,
            counter: StepCounter::default(),
            link_lost: None,
            broken_off: false,
        }
    }

    /// The next stream is of this procedure; it is empty if the procedure was due and not begun.
    pub fn begin(&mut self, procedure: &std::sync::Arc<Procedure>) {
        self.procedure = Some(procedure.clone());
        self.ordinal += 1;
        self.steps_before = self.steps;
        self.faults_before = self.dates.len();
        self.says_why = false;
    }

    /// The present procedure was due and not begun, because the run was stopped.
    pub fn not_begun(&mut self, verdict: Verdict, why: Finding) {
        let Some(procedure) = self.procedure.clone() else {
            return;
        };
        let entry = OutsideStep {
            place: Outside::NotBegun,
            verdict,
            finding: Finding::NotBegun(Box::new(why)),
            at: Instant::ZERO,
        };
        for event in [
            RunEvent::OutsideStep(entry.clone()),
            RunEvent::ProcedureFinished {
                verdict,
                findings: entry.finding.clone().into(),
                at: entry.at,
            },
        ] {
            self.listener
                .on_event(&procedure, &SessionEvent::Run(event));
        }
        self.outside.push(entry);
        self.store_outside(&procedure.id);
    }

    /// The run cannot go on; what was said of the present procedure stays.
    pub fn broken_off(&mut self, why: Finding) {
        self.say_of_whole(Verdict::Error, why);
    }

    /// Nothing could be begun.
    pub fn prevented(&mut self, failure: &Failure) {
        self.verdict = match failure.exit {
            Exit::Aborted => Verdict::Aborted,
            _ => Verdict::Error,
        };
        let finding = match failure.message.of_the_bench() {
            Some(why) => {
                let lost = SessionEvent::LinkLost(why.clone());
                self.listener.on_event(&whole_run(), &lost);
                self.link_lost = Some(why.clone());
                Finding::LinkLost { why: why.clone() }
            }
            None => prevented_by(&failure.message),
        };
        self.say(Outside::Bench, self.verdict, finding);
    }

    /// Records a finding on the run as a whole, and tells it to the listener.
    fn say_of_whole(&mut self, verdict: Verdict, finding: Finding) {
        self.say(Outside::Whole, verdict, finding);
    }

    fn say(&mut self, place: Outside, verdict: Verdict, finding: Finding) {
        let entry = OutsideStep {
            place,
            verdict,
            finding,
            at: Instant::ZERO,
        };
        let event = SessionEvent::Run(RunEvent::OutsideStep(entry.clone()));
        self.listener.on_event(&whole_run(), &event);
        self.outside.push(entry);
        self.run_says_why = true;
    }

    /// Whether the present procedure ran to its end.
    pub fn is_finished(&self) -> bool {
        self.finished == self.ordinal
    }

    /// The next event of the present procedure.
    pub fn take(&mut self, event: SessionEvent) {
        let Some(procedure) = self.procedure.clone() else {
            return;
        };
        if let SessionEvent::Run(RunEvent::ProcedureFinished {
            verdict,
            findings,
            at,
        }) = &event
            && !is_passed(*verdict)
            && !self.says_why
        {
            for found in findings.iter() {
                self.take(SessionEvent::Run(RunEvent::OutsideStep(OutsideStep {
                    place: Outside::Whole,
                    verdict: *verdict,
                    finding: found.finding.clone(),
                    at: *at,
                })));
            }
        }
        self.listener.on_event(&procedure, &event);
        let line = self.listener.line(&procedure, &event);
        match event {
            SessionEvent::Run(RunEvent::StepFinished(result)) => self.step(&procedure, result),
            SessionEvent::Run(RunEvent::OutsideStep(entry)) => {
                self.says_why = true;
                self.outside.push(entry);
            }
            SessionEvent::Run(RunEvent::ProcedureFinished { verdict, .. }) => {
                self.finished += 1;
                self.verdict = self.verdict.and(verdict);
                self.store_outside(&procedure.id);
            }
            SessionEvent::Run(_) | SessionEvent::Rows(_) => {}
            SessionEvent::LinkLost(why) => self.link_lost = Some(why),
            SessionEvent::Fault(fault) => self.fault(fault),
            SessionEvent::Trace(cut) => self.trace(&cut),
            SessionEvent::Recording(stimuli) => self.recording(&procedure.id, &stimuli),
            SessionEvent::Ended { bench_time } => self.before += bench_time,
        }
        if let Some(line) = line {
            self.store.record(Entry::Say(line));
        }
    }

    /// Verdict of the run from the verdicts of its procedures. A stop or a lost link outranks them:
    /// what was not tested is no verdict on the unit.
    fn overall(&self) -> Verdict {
        match self.verdict {
            Verdict::Aborted => Verdict::Aborted,
            _ if self.link_lost.is_some() || self.broken_off => Verdict::Error,
            // Nothing ran: nothing was tested.
            Verdict::Skipped => Verdict::Error,
            verdict => verdict,
        }
    }

    /// The place of the next record, which has this verdict.
    fn next_index(&mut self, verdict: Verdict) -> u32 {
        self.says_why |= !is_passed(verdict);
        self.run_says_why |= !is_passed(verdict);
        self.steps += 1;
        self.steps - 1
    }

    /// Stores what failed outside the steps of a procedure, in the order in which it did.
    fn store_outside(&mut self, procedure: &str) {
        for entry in std::mem::take(&mut self.outside) {
            let index = self.next_index(entry.verdict);
            self.counter.note_outside(stored(entry.verdict));
            let at = self.before + Duration::from_us(entry.at.as_us());
            let record = outside_record(procedure, &entry, at.as_us() as i64);
            (self.store).record(Entry::Step(StepRecord { index, ..record }));
        }
    }

    fn step(&mut self, procedure: &Procedure, result: StepResult) {
        let index = self.next_index(result.verdict);
        let step = (procedure.id.clone(), result.index);
        self.counter.note(step, stored(result.verdict));
        let started = self.before + Duration::from_us(result.started.as_us());
        let record = step_record(&procedure.id, result, started.as_us() as i64);
        (self.store).record(Entry::Step(StepRecord { index, ..record }));
    }

    fn fault(&mut self, fault: FaultSeen) {
        let bench_us = (self.before.as_us() + fault.at.as_us()) as i64;
        // The bench's virtual time runs ahead of the day; a fault is dated when it is found.
        let at_us = self.began.now_us();
        self.dates.push((bench_us, at_us));
        let step_index = fault.step.map(|turn| self.steps_before + turn as u32);
        let record = fault_record(fault, at_us, bench_us, step_index);
        self.store.record(Entry::Fault(record));
    }

    fn trace(&mut self, cut: &RecordedWindow) {
        let mut trace = trace_data(cut);
        trace.t0_bench_us += self.before.as_us() as i64;
        let faults: Vec<_> = (cut.faults.iter())
            .map(|number| self.faults_before + number)
            .collect();
        let date = faults.first().and_then(|number| self.dates.get(*number));
        // Without a fault a trace is dated by its end, which is now.
        let length_us = trace.period_us * cut.rows.len() as i64;
        trace.t0_us = match date {
            Some((bench_us, at_us)) => at_us - (bench_us - trace.t0_bench_us),
            None => self.began.now_us() - length_us,
        };
        self.store.record(Entry::Trace(faults, trace));
    }

    fn recording(&mut self, procedure: &str, stimuli: &RecordedStimuli) {
        let recording = self.made.recording(procedure, stimuli);
        self.store.record(Entry::Recording(RecordingRecord {
            ordinal: self.ordinal,
            t0_bench_us: self.before.as_us() as i64,
            ..recording
        }));
    }

    /// The end of all streams; `stopped` = verdict on the procedures that were still due: somebody pressed stop, or the
    /// tester itself could not go on.
    ///
    /// These procedures were not tested, so that what came before them is no verdict on the unit. `stopped` does not
    /// count in a run that was over by then: nothing is due after a failure that ends the run.
    pub fn finish(mut self, id: Id, stopped: Option<Verdict>) -> (RunStore, Outcome) {
        if let Some(verdict) = stopped
            && !self.is_finished()
        {
            self.verdict = self.verdict.and(verdict);
        }
        self.broken_off = stopped == Some(Verdict::Error) && self.verdict == Verdict::Error;
        let mut verdict = self.overall();
        let counts = self.counter.counts(self.planned);
        let (run, of, left) = (counts.run(), counts.planned, counts.not_run());
        if let Some(why) = self.link_lost.take().filter(|_| left > 0) {
            let instrument = match why {
                LinkTrouble::Instrument { instrument, .. } => Some(instrument),
                _ => None,
            };
            let at = Finding::LinkLostAt {
                run,
                of,
                left,
                instrument,
                bench: self.made.places.as_ref().map(|file| file.name.clone()),
            };
            self.say_of_whole(verdict, at);
        } else if self.search && left > 0 && is_passed(verdict) {
            verdict = Verdict::Inconclusive;
            self.say_of_whole(verdict, Finding::NotAcceptance { run, of });
        }
        if !is_passed(verdict) && !self.run_says_why {
            self.say_of_whole(verdict, Finding::NoStepRun);
        }
        // Also what was found in a procedure that did not run to its end.
        self.store_outside(WHOLE_RUN);
        let outcome = Outcome {
            id,
            verdict,
            bench_time: self.before,
            exit: verdict.into(),
            lost: None,
            prevented: None,
            counts: self.counter.counts(self.planned),
        };
        (self.store, outcome)
    }
}

fn is_passed(verdict: Verdict) -> bool {
    matches!(verdict, Verdict::Passed | Verdict::Skipped)
}
