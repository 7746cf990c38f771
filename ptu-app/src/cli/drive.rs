//! `ptu drive`: station-to-station automatic runs.

use std::path::{Path, PathBuf};

use btu_rig::conditions::Disturbance;
use btu_rig::drive::{Ending, Load, Scatter};
use clap::Args;
use protocol::config::ControllerKind;

use super::keep::KeepOptions;
use super::{Json, ScriptsOption, answered, made_by};
use ptu_report::Target;
use ptu_report::drive::{self as report, Outcomes, Results};
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::drive::{
    Driven, Fixed, Request, SectionChoice, Setting, disturbance, drive_all, monte_carlo,
};
use ptu_runs::failure::{DriveTrouble, Exit, Failure, FileTrouble, did_you_mean};
use ptu_runs::pool::cores;
use ptu_runs::stop::Stop;
use ptu_runs::whole_file::read;

/// Drive from station to station and measure the stop
///
/// Exit codes: 0 the train stopped within the door tolerance, 1 it did not. With --monte-carlo, 0 if 99.9 %
/// of the runs did and none went more than 1 m too far.
///
/// Examples:
///   ptu drive                                   line 8 section 61, empty line 6 train
///   ptu drive --section 54-65 --load full       twelve sections
///   ptu drive --compare servo,fuzzy,pi,pss --report compare.html
///   ptu drive --train ideal --mass 432000 --disturbance s1 --controller fuzzy
///   ptu drive --monte-carlo 10000 --json
///   ptu drive --monte-carlo 10000 --shard 3/64 --runs shard-3.zst
///   ptu drive --set ato.servo.s_curve_s=12 --set 'ato.controller="pss"'
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct DriveArguments {
    /// Line, lines/NAME.toml [default: line8]
    #[arg(long, value_name = "NAME")]
    line: Option<String>,
    /// Sections: a number, A-B or all [default: 61]
    #[arg(long, value_name = "N")]
    section: Option<SectionChoice>,
    /// Speed controller: servo, fuzzy, pi or pss [default: the configuration's]
    #[arg(long, value_name = "NAME", value_parser = controller)]
    controller: Option<ControllerKind>,
    /// Speed controllers to compare, side by side
    #[arg(long, value_name = "NAME,NAME", value_delimiter = ',', value_parser = controller, conflicts_with = "controller")]
    compare: Vec<ControllerKind>,
    /// Train: line6, ideal or another trains/NAME.toml, or a file ending in .toml
    #[arg(long, value_name = "NAME|FILE", default_value = "line6")]
    train: String,
    /// Total mass: of the ideal train, for which the unit is configured; or of a train of cars, loaded up to this mass
    #[arg(
        long,
        value_name = "KG",
        conflicts_with = "load",
        allow_negative_numbers = true
    )]
    mass: Option<f64>,
    /// Passengers: a mass, empty or full [default: empty]
    #[arg(long, value_name = "KG|empty|full", allow_negative_numbers = true)]
    load: Option<Load>,
    /// Force against the train: none, s1 or AMP@HZ in N·s/m and Hz
    #[arg(long, value_name = "NAME", value_parser = disturbance)]
    disturbance: Option<Disturbance>,
    /// Gradient added to the whole line, ‰, uphill positive
    #[arg(long, value_name = "PERMILLE", allow_negative_numbers = true)]
    gradient: Option<f64>,
    /// Wheel–rail adhesion coefficient at standstill
    #[arg(long, value_name = "MU", allow_negative_numbers = true)]
    adhesion: Option<f64>,
    /// True wheel diameter divided by the configured diameter
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true)]
    wheel: Option<f64>,
    /// Speed code on the whole way, in place of the line's codes
    #[arg(long, value_name = "NAME")]
    speed_code: Option<String>,
    /// Unit configuration key to change, as ato.servo.s_curve_s=12; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<Setting>,
    /// Unit configuration, units/NAME.toml
    #[arg(long, value_name = "NAME", default_value = "sg100")]
    unit_config: String,
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Draw train and day by the seed, as for one run of --monte-carlo; from scatter.toml or FILE
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true, conflicts_with = "monte_carlo")]
    scattered: Option<Option<PathBuf>>,
    /// Make N runs with train and day drawn from scatter.toml, with seeds from --seed on
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    monte_carlo: Option<u32>,
    /// Number of runs side by side [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=256))]
    jobs: Option<u32>,
    #[command(flatten)]
    keep: KeepOptions,
    #[command(flatten)]
    json: Json,
    /// Write a report, .html, .json or .csv; repeatable
    #[arg(long, value_name = "FILE", value_parser = report::target)]
    report: Vec<Target>,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl DriveArguments {
    /// Drives, prints the results, and writes reports.
    pub fn run(self) -> Result<Exit, Failure> {
        let directory = self.scripts.find()?;
        for target in &self.report {
            target.check()?;
        }
        self.keep.check(self.monte_carlo.is_some())?;
        let mut cases = self.request()?.cases(&directory)?;
        let stop = Stop::default();
        stop.listen();
        let jobs = self.jobs.map_or_else(cores, |jobs| jobs as usize);
        let outcomes = match self.monte_carlo {
            Some(count) => {
                let scatter = scatter(&directory, None)?;
                let count = count as usize;
                let keep = self.keep.keep()?;
                match monte_carlo::run(cases, count, &scatter, &keep, (jobs, &stop))? {
                    monte_carlo::Ran::All(many) => Outcomes::Many(many),
                    monte_carlo::Ran::Part(runs) => return self.keep.told(runs),
                }
            }
            None => {
                if let Some(file) = &self.scattered {
                    let scatter = scatter(&directory, file.as_deref())?;
                    cases = cases
                        .iter()
                        .map(|case| case.drawn(&scatter, self.seed))
                        .collect();
                }
                Outcomes::Single(drive_all(cases, jobs, &stop, &mut |_| {}))
            }
        };
        let results = Results {
            outcomes,
            list: !self.compare.is_empty()
                || !matches!(self.section, None | Some(SectionChoice::One(_))),
            made: Some(made_by()),
        };
        self.answer(&results, &stop)
    }

    fn request(&self) -> Result<Request, Failure> {
        let mut controllers: Vec<_> = self.controller.into_iter().collect();
        for &kind in &self.compare {
            if controllers.contains(&kind) {
                return Err(Failure::usage(DriveTrouble::Twice(kind.name())));
            }
            controllers.push(kind);
        }
        Ok(Request {
            line: self.line.clone(),
            sections: self.section,
            controllers,
            train: self.train.clone(),
            mass_kg: self.mass,
            load: self.load,
            fixed: Fixed {
                load_kg: None,
                gradient_permille: self.gradient,
                adhesion: self.adhesion,
                wheel_factor: self.wheel,
                disturbance: self.disturbance,
            },
            code: self.speed_code.clone(),
            unit_config: self.unit_config.clone(),
            settings: self.set.clone(),
            seed: self.seed,
        })
    }

    fn answer(&self, results: &Results, stop: &Stop) -> Result<Exit, Failure> {
        let told = (self.json).answer(|| report::json(results), || report::text(results));
        for target in &self.report {
            report::write(results, target)?;
        }
        let passed = match &results.outcomes {
            _ if stop.presses() > 0 => return answered(told, Exit::Aborted),
            Outcomes::Many(many) => many.iter().all(|one| one.passed()),
            Outcomes::Single(runs) => {
                let mut endings = runs.iter().map(|run| &run.outcome.ending);
                let lost = endings.find_map(|ending| match ending {
                    Ending::LinkLost(why) => Some(DriveTrouble::LinkLost(why.clone())),
                    Ending::Refused(why) => Some(DriveTrouble::Refused(why.clone())),
                    _ => None,
                });
                if let Some(why) = lost {
                    return Err(Failure::bench(why));
                }
                runs.iter().all(Driven::aligned)
            }
        };
        answered(told, if passed { Exit::Passed } else { Exit::Failed })
    }
}

fn scatter(directory: &ScriptsDirectory, file: Option<&Path>) -> Result<Scatter, Failure> {
    let (text, place) = match file {
        Some(file) => (read(file)?, file.display().to_string()),
        None => (
            directory.text("scatter.toml")?,
            directory.shown("scatter.toml"),
        ),
    };
    Scatter::from_toml(&text).map_err(|error| Failure::usage(FileTrouble::wrong(place, error)))
}

fn controller(name: &str) -> Result<ControllerKind, String> {
    ControllerKind::from_name(name).ok_or_else(|| {
        let known = ControllerKind::ALL.map(ControllerKind::name);
        let near = did_you_mean(name, known);
        format!(
            "no controller \"{name}\"{near}; known: {}",
            known.join(", ")
        )
    })
}
