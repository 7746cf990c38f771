//! `ptu drive`: station-to-station automatic runs.

use btu_rig::drive::DrivePlan;
use clap::Args;
use protocol::config::ControllerKind;
use serde_json::json;

use super::{ScriptsOption, print_json, print_out};
use crate::drive::{DriveBench, Setting, drive, unit_config};
use crate::failure::{Exit, Failure, did_you_mean};

/// Drive from station to station and measure the stop
///
/// Examples:
///   ptu drive --line line8 --section 61 --json
///   ptu drive --set ato.servo.s_curve_s=12
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct DriveArguments {
    /// Line, lines/NAME.toml
    #[arg(long, value_name = "NAME", default_value = "line8")]
    line: String,
    /// Section number
    #[arg(long, value_name = "N", default_value_t = 61)]
    section: u16,
    /// Speed controller: servo, fuzzy, pi or pss [default: the configuration's]
    #[arg(long, value_name = "NAME")]
    controller: Option<String>,
    /// Code all along the section, instead of the line's
    #[arg(long, value_name = "NAME")]
    code: Option<String>,
    /// Unit configuration key to change, as ato.servo.s_curve_s=12; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<Setting>,
    /// Unit configuration, units/NAME.toml
    #[arg(long, value_name = "NAME", default_value = "sg100")]
    unit_config: String,
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl DriveArguments {
    /// Drives and prints.
    pub fn run(self) -> Result<Exit, Failure> {
        let directory = self.scripts.find()?;
        let mut settings = self.set.clone();
        if let Some(name) = &self.controller {
            let known = ControllerKind::ALL.map(ControllerKind::name);
            if ControllerKind::from_name(name).is_none() {
                return Err(Failure::usage(format!(
                    "no controller \"{name}\"{}; known: {}",
                    did_you_mean(name, known),
                    known.join(", ")
                )));
            }
            settings.insert(0, Setting::new("ato.controller", name.as_str()));
        }
        let bench = DriveBench {
            config: unit_config(&directory, &self.unit_config, &settings)?,
            line: directory.line(&self.line)?,
        };
        let (config, line) = (&bench.config.content, &bench.line.content);
        let plan = DrivePlan::new(config, line, self.section, self.code.as_deref())
            .map_err(|error| Failure::usage(error.to_string()))?;
        let outcome = drive(&bench, plan, self.seed);
        let metrics = outcome.metrics;
        let events: Vec<_> = outcome
            .landmarks
            .iter()
            .map(|l| json!({"t_s": l.t_s, "x_m": l.x_m, "what": l.what}))
            .collect();
        let value = json!({
            "line": self.line,
            "section": self.section,
            "controller": config.ato.controller.name(),
            "ending": outcome.ending.to_string(),
            "stop_error_m": metrics.map(|m| m.stop_error_m),
            "run_time_s": metrics.map(|m| m.run_time_s),
            "peak_accel_kmh_s": metrics.map(|m| m.peak_accel_kmh_s),
            "peak_decel_kmh_s": metrics.map(|m| m.peak_decel_kmh_s),
            "peak_jerk_m_s3": metrics.map(|m| m.peak_jerk_m_s3),
            "rms_speed_error_kmh": metrics.map(|m| m.rms_speed_error_kmh),
            "energy_kwh": metrics.map(|m| m.energy_kwh),
            "events": events,
        });
        if self.json {
            print_json(&value)?;
        } else {
            print_out(&format!("{value:#}"))?;
        }
        let good = metrics.is_some_and(|m| m.stop_error_m.abs() <= config.doors.aligned_m);
        Ok(if good { Exit::Passed } else { Exit::Failed })
    }
}
