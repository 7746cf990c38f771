//! `ptu run`: check procedures.

mod check;
mod choose;
mod conclusion;
mod resume;
mod setup;
mod show;

use std::path::PathBuf;
use std::sync::Arc;

use btu_rig::rig::Harness;
use clap::Args;
use fault_db::Store;

use super::reports::ReportOption;
use super::signing::SigningOption;
use super::{Database, ScriptsOption, answered, print_out, run_list};
use crate::operator::Operator;
use ptu_report::words::tell;
use ptu_report::words::{Words, fill};
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::drive::{Setting, train::brakes_less};
use ptu_runs::failure::{Asked, Exit, Failure};
use ptu_runs::link::Endpoint;
use ptu_runs::run::{
    self, BenchSetup, MeasuringRules, RunControl, RunPlan, Signals, Suite, software_version,
};
use ptu_runs::run_diagnosis::{Bench, adaptive, prove_repairs};
use ptu_runs::stdio;
use ptu_runs::stop::Stop;
use ptu_runs::symptoms;

/// Defaults of `--line`, `--unit-config` and `--seed`.
const LINE: &str = "line8";
const UNIT_CONFIG: &str = "sg100";
const SEED: u64 = 1;

/// Run check procedures; by default all under scripts/, without those that run on request only
///
/// Examples:
///   ptu run                                     everything, on the simulated unit
///   ptu run door 'atp/over*'                    by folder or glob
///   ptu run --unit serial:/dev/ttyUSB0@115200   on a unit on a port
///   ptu run ptu --unit serial:/dev/ttyUSB0      with a laptop alone, on a train
///   ptu run --check                             all script errors, nothing driven
///   ptu run --list atp/overspeed                what would be done
///   ptu run --scattered --seed 7                  on a unit, train and bench as good ones differ
///   ptu run --repeat 10 --shuffle --seed 7      each procedure ten times, in an order drawn by the seed
///   ptu run --adaptive --inject tra.dead        as few steps as it takes to find the part
///   ptu run --report sheet.pdf --lang ko         a test sheet; sheet.html works, too
///   ptu run --report out.json --report out.junit.xml
///   ptu run --json                               each event as a JSON line, for other programs
///   ptu run --exclude tcms --exclude '*/self_test'   all but these
///   ptu run --resume latest                     the procedures that the latest run left without a verdict
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct RunArguments {
    /// Procedures: paths, folders or globs
    #[arg(value_name = "PATH|GLOB")]
    procedures: Vec<String>,
    /// The unit: sim, serial:PATH[@BAUD], tcp:HOST:PORT or lockstep:PATH [default: sim]
    #[arg(long, value_name = "UNIT")]
    unit: Option<Endpoint>,
    /// Whether the bench harness is connected: auto (found out), none (a laptop on a train) or bench; with `sim`,
    /// none is the simulated unit aboard a simulated train
    #[arg(long, value_name = "WHICH", default_value = "auto")]
    harness: Harness,
    /// Line, lines/NAME.toml [default: line8]
    #[arg(long, value_name = "NAME")]
    line: Option<String>,
    /// Unit configuration, units/NAME.toml [default: sg100]
    #[arg(long, value_name = "NAME")]
    unit_config: Option<String>,
    /// Train around the unit, trains/NAME.toml or a file ending in .toml
    #[arg(long, value_name = "NAME|FILE", default_value = "line6")]
    train: String,
    /// Unit configuration key to change, as ato.controller=pi; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<Setting>,
    /// Serial number: of the simulated unit, or the number that a real unit should report
    #[arg(long, value_name = "TEXT")]
    serial_no: Option<String>,
    /// Software version the unit should have, compared by `ptu/identity` in place of the record's
    #[arg(long, value_name = "VERSION", value_parser = software_version)]
    software: Option<[u8; 3]>,
    /// Train the unit is in, as the depot names it; `ptu/identity` compares the unit with its record in
    /// scripts/fleet.toml
    #[arg(long, value_name = "TEXT", default_value = "")]
    train_no: String,
    /// Who tests
    #[arg(long, value_name = "TEXT", default_value = "")]
    who: String,
    /// What was wrong with the unit when it was brought, see `ptu catalog symptoms`: a weak sign of the part
    #[arg(long, value_name = "SYMPTOM")]
    symptom: Option<String>,
    /// Faults to inject into the simulated unit, or into the train around any unit, see `ptu catalog faults`
    #[arg(long, value_name = "FAULT[,FAULT]", value_delimiter = ',')]
    inject: Vec<String>,
    /// Seed of everything random [default: 1]
    #[arg(long)]
    seed: Option<u64>,
    /// Draw by the seed what differs between good units, trains and benches: sensor noise, wheels, load,
    /// brakes, timing; from scripts/bench_scatter.toml or FILE
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true)]
    scattered: Option<Option<PathBuf>>,
    /// How codes, TWC, markers and pulses reach the unit: as values, or sampled as waveforms; FILE says what disturbs
    /// the waveforms
    #[arg(long, value_name = "values|sampled[:FILE]", default_value = "values")]
    signals: Signals,
    /// Instruments of the bench, benches/NAME.toml or a file ending in .toml: where stimuli go and readings come from
    #[arg(long, value_name = "NAME|FILE")]
    bench: Option<String>,
    /// Run the simulated unit at the wall clock's pace
    #[arg(long)]
    realtime: bool,
    /// Run N times slower than real time, on a computer too busy for real time; a served unit must be slowed, too:
    /// `ato-under-test --slower`
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100))]
    slower: u32,
    /// Simulated units to test side by side
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=64))]
    jobs: u32,
    /// Report all errors of all scripts, limits that name no source and texts without Korean, and drive nothing
    #[arg(long, conflicts_with = "list")]
    check: bool,
    /// Show what would be run and drive nothing: a line for each procedure; of named procedures all steps
    #[arg(long)]
    pub list: bool,
    /// With --list: all steps, also where no procedure is named
    #[arg(long, requires = "list")]
    steps: bool,
    /// Leave these procedures out: a path, folder or glob; repeatable
    #[arg(long, value_name = "PATH|GLOB")]
    exclude: Vec<String>,
    /// Only steps whose name matches this glob
    #[arg(long, value_name = "STEP")]
    step: Option<String>,
    /// Run each procedure N times, each time with its set-up and clean-up
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10000))]
    repeat: u32,
    /// Run the procedures in an order drawn by the seed
    #[arg(long)]
    shuffle: bool,
    /// End after the first step that does not pass; with --jobs, too, the record ends with the first procedure, in the
    /// order of the list, that did not pass
    #[arg(long)]
    stop_on_fail: bool,
    /// Isolate a fault: run the step that tells the most, again and again, until one part is found
    #[arg(long, conflicts_with_all = ["check", "list", "step", "shuffle", "stop_on_fail"])]
    adaptive: bool,
    /// Run although the calibration of an instrument of this bench has expired; the sheet says so (`ptu instrument`)
    #[arg(long)]
    uncalibrated: bool,
    /// Narrow each limit by the uncertainty of the instrument for its unit (ISO/IEC 17025 7.8.6); the sheet names the rule
    #[arg(long)]
    guard_band: bool,
    #[command(flatten)]
    resume: resume::ResumeOption,
    #[command(flatten)]
    show: show::ShowOptions,
    #[command(flatten)]
    reports: ReportOption,
    #[command(flatten)]
    signing: SigningOption,
    #[command(flatten)]
    database: Database,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl RunArguments {
    /// Loads the scripts, then checks them, lists them or runs them.
    pub fn run(mut self) -> Result<Exit, Failure> {
        let directory = self.scripts.find()?;
        let earlier = self.take_over()?;
        let mut setup = self.setup(&directory)?;
        let Suite {
            procedures,
            errors,
            need_cars,
            printed,
            sha256: scripts_sha256,
            ..
        } = Suite::load(&directory, &self.procedures, &setup)?;
        printed.iter().for_each(|line| stdio::note(line));
        if !errors.is_empty() {
            errors.iter().for_each(|error| stdio::note(error));
            return Err(Failure::usage(match errors.len() {
                1 => Asked::ErrorInScripts,
                n => Asked::ErrorsInScripts(n),
            }));
        }
        if !need_cars.is_empty() {
            let why = Asked::NeedsCars(self.train.to_string(), need_cars.join(", "));
            if procedures.is_empty() {
                return Err(Failure::usage(why));
            }
            let words = Words::shown();
            let why = words.told(&why);
            stdio::note(&fill(words.terminal.left_out, &[("why", &why)]));
        }
        let less = brakes_less(&setup.train, &setup.config.content);
        let words = Words::shown();
        less.iter().for_each(|less| stdio::note(&words.told(less)));
        if let Some(earlier) = &earlier {
            resume::tell_changes(earlier, &procedures, &setup);
        }
        if self.check {
            let fitted = setup.places.as_ref();
            let fitted = fitted.map(|places| (&**places, words.fitted(places, procedures.clone())));
            return check::show(&procedures, directory.check_data()?, fitted);
        }
        let mut procedures = self.asked_for(procedures)?;
        if let Some(places) = &setup.places {
            procedures = words.fitted(places, procedures);
            places
                .by_hand()
                .for_each(|note| stdio::note(&words.told(&note)));
        }
        let asks = procedures.iter().any(|procedure| procedure.asks());
        let drives = asks && !self.list && self.jobs == 1;
        let operator = drives.then(Operator::at_terminal).flatten();
        let tasks = self.tasks(procedures, operator.is_some())?;
        if self.list {
            let whole = self.steps || !self.procedures.is_empty() || self.step.is_some();
            return run_list::show(&tasks, self.harness, self.show.json, whole);
        }
        let mut plan = RunPlan {
            tasks,
            jobs: self.jobs as usize,
            stop_on_fail: self.stop_on_fail,
            operator: self.who.clone(),
            train: self.train_no.clone(),
            symptom: self.symptom.clone(),
            scripts_sha256,
            adaptive: None,
            continues: earlier.map(|earlier| earlier.run.id),
            measuring: MeasuringRules {
                uncalibrated: self.uncalibrated,
                guard_band: self.guard_band,
            },
        };
        setup.record_whole = self.show.mcap.is_some();
        setup.run_control = operator.map(|operator| operator as Arc<dyn RunControl>);
        self.execute(&mut plan, setup, &directory)
    }

    fn line(&self) -> &str {
        self.line.as_deref().unwrap_or(LINE)
    }

    fn seed(&self) -> u64 {
        self.seed.unwrap_or(SEED)
    }

    fn execute(
        &self,
        plan: &mut RunPlan,
        setup: BenchSetup,
        directory: &ScriptsDirectory,
    ) -> Result<Exit, Failure> {
        let symptom = self.symptom.as_deref();
        let symptom = symptom
            .map(|id| symptoms::find(directory, &directory.faults()?.lrus, id))
            .transpose()?;
        let signer = self.signing.signer()?;
        let store = self.database.open_file()?;
        store.sign_with(signer);
        // Checked once the database file exists, so that no report can take the database's place.
        self.reports.check()?;
        if self.adaptive && (self.repeat > 1 || self.jobs > 1) {
            return Err(Failure::usage(Asked::AdaptiveOnce));
        }
        let stop = Stop::default();
        stop.listen();
        let mut shown = self.show.begin(plan)?;
        let result = match self.adaptive {
            false => run::run(plan, setup, store, &stop, &mut shown),
            true => {
                let config = setup.config.sha256.clone();
                let practice = setup.is_practice();
                let prepare = |store: &Store, serial: &str, connection| {
                    let bench = Bench {
                        unit_config_sha256: &config,
                        line: self.line(),
                        train: &self.train,
                        connection,
                        practice,
                    };
                    let made = adaptive(store, directory, (serial, symptom.as_ref()), &bench)?;
                    let words = Words::shown();
                    let warnings = made.warnings.iter();
                    warnings.for_each(|warning| stdio::note(&words.told(warning)));
                    Ok(made)
                };
                run::search(plan, setup, store, &stop, &mut shown, prepare)
            }
        };
        let outcome = result.as_ref().ok().map(|(_, outcome)| outcome);
        let [streamed, recorded] = shown.finish(outcome);
        let (store, outcome) = result?;
        if let Some(why) = &outcome.prevented {
            tell(&Failure::bench(why.clone()));
        }
        if let Some(lost) = &outcome.lost {
            tell(&Failure::bench(lost.clone()));
        }
        let answer = self.diagnosis(&store, directory, &outcome);
        let proofs = match outcome.exit {
            Exit::Passed => prove_repairs(&store, directory, outcome.id),
            _ => Ok(Vec::new()),
        };
        // The causes of the faults are stored before the answer is printed, so that they are kept if printing fails.
        if let Some(Ok(answer)) = &answer
            && let Err(failure) = answer.attribute(&store)
        {
            tell(&failure);
        }
        let detail = store.run(outcome.id)?;
        // The database has the result: a terminal that takes no output changes no verdict.
        let said = match self.show.json {
            true => Ok(()),
            false => print_out(&self.show.verdict(&detail))
                .and_then(|_| conclusion::say_validity(&detail))
                .and_then(|_| answer.map_or(Ok(()), |answer| self.say_diagnosis(answer)))
                .and_then(|()| conclusion::say_proofs(&proofs?)),
        };
        if let Err(failure) = said {
            tell(&failure);
        }
        let reported = self.reports.write(&store, directory, &detail);
        let outputs = Failure::of_all([streamed, recorded, reported]);
        let outputs = outputs.map_err(|failure| Failure::bench(failure.message));
        let told = answered(outputs.map(|()| outcome.exit), outcome.exit);
        store.close()?;
        told
    }
}
