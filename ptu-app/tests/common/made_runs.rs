//! Runs of every kind, each made from a seed and recorded by what records a run of a bench, with the facts that every
//! reader of it has to tell.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::made_plans::Kind::{self, *};
use btu_rig::procedure::Verdict::{self, Skipped};
use btu_rig::procedure::finding::LimitMissed;
use btu_rig::procedure::{
    Finding, Findings, Measurement, Outside as Place, OutsideStep, Procedure, ResultKind, RunEvent,
    RunOptions, StepResult,
};
use btu_rig::rig::LinkTrouble;
use diagnosis::{Dictionary, Mode};
use fault_db::{Id, OpenOptions, RunRecord, RunState, Signer, Store, Synchronous, UnitRecord};
use protocol::event::Severity;
use protocol::{Duration, Instant};
use ptu_report::event_lines::EventLines;
use ptu_runs::bench_worker::Progress;
use ptu_runs::clock;
use ptu_runs::run::{
    CHECK_FAILED, Collector, Evidence, FaultSeen, MeasuringRules, RunPlan, RunStart, RunStore,
    SessionEvent, Task, different_steps,
};
use ptu_runs::stop::Stop;
use ptu_runs::stored::{kind, stored};

use super::made_elsewhere::read_of_a_unit;
use super::made_plans::{Chance, Heard, KINDS, contents, known, likeliest, own};
use super::told::{Facts, marks, sorted, turn_of, turned, value_and_limits};

/// Parts that faults name.
pub const PARTS: [&str; 4] = ["eb_relay", "tra", "twc_cpu", "speed_sensor_1"];

pub struct Made {
    pub seed: u64,
    pub id: Id,
    pub facts: Facts,
    /// Lines of its stream for other programs.
    pub lines: Vec<String>,
    /// Knowledge of the window that led the run; none if the run was read of a unit.
    pub live: Option<Progress>,
}

/// Makes runs in a file.
pub struct Maker {
    file: PathBuf,
    dictionary: Dictionary,
    store: Option<Store>,
    earlier: Option<Id>,
}

impl Maker {
    /// A maker of runs in this file, with the fault dictionary of these scripts.
    pub fn new(file: PathBuf, scripts: &Path) -> Self {
        let packed = std::fs::read(scripts.join("dictionary.zst")).expect("a dictionary");
        Self {
            file,
            dictionary: Dictionary::from_bytes(&packed).expect("a dictionary"),
            store: None,
            earlier: None,
        }
    }

    /// The run of this seed.
    pub fn make(&mut self, seed: u64) -> Made {
        let store = self.store.take().unwrap_or_else(|| self.open());
        let mut making = Making::new(seed, &self.dictionary);
        if matches!(making.kind, Imported | Pulled) {
            let (id, facts) = making.read_of_a_unit(&store);
            self.store = Some(store);
            return Made {
                seed,
                id,
                facts,
                lines: Vec::new(),
                live: None,
            };
        }
        let record = making.record(self.earlier);
        let run_store = RunStore::begin(store, record, None, &Stop::default()).expect("begun");
        let (id, began) = (run_store.id, RunStart::now());
        let mut heard = Heard(
            EventLines::default(),
            Vec::new(),
            Progress::new(&making.plan, "unit".into()),
        );
        let due = (making.planned(), making.kind == Adaptive);
        let contents = contents();
        let mut collector = Collector::new(run_store, began, &mut heard, contents, due);
        let stopped = making.collect(&mut collector);
        let outcome = if making.kind == Broken {
            drop(collector);
            // The writer of the run writes what there is, and goes away.
            while self.open().run(id).expect("begun").run.state == RunState::Running {
                std::thread::yield_now();
            }
            None
        } else {
            let (run_store, outcome) = collector.finish(id, stopped);
            let end = began.end(stored(outcome.verdict), 1_000_000);
            self.store = Some(run_store.finish(end).expect("stored").0);
            Some(outcome)
        };
        let Heard(mut events, mut lines, mut live) = heard;
        if let Some(outcome) = outcome {
            lines.push(events.finished(&outcome));
            live.end(Some(outcome));
        }
        self.earlier = Some(id);
        let facts = making.facts(id);
        Made {
            seed,
            id,
            facts,
            lines,
            live: Some(live),
        }
    }

    fn open(&self) -> Store {
        let options = OpenOptions::new(clock::ids()).synchronous(Synchronous::Normal);
        let store = Store::open(&self.file, options).expect("a database");
        let signer = Signer::new("Kim", "technician", &[7; 32]).expect("a key");
        store.sign_with(Some(Arc::new(signer)));
        store
    }

    /// The store of all that was made.
    pub fn store(mut self) -> Store {
        self.store.take().unwrap_or_else(|| self.open())
    }
}

/// A run that is being made, and what it comes to.
struct Making<'a> {
    seed: u64,
    kind: Kind,
    chance: Chance,
    plan: RunPlan,
    dictionary: &'a Dictionary,
    /// The checks are those of the dictionary.
    of_dictionary: bool,
    /// Fault mode that the unit has then.
    mode: Option<&'a Mode>,
    /// Worst result of each step: 0 not run, 1 passed, 2 error, 3 failed.
    worst: BTreeMap<(usize, usize), u8>,
    attempts: usize,
    outside: usize,
    /// Steps that need the harness.
    on_bench: usize,
    /// Marks of results that did not pass, and of measurements with values and limits.
    not_passed: Vec<String>,
    values: Vec<(String, String)>,
    parts: BTreeMap<&'static str, usize>,
    /// Number of faults, by part and code.
    faults: usize,
    /// Verdict of what was read of a unit.
    read_as: Option<&'static str>,
    /// Repetition of each result that did not pass.
    turns: Vec<String>,
    turn: usize,
    measured: usize,
}

impl<'a> Making<'a> {
    fn new(seed: u64, dictionary: &'a Dictionary) -> Self {
        let kind = KINDS[seed as usize % KINDS.len()];
        let mut chance = Chance(seed);
        let of_dictionary = kind == Pair
            || (seed % 2 == 1 && matches!(kind, Passed | Failed | Adaptive | Repeated));
        let mode = &dictionary.modes[chance.below(dictionary.modes.len())];
        let procedures = match of_dictionary {
            true => known(dictionary, mode, &mut chance),
            false => (0..1 + chance.below(3))
                .map(|number| own(seed, number, &mut chance))
                .collect(),
        };
        let repeat = [1, 2 + chance.below(2) as u32][usize::from(kind == Repeated)];
        let task = |procedure: Procedure| Task {
            options: RunOptions {
                chosen: (kind == OneStep).then(|| vec![chance.below(procedure.steps.len())]),
                repeat,
                ..RunOptions::default()
            },
            procedure: Arc::new(procedure),
        };
        Self {
            plan: RunPlan::of(procedures.into_iter().map(task)),
            seed,
            kind,
            dictionary,
            mode: (of_dictionary && !matches!(kind, Passed | Repeated)).then_some(mode),
            of_dictionary,
            chance,
            worst: BTreeMap::new(),
            attempts: 0,
            outside: 0,
            on_bench: 0,
            not_passed: Vec::new(),
            values: Vec::new(),
            parts: BTreeMap::new(),
            faults: 0,
            read_as: None,
            turns: Vec::new(),
            turn: 0,
            measured: 0,
        }
    }

    fn planned(&self) -> usize {
        match self.kind {
            Imported | Pulled => self.worst.len(),
            _ => different_steps(&self.plan.tasks),
        }
    }

    fn record(&self, earlier: Option<Id>) -> RunRecord {
        let rules = MeasuringRules::default();
        let evidence = Evidence::now(contents(), Vec::new(), rules, self.planned());
        let pair = if self.kind == Pair { ",tra.dead" } else { "" };
        RunRecord {
            unit: UnitRecord {
                serial: format!("M-{}", self.seed),
                kind: "atc".into(),
                config_name: "sg100".into(),
                sw_versions: BTreeMap::new(),
            },
            line: self.dictionary.basis.line.clone(),
            operator: "김 <b>".into(),
            source: "sim".into(),
            connection: Some(["harness", "ptu"][usize::from(self.kind == OnTrain)].into()),
            evidence: Some(evidence.text()),
            started_at_us: clock::now_us(),
            unit_config_sha256: self.dictionary.basis.unit_config_sha256.clone(),
            injected: self.mode.map(|mode| format!("{}{pair}", mode.name.id)),
            continues: earlier.filter(|_| self.kind == Resumed),
            ..RunRecord::default()
        }
    }

    /// Records the run; returns what ends it before its time.
    fn collect(&mut self, to: &mut Collector<'_>) -> Option<Verdict> {
        let tasks = self.plan.tasks.iter();
        let all: Vec<_> = tasks.map(|task| task.procedure.clone()).collect();
        let ends_in = self.chance.below(all.len());
        let nothing_at_all = self.kind == NoSteps && self.chance.one_in(3);
        for (place, procedure) in all.iter().enumerate().filter(|_| !nothing_at_all) {
            let is_over = place > ends_in;
            if is_over && matches!(self.kind, Broken | Adaptive) {
                break;
            }
            to.begin(procedure);
            if is_over && self.kind == Stopped {
                to.not_begun(Verdict::Aborted, Finding::Stopped);
                self.outside += 1;
                continue;
            }
            let (steps, at) = (procedure.steps.len(), Instant::ZERO);
            to.take(SessionEvent::Run(RunEvent::ProcedureStarted { steps, at }));
            let verdict = self.before(place, is_over, to);
            let verdict =
                verdict.and(self.steps(place, procedure, (place == ends_in, is_over), to));
            if place == ends_in && self.kind == Broken {
                break;
            }
            let findings = Finding::Prevented {
                english: "the unit did not come up".into(),
                korean: "장치가 기동하지 않음".into(),
            }
            .into();
            to.take(SessionEvent::Run(RunEvent::ProcedureFinished {
                verdict,
                findings,
                at,
            }));
            let bench_time = Duration::from_us(1_000);
            to.take(SessionEvent::Ended { bench_time });
        }
        (self.kind == Stopped).then_some(Verdict::Aborted)
    }

    /// Entries outside the steps of a procedure, and what they come to.
    fn before(&mut self, place: usize, is_over: bool, to: &mut Collector<'_>) -> Verdict {
        let (places, verdict): (&[Place], _) = match self.kind {
            // The end of the procedure alone says why.
            NoSteps if self.chance.one_in(2) => {
                self.outside += 1;
                return Verdict::Error;
            }
            NoSteps => (&[Place::BringUp], Verdict::Error),
            LinkLost if is_over => (&[Place::Bench], Verdict::Error),
            Outside => (&Place::ALL[..9], Verdict::Failed),
            _ => return Skipped,
        };
        let has_first = places.len() == 1 || place == 0;
        let mut all = Skipped;
        for (number, place) in places.iter().enumerate() {
            if !(has_first && number == 0 || self.chance.one_in(4)) {
                continue;
            }
            self.outside += 1;
            all = verdict;
            to.take(SessionEvent::Run(RunEvent::OutsideStep(OutsideStep {
                place: *place,
                verdict,
                finding: Finding::Told(format!("what went wrong at {}", place.name())),
                at: Instant::ZERO,
            })));
        }
        all
    }

    /// The steps of a procedure, in which the run `ends` or after which it is over, and what they come to.
    fn steps(
        &mut self,
        place: usize,
        of: &Procedure,
        (ends, is_over): (bool, bool),
        to: &mut Collector<'_>,
    ) -> Verdict {
        let (steps, options) = (of.steps.len(), self.plan.tasks[place].options.clone());
        let ends_at = self.chance.below(steps);
        let is_lost = ends && self.kind == LinkLost;
        let mut verdict = [Skipped, Verdict::Error][usize::from(is_lost)];
        let turns = (0..options.repeat).flat_map(|turn| (0..steps).map(move |step| (turn, step)));
        for (turn, index) in turns {
            let chosen = options.chosen.as_ref();
            let is_chosen = chosen.is_none_or(|chosen| chosen.contains(&index));
            if !is_chosen || self.kind == NoSteps || (is_over && self.kind == LinkLost) {
                continue;
            }
            let after = ends && (turn, index) > (0, ends_at);
            let is_end = ends && (turn, index) == (0, ends_at);
            let result = self.result(of, (place, index, turn, options.repeat), (is_end, after));
            if self.kind == Retried && self.chance.one_in(2) {
                verdict = verdict.and(self.attempt(place, of, &result, to));
            }
            verdict = verdict.and(result.verdict);
            self.note(place, result, to);
            if is_end && matches!(self.kind, Broken | Adaptive) {
                break;
            }
            if is_end && self.kind == LinkLost {
                to.take(SessionEvent::LinkLost(LinkTrouble::NotOneByte {
                    within: Duration::from_ms(3_000),
                }));
            }
        }
        verdict
    }

    /// Result of a step; `is_end` = the run is broken off there; `after` = the step comes after
    /// that.
    fn result(
        &mut self,
        of: &Procedure,
        (place, index, turn, repeat): (usize, usize, u32, u32),
        (is_end, after): (bool, bool),
    ) -> StepResult {
        let (step, bad) = (&of.steps[index], self.chance.one_in(4));
        let counted = self
            .mode
            .map(|mode| likeliest(self.dictionary, mode, of, index));
        let verdict = match (self.kind, counted) {
            (OnTrain, _) if place > 0 => Skipped,
            (LinkLost, _) if is_end => Verdict::Error,
            (Stopped, _) if is_end => Verdict::Aborted,
            (LinkLost | Stopped, _) if after => Skipped,
            (_, Some(counted)) => counted,
            (Failed, _) if (place, index) == (0, 0) => Verdict::Failed,
            (Error, _) if (place, index) == (0, 0) || bad => Verdict::Error,
            (Passed | Adaptive | OneStep | Outside, _) => Verdict::Passed,
            _ if self.of_dictionary => Verdict::Passed,
            _ if bad => Verdict::Failed,
            _ => Verdict::Passed,
        };
        let found = match verdict {
            Verdict::Passed => Findings::default(),
            Skipped if self.kind == OnTrain => Finding::NeedsHarness.not_run().into(),
            Skipped => Finding::Stopped.not_run().into(),
            Verdict::Failed => Finding::LimitMissed(LimitMissed {
                measurement: "eb_reaction".into(),
                value: 640.0,
                uncertainty: None,
                low: None,
                high: Some(472.0),
                unit: "ms".into(),
            })
            .into(),
            _ => Finding::Told("nothing comes from the unit".into()).into(),
        };
        let most = [3, 1][usize::from(verdict == Skipped || self.of_dictionary)];
        let most = self.chance.below(most);
        StepResult {
            index,
            name: step.name.clone(),
            turn: turn + 1,
            turns: repeat,
            kind: ResultKind::Step,
            line: step.line,
            verdict,
            findings: found,
            suspect: None,
            started: Instant::ZERO,
            bench_time: Duration::from_us(100_000),
            limit_source: None,
            measurements: (0..most).map(|_| self.measurement(verdict)).collect(),
        }
    }

    fn measurement(&mut self, verdict: Verdict) -> Measurement {
        self.measured += 1;
        let chance = &mut self.chance;
        let number = |chance: &mut Chance| (1 + chance.below(9_000)) as f64 / 10.0;
        Measurement {
            name: format!("m{:04} 반응", self.measured),
            value: (verdict != Verdict::Error || chance.one_in(2)).then(|| number(chance)),
            unit: ["ms", "km/h", ""][chance.below(3)],
            low: chance.one_in(2).then(|| number(chance)),
            high: chance.one_in(2).then(|| number(chance)),
            uncertainty: chance.one_in(4).then_some(0.5),
            limit_source: None,
            verdict: [Verdict::Passed, verdict][usize::from(verdict == Verdict::Failed)],
        }
    }

    /// An attempt at a step while the tester's computer stood still; perhaps the step before is run again for the next.
    fn attempt(
        &mut self,
        place: usize,
        of: &Procedure,
        result: &StepResult,
        to: &mut Collector<'_>,
    ) -> Verdict {
        let attempt = |index: usize, kind: ResultKind, verdict: Verdict| StepResult {
            index,
            name: of.steps[index].name.clone(),
            kind,
            verdict,
            findings: Finding::StoodStill {
                by: Duration::from_ms(300),
                attempt: 1,
            }
            .into(),
            measurements: Vec::new(),
            ..result.clone()
        };
        self.note(
            place,
            attempt(result.index, ResultKind::Attempt, Skipped),
            to,
        );
        if result.index == 0 || self.chance.one_in(2) {
            return Skipped;
        }
        self.note(
            place,
            attempt(result.index - 1, ResultKind::Again, Verdict::Failed),
            to,
        );
        Verdict::Failed
    }

    fn note(&mut self, place: usize, result: StepResult, to: &mut Collector<'_>) {
        let rank = match result.verdict {
            Skipped => 0,
            Verdict::Passed => 1,
            Verdict::Failed => 3,
            _ => 2,
        };
        let worst = self.worst.entry((place, result.index)).or_default();
        *worst = rank.max(*worst);
        self.attempts += usize::from(rank > 0);
        self.on_bench += usize::from(result.findings.need_harness());
        if rank > 1 || result.kind == ResultKind::Attempt {
            let [turn, turns] = [result.turn, result.turns].map(u64::from);
            let turn = turn_of(turn, turns, kind(result.kind).as_str());
            self.turns.extend(turned(&marks(&result.name, 's'), &turn));
        }
        if rank > 1 {
            self.not_passed.extend(marks(&result.name, 's'));
        }
        for one in &result.measurements {
            let limits = [one.low, one.high];
            let off = one.value.and(one.uncertainty);
            self.values
                .push(value_and_limits(&one.name[..5], one.value, off, limits));
        }
        let finding = Finding::CheckFailed {
            procedure: "made/up".into(),
            step: result.name.clone(),
            turn: result.turn,
            turns: result.turns,
            findings: result.findings.clone(),
        };
        to.take(SessionEvent::Run(RunEvent::StepFinished(result)));
        if rank == 3 {
            let part = PARTS[self.chance.below(PARTS.len())];
            self.faults += usize::from(!self.parts.contains_key(part));
            *self.parts.entry(part).or_default() += 1;
            to.take(SessionEvent::Fault(FaultSeen {
                code: CHECK_FAILED,
                name: "check_failed".into(),
                lru: part.parse().ok(),
                severity: Severity::Major,
                at: Instant::ZERO,
                step: Some(self.turn),
                finding,
                freeze: Vec::new(),
            }));
        }
        self.turn += 1;
    }

    /// A run that was read of a unit, and told by nobody before.
    fn read_of_a_unit(mut self, store: &Store) -> (Id, Facts) {
        let is_log = self.kind == Imported;
        let read = read_of_a_unit(store, self.seed, is_log, &mut self.chance);
        self.faults = read.parts.len();
        for part in read.parts {
            *self.parts.entry(part).or_default() += 1;
        }
        self.worst = (0..read.steps).map(|place| ((0, place), 0)).collect();
        self.read_as = Some(read.verdict);
        (read.id, self.facts(read.id))
    }

    fn facts(mut self, id: Id) -> Facts {
        let planned = self.planned();
        let of = |rank: u8| self.worst.values().filter(|worst| **worst == rank).count();
        let [passed, error, failed] = [1, 2, 3].map(of);
        let (run, bad) = (passed + error + failed, failed + error);
        let left = planned - run;
        let verdict = match self.kind {
            Broken => "interrupted",
            Stopped => "aborted",
            Imported | Pulled => self.read_as.expect("read"),
            LinkLost | NoSteps => "error",
            Outside => "failed",
            _ if failed > 0 => "failed",
            _ if error > 0 => "error",
            Adaptive if left > 0 => "inconclusive",
            _ => "passed",
        };
        // What the run as a whole says of itself.
        let says_left = self.kind == LinkLost && left > 0;
        let is_silent = self.kind == NoSteps && self.outside == 0;
        self.outside += usize::from(says_left || is_silent || verdict == "inconclusive");
        let (attempts, outside, faults) = (self.attempts, self.outside, self.faults);
        let names = "planned|run|passed|failed|error|not passed|not run|attempts|outside|faults|need the bench";
        let bench = self.on_bench;
        let numbers = [
            planned, run, passed, failed, error, bad, left, attempts, outside, faults, bench,
        ];
        let numbers = numbers.map(|number| number.to_string());
        let mut known: BTreeMap<_, _> = names.split('|').map(str::to_owned).zip(numbers).collect();
        let parts = self.parts.iter();
        let (values, limits): (Vec<_>, Vec<_>) = self.values.into_iter().unzip();
        let turns = self.turns.into_iter();
        let (in_vain, turns): (Vec<_>, Vec<_>) = turns.partition(|turn| turn.ends_with("attempt"));
        known.extend([
            sorted("parts", parts.map(|(part, seen)| format!("{part}={seen}"))),
            sorted("steps that did not pass", self.not_passed),
            sorted("turns that did not pass", turns),
            sorted("attempts in vain", in_vain),
            sorted("values", values),
            sorted("limits", limits),
        ]);
        let only = |is_so: bool, text: String| if is_so { text } else { String::new() };
        let lost = format!("link lost at step {run} of {planned}; {left} not run");
        let lost_ko = format!("{planned}개 단계 중 {run}번째에서 연결 끊김; {left}개 미실행");
        let more = [
            ("verdict", verdict.into()),
            ("id", id.short()),
            ("with a result", self.worst.len().to_string()),
            ("0", "0".into()),
            (
                "checks made",
                if self.of_dictionary { run } else { 0 }.to_string(),
            ),
            ("folders on the bench", only(bench > 0, "made".into())),
            ("link en", only(says_left, lost)),
            ("link ko", only(says_left, lost_ko)),
        ];
        known.extend(more.map(|(name, text)| (name.to_owned(), text)));
        Facts {
            of: format!("seed {} ({:?})", self.seed, self.kind),
            known,
        }
    }
}
