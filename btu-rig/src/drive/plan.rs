//! Plan of an automatic run: section, speed codes, load, and what deviates from nominal.

use std::str::FromStr;

use protocol::config::{UnitConfig, find_code};
use protocol::line::{Line, Section};
use thiserror::Error;

use crate::conditions::Conditions;
use crate::stimulus::{CodeSignal, StationData, Stimulus};
use crate::train::TrainData;

/// Why a run cannot be planned.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PlanError {
    /// The line has no such section.
    #[error("line {line} has no section {section}; it has {known}")]
    NoSection {
        line: String,
        section: u16,
        /// Numbers of its sections, with commas.
        known: String,
    },
    /// A code is not in the unit's code table.
    #[error("section {section}: code \"{code}\" is not in the code table; it has {known}")]
    NoCode {
        section: u16,
        /// Name of the code in the track database.
        code: String,
        /// Names of the unit's codes, with commas.
        known: String,
    },
}

impl PlanError {
    /// `line` has no such section.
    pub(super) fn no_section(line: &Line, section: u16) -> Self {
        Self::NoSection {
            line: line.name.clone(),
            section,
            known: list(line.sections.iter().map(|s| s.section.to_string())),
        }
    }
}

/// Passengers aboard.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Load {
    /// 0 kg.
    #[default]
    Empty,
    /// Full load of the train's data, kg.
    Full,
    /// Mass of the passengers, kg.
    Passengers(f64),
}

impl FromStr for Load {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "empty" => Ok(Self::Empty),
            "full" => Ok(Self::Full),
            _ => text
                .parse()
                .map(Self::Passengers)
                .map_err(|_| format!("\"{text}\" is no load: use a mass in kg, empty or full")),
        }
    }
}

/// Speed codes of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Codes {
    /// Codes of the section, each from its place on.
    Along,
    /// One code from start to end.
    Fixed(Stimulus),
}

/// An automatic run from station to station.
#[derive(Clone, Debug, PartialEq)]
pub struct DrivePlan {
    /// Section of the track database that is run through.
    pub section: Section,
    /// Station after the arrival station, as the arrival loop says.
    pub onward_station: u16,
    /// Speed codes on the section.
    pub codes: Codes,
    /// ATO's target below the limit in normal running, km/h, from the unit's configuration.
    pub below_limit_kmh: f64,
    /// Train on the track: cars, or one point mass.
    pub train: TrainData,
    /// Passengers, kg.
    pub load_kg: f64,
    /// Differences of train and track from the unit's configuration.
    pub conditions: Conditions,
    /// The tester listens to the unit's own position, refusals and log. Without the tester a run is computed faster.
    pub tester: bool,
}

impl DrivePlan {
    /// A nominal run of an empty train through a section under the codes the line has for it, or
    /// under `code` from start to end.
    ///
    /// # Errors
    /// An unknown section or code.
    pub fn new(
        config: &UnitConfig,
        line: &Line,
        train: TrainData,
        section: u16,
        code: Option<&str>,
    ) -> Result<Self, PlanError> {
        let found = line
            .section(section)
            .ok_or_else(|| PlanError::no_section(line, section))?;
        let codes = match code {
            None if !found.speed_codes.is_empty() => Codes::Along,
            code => Codes::Fixed(fixed_code(config, section, code.unwrap_or(DEFAULT_CODE))?),
        };
        Ok(Self {
            section: found.clone(),
            onward_station: line.station_after(found),
            codes,
            below_limit_kmh: config.ato.below_limit_kmh + config.ato.normal_lowering_kmh,
            train,
            load_kg: 0.0,
            conditions: Conditions::default(),
            tester: true,
        })
    }

    /// Station data of the departure station's loop, departure given.
    pub(super) fn at_departure(&self) -> StationData {
        StationData {
            departure: true,
            ..StationData::at_departure(&self.section)
        }
    }

    /// Station data of the arrival station's loop.
    pub(super) fn at_arrival(&self) -> StationData {
        StationData::at_arrival(&self.section, self.onward_station)
    }
}

/// A code of the unit's table in the antenna, at the level its receiver is made for.
pub(super) fn fixed_code(
    config: &UnitConfig,
    section: u16,
    name: &str,
) -> Result<Stimulus, PlanError> {
    code_in_antenna(config, name).ok_or_else(|| PlanError::NoCode {
        section,
        code: name.to_owned(),
        known: list(config.codes.iter().map(|code| code.name.clone())),
    })
}

/// The code called `name` as a stimulus of the antenna; `None` = the unit's code table has no such code.
pub fn code_in_antenna(config: &UnitConfig, name: &str) -> Option<Stimulus> {
    let code = &config.codes[find_code(&config.codes, name)?];
    let level_mv = config.receiver.level_nominal_mv;
    let signal = CodeSignal::new(code.carrier_hz, code.rate_hz, level_mv);
    Some(Stimulus::Code(signal))
}

/// Code of a section that names none: with 5 km/h below its limit the target is S0's 60 km/h.
const DEFAULT_CODE: &str = "65";

fn list(names: impl Iterator<Item = String>) -> String {
    names.collect::<Vec<_>>().join(", ")
}
