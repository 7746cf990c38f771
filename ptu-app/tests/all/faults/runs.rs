//! The suite on a unit with one fault: in process, on procedures loaded once, or through the program.

use std::collections::BTreeSet;

use crate::common::{Place, list, scripts};
use btu_rig::procedure::Procedure;
use diagnosis::Finding;
use fault_db::{Store, TraceData};
use protocol::injection::{FaultCatalogue, FaultMode};
use ptu_report::run_json;
use ptu_runs::clock;
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::run::{self, BenchChoice, BenchSetup, RunPlan, Suite};
use ptu_runs::run_diagnosis::diagnose_run;
use ptu_runs::stop::Stop;
use serde_json::Value;

/// Outcome of a run on a faulty unit.
pub struct FaultRun {
    /// Exit code.
    pub exit: u8,
    /// The report as JSON.
    pub report: Value,
    /// The part that diagnosis names first, or the group of parts that measuring alone tells apart.
    pub named: Vec<String>,
    /// The trace of each stored fault that has one.
    pub traces: Vec<Window>,
}

/// A stored trace around its trigger.
pub struct Window {
    pub id: String,
    pub before_s: f64,
    /// The unit had no power yet at its first row: nothing was heard.
    pub from_power_up: bool,
    pub after_s: f64,
    pub partial: bool,
    pub period_ms: f64,
    /// Signals that are there for all of the time.
    pub complete: BTreeSet<String>,
}

/// A bench and its procedures.
pub struct TestBench {
    directory: ScriptsDirectory,
    setup: BenchSetup,
    suite: Suite,
    pub catalogue: FaultCatalogue,
}

impl TestBench {
    pub fn new() -> Self {
        Self::of(&BTreeSet::new())
    }

    /// A bench with these procedures, or with the default suite if there is none, evaluated once.
    pub fn of(procedures: &BTreeSet<&str>) -> Self {
        let asked: Vec<_> = procedures.iter().map(|id| (*id).to_owned()).collect();
        let directory = ScriptsDirectory::find(Some(&scripts())).expect("scripts");
        let setup = BenchChoice::default().setup(&directory).expect("a bench");
        let suite = Suite::load(&directory, &asked, &setup).expect("procedures");
        assert_eq!(suite.errors, [""; 0]);
        let mut catalogue = directory.faults().expect("fault modes");
        // What is stored of a fault of the bench names the part that a step suspects: never the bench.
        catalogue.faults.retain(|mode| !mode.place.on_bench());
        Self {
            catalogue,
            directory,
            setup,
            suite,
        }
    }

    /// A procedure has a step with these words in its name.
    pub fn has_step(&self, procedure: &str, words: &str) -> bool {
        let procedure = self.suite.procedures.iter().find(|p| p.id == procedure);
        procedure.is_some_and(|p| p.steps.iter().any(|step| step.name.contains(words)))
    }

    /// Runs and records the whole suite on a unit with this fault.
    pub fn run(&self, mode: &FaultMode) -> FaultRun {
        self.run_of(mode, |procedure| !procedure.on_request, true)
    }

    /// Runs these procedures alone, and makes no diagnosis.
    pub fn run_procedures(&self, mode: &FaultMode, ids: &BTreeSet<&str>) -> FaultRun {
        self.run_of(mode, |procedure| ids.contains(procedure.id.as_str()), false)
    }

    fn run_of(
        &self,
        mode: &FaultMode,
        is_run: impl Fn(&Procedure) -> bool,
        is_diagnosed: bool,
    ) -> FaultRun {
        let setup = BenchSetup {
            faults: vec![mode.clone()],
            ..self.setup.clone()
        };
        let asked_for = self.suite.procedures.iter().filter(|p| is_run(p));
        let mut plan = RunPlan::of(asked_for.cloned());
        plan.scripts_sha256 = self.suite.sha256.clone();
        let place = Place::new();
        let path = place.path("history.db");
        let store = Store::open(&path, clock::open_options()).expect("a database");
        let ran = run::run(&mut plan, setup, store, &Stop::default(), &mut ());
        let (store, outcome) = ran.unwrap_or_else(|failure| panic!("{failure}"));
        let mut named = Vec::new();
        if is_diagnosed {
            let answer = diagnose_run(&store, &self.directory, outcome.id).expect("a diagnosis");
            answer.attribute(&store).expect("attributed");
            let diagnosis = &answer.diagnosis;
            let first = || diagnosis.candidates.first().map(|first| first.lru.clone());
            let parts = match diagnosis.conclusion.finding() {
                Finding::OneOf => diagnosis.conclusion.parts(),
                _ => first().into_iter().collect(),
            };
            named = parts.iter().map(ToString::to_string).collect();
        }
        let detail = store.run(outcome.id).expect("the run");
        let ids = detail.faults.iter().filter_map(|fault| fault.trace_id);
        FaultRun {
            exit: outcome.exit.code(),
            report: run_json(&detail),
            named,
            traces: ids
                .map(|id| Window::of(id.to_string(), &store.trace(id).expect("a trace")))
                .collect(),
        }
    }
}

/// Runs these procedures through the program, or the whole suite if none is named.
pub fn run_program(id: &str, procedures: &BTreeSet<&str>) -> FaultRun {
    let place = Place::new();
    let faulty = ["--inject", id].into_iter();
    let arguments: Vec<_> = faulty.chain(procedures.iter().copied()).collect();
    let (said, report) = place.run(&arguments);
    assert!(!said.err.contains("panicked"), "{}", said.all());
    let diagnosis = place.json("diagnose latest --json");
    let named = match &diagnosis["group"] {
        Value::Null => vec![&diagnosis["candidates"][0]["part"]],
        group => list(&group["parts"]).iter().collect(),
    };
    let named = named.into_iter().filter_map(Value::as_str);
    let path = place.path("history.db");
    let store = Store::open(&path, clock::open_options()).expect("the program's database");
    let ids = list(&report["faults"])
        .iter()
        .filter_map(|fault| fault["trace_id"].as_str());
    let traces = ids.map(|id| {
        let trace = store.trace(id.parse().expect("an id")).expect("a trace");
        Window::of(id.to_owned(), &trace)
    });
    FaultRun {
        exit: said.code.expect("an exit code") as u8,
        named: named.map(str::to_owned).collect(),
        traces: traces.collect(),
        report,
    }
}

impl Window {
    fn of(id: String, trace: &TraceData) -> Self {
        let rows = trace.columns.iter().map(Vec::len).max().unwrap_or(0);
        let seconds = |rows: usize| (rows as i64 * trace.period_us) as f64 / 1e6;
        let trigger = trace.trigger_row.expect("a trigger") as usize;
        let channels = trace.channels.iter().zip(&trace.columns);
        Self {
            id,
            before_s: seconds(trigger),
            from_power_up: channels
                .clone()
                .any(|(channel, column)| channel.name == "speed" && column[0].is_nan()),
            after_s: seconds(rows - 1 - trigger),
            partial: trace.partial,
            period_ms: trace.period_us as f64 / 1e3,
            complete: channels
                .filter(|(_, column)| column.len() == rows)
                .map(|(channel, _)| channel.name.clone())
                .collect(),
        }
    }
}
