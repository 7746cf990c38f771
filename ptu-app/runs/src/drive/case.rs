//! One section under one controller, and how it is built from the command line options.

use std::sync::Arc;

use btu_rig::conditions::Conditions;
use btu_rig::drive::{DrivePlan, Ending, Load, Outcome, Scatter};
use btu_rig::train::TrainData;
use protocol::config::{ControllerKind, checksum};
use protocol::line::Line;

use super::{DriveBench, Fixed, SectionChoice, Setting, drive, train, unit_config};
use crate::data::sha256;
use crate::data::{DataFile, ScriptsDirectory};
use crate::failure::{DriveTrouble, Failure};
use crate::pool;
use crate::stdio;
use crate::stop::Stop;

/// Key of the controller in the unit configuration.
const CONTROLLER_KEY: &str = "ato.controller";
/// Line and section when none are asked for: S0's test run.
const DEFAULT_LINE: &str = "line8";
const DEFAULT_SECTION: SectionChoice = SectionChoice::One(61);

#[derive(Clone, Debug, Default)]
pub struct Request {
    /// Line, `lines/NAME.toml`; none = line8.
    pub line: Option<String>,
    /// Sections of the line; none = 61.
    pub sections: Option<SectionChoice>,
    /// Controllers; none = the configuration's.
    pub controllers: Vec<ControllerKind>,
    /// Train, `trains/NAME.toml` or a file.
    pub train: String,
    /// Total mass, kg.
    pub mass_kg: Option<f64>,
    /// Passengers.
    pub load: Option<Load>,
    /// Values that are held, other than nominal.
    pub fixed: Fixed,
    /// Code from start to end, in place of the line's.
    pub code: Option<String>,
    /// Unit configuration, `units/NAME.toml`.
    pub unit_config: String,
    /// Keys changed in the unit configuration.
    pub settings: Vec<Setting>,
    pub seed: u64,
}

/// A run, ready to be driven.
#[derive(Clone)]
pub struct Case {
    pub controller: ControllerKind,
    /// Unit configuration and line.
    pub bench: Arc<DriveBench>,
    pub plan: DrivePlan,
    /// Values that are held where the rest is drawn.
    pub fixed: Fixed,
    pub seed: u64,
}

/// A run that is over.
pub struct Driven {
    pub case: Case,
    pub outcome: Outcome,
}

impl Request {
    /// A case for each section and controller, controllers of a section side by side.
    ///
    /// # Errors
    /// A name that is not known, or a value out of range.
    pub fn cases(&self, directory: &ScriptsDirectory) -> Result<Vec<Case>, Failure> {
        self.fixed.check()?;
        self.one_controller_setting()?;
        let mut train = directory.train(&self.train)?;
        train::check_acts(&train, &self.fixed)?;
        let load_kg = train::load(&mut train, self.mass_kg, self.load)?;
        let fixed = Fixed {
            load_kg,
            ..self.fixed
        };
        let line = self.line.as_deref().unwrap_or(DEFAULT_LINE);
        let line = track(directory, line, &train)?;
        let sections = self.sections.unwrap_or(DEFAULT_SECTION);
        let sections = sections.numbers(&line.content)?;
        let benches = self.benches(directory, &train, &line)?;
        let told = (benches.iter()).find_map(|b| train::brakes_less(&train, &b.config.content));
        told.iter().for_each(|told| stdio::note(&told.to_string()));
        let mut cases = Vec::new();
        for section in sections {
            for bench in &benches {
                let code = self.code.as_deref();
                let (config, line) = (&bench.config.content, &bench.line.content);
                let mut plan = DrivePlan::new(config, line, train.clone(), section, code)
                    .map_err(|error| Failure::usage(DriveTrouble::NoPlan(error.to_string())))?;
                (plan.load_kg, plan.conditions) = fixed.hold(0.0, Conditions::default());
                cases.push(Case {
                    controller: config.ato.controller,
                    bench: bench.clone(),
                    plan,
                    fixed,
                    seed: self.seed,
                });
            }
        }
        Ok(cases)
    }

    /// Refuses a setting of the controller's key beside the option: the setting would win without a word.
    fn one_controller_setting(&self) -> Result<(), Failure> {
        let set = self
            .settings
            .iter()
            .find(|setting| setting.key == CONTROLLER_KEY);
        match set.filter(|_| !self.controllers.is_empty()) {
            Some(setting) => Err(Failure::usage(DriveTrouble::ControllerTwice(
                setting.to_string(),
            ))),
            None => Ok(()),
        }
    }

    /// A bench for each controller.
    fn benches(
        &self,
        directory: &ScriptsDirectory,
        train: &TrainData,
        line: &DataFile<Line>,
    ) -> Result<Vec<Arc<DriveBench>>, Failure> {
        let told = train::told(train);
        let bench = |controller: Option<&ControllerKind>| {
            let chosen = controller.map(|kind| Setting::new(CONTROLLER_KEY, kind.name()));
            let settings: Vec<_> = chosen
                .into_iter()
                .chain(told.iter().cloned())
                .chain(self.settings.clone())
                .collect();
            Ok(Arc::new(DriveBench {
                config: unit_config(directory, &self.unit_config, &settings)?,
                line: line.clone(),
                settings,
            }))
        };
        if self.controllers.is_empty() {
            return Ok(vec![bench(None)?]);
        }
        self.controllers
            .iter()
            .map(|kind| bench(Some(kind)))
            .collect()
    }
}

impl Case {
    /// This case with load and conditions drawn by `seed`; what is held fixed keeps its value.
    pub fn drawn(&self, scatter: &Scatter, seed: u64) -> Self {
        let drawn = scatter.draw(seed, self.plan.train.full_load_kg());
        let (load_kg, conditions) = self.fixed.hold(
            drawn.load_kg,
            train::acting(&self.plan.train, drawn.conditions),
        );
        Self {
            plan: DrivePlan {
                load_kg,
                conditions,
                ..self.plan.clone()
            },
            seed,
            ..self.clone()
        }
    }

    pub fn drive(&self) -> Outcome {
        drive(&self.bench, self.plan.clone(), self.seed)
    }

    /// Distance from the stop point at which doors may open, m.
    pub fn tolerance_m(&self) -> f64 {
        self.bench.config.content.doors.aligned_m
    }
}

impl Driven {
    /// Whether the train stopped within the range in which doors may open.
    pub fn aligned(&self) -> bool {
        let near = |error: f64| error.abs() <= self.case.tolerance_m();
        self.outcome.ending == Ending::Stopped && self.outcome.stop_error_m.is_some_and(near)
    }
}

/// The line called `name`, level for a train on which gradients do not act.
fn track(
    directory: &ScriptsDirectory,
    name: &str,
    train: &TrainData,
) -> Result<DataFile<Line>, Failure> {
    let mut line = directory.line(name)?;
    if train::needs_level_track(train) {
        for section in &mut line.content.sections {
            section.gradients.clear();
            section.curves.clear();
        }
        // Another track database than the file's, so another checksum.
        let level = format!("{} level", line.sha256);
        line.crc = checksum(&level);
        line.sha256 = sha256(&level);
    }
    Ok(line)
}

/// Drives all cases, some at a time, and gives them back in order, telling how many there are now and then. A stop leaves
/// cases out.
pub fn drive_all(
    cases: Vec<Case>,
    jobs: usize,
    stop: &Stop,
    tell: &mut dyn FnMut(usize),
) -> Vec<Driven> {
    let outcomes = pool::run(cases.len(), jobs, stop, tell, |i| cases[i].drive());
    let mut cases: Vec<_> = cases.into_iter().map(Some).collect();
    outcomes
        .into_iter()
        .filter_map(|(i, outcome)| {
            Some(Driven {
                case: cases.get_mut(i)?.take()?,
                outcome,
            })
        })
        .collect()
}
