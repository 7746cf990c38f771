//! What is run: a section, its codes, the train's load, and what is other than nominal.

use protocol::config::UnitConfig;
use protocol::line::{Line, Section};
use protocol::message::{DoorSide, RunningMode};
use thiserror::Error;

use crate::conditions::Conditions;
use crate::stimulus::{StationData, Stimulus};

/// Train number the wayside names [default].
const TRAIN_NUMBER: u16 = 8001;

/// Why a run cannot be planned.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PlanError {
    /// The line has no such section.
    #[error("line {line} has no section {section}; it has {known}")]
    NoSection {
        /// The line.
        line: String,
        /// Section asked for.
        section: u16,
        /// Sections there are.
        known: String,
    },
    /// A code along the section is not in the unit's code table.
    #[error("section {section}: code \"{code}\" is not in the code table; it has {known}")]
    NoCode {
        /// The section.
        section: u16,
        /// Code asked for.
        code: String,
        /// Codes there are.
        known: String,
    },
}

/// A code put into the antenna from a place on.
#[derive(Clone, Debug, PartialEq)]
pub struct CodeAt {
    /// Where, m in the section.
    pub at_m: f64,
    /// What is applied there.
    pub stimulus: Stimulus,
}

/// A run.
#[derive(Clone, Debug, PartialEq)]
pub struct DrivePlan {
    /// The section.
    pub section: Section,
    /// Station after the arrival station, as the arrival loop says.
    pub onward_station: u16,
    /// Codes along it; the first lies at its start.
    pub codes: Vec<CodeAt>,
    /// ATO's target below the limit, km/h, from the unit's configuration.
    pub below_limit_kmh: f64,
    /// Passengers, kg.
    pub load_kg: f64,
    /// How train and track differ from what the unit is told.
    pub conditions: Conditions,
    /// The tester listens: unit's own position, refusals and log. Without it a run is quicker.
    pub tester: bool,
}

impl DrivePlan {
    /// A nominal run of an empty train through a section under the codes the line has for it, or
    /// under `code` all along.
    ///
    /// # Errors
    /// An unknown section or code.
    pub fn new(
        config: &UnitConfig,
        line: &Line,
        section: u16,
        code: Option<&str>,
    ) -> Result<Self, PlanError> {
        let found = line.section(section).ok_or_else(|| PlanError::NoSection {
            line: line.name.clone(),
            section,
            known: list(line.sections.iter().map(|s| s.section.to_string())),
        })?;
        let mut along: Vec<_> = match code {
            Some(code) => vec![(found.start_m, code)],
            None => found
                .speed_codes
                .iter()
                .map(|from| (from.at_m, from.code.as_str()))
                .collect(),
        };
        if along.is_empty() {
            along.push((found.start_m, DEFAULT_CODE));
        }
        let find = |(at_m, name): (f64, &str)| {
            let code = config.codes.iter().find(|code| code.name == name);
            let code = code.ok_or_else(|| PlanError::NoCode {
                section,
                code: name.to_owned(),
                known: list(config.codes.iter().map(|code| code.name.clone())),
            })?;
            let stimulus = Stimulus::Code {
                carrier_hz: code.carrier_hz,
                rate_hz: code.rate_hz,
                level_mv: config.receiver.level_nominal_mv,
            };
            Ok(CodeAt { at_m, stimulus })
        };
        let onward = line
            .sections
            .iter()
            .find(|s| s.from_station == found.to_station);
        Ok(Self {
            section: found.clone(),
            onward_station: onward.map_or(found.to_station, |s| s.to_station),
            codes: along.into_iter().map(find).collect::<Result<_, _>>()?,
            below_limit_kmh: config.ato.below_limit_kmh,
            load_kg: 0.0,
            conditions: Conditions::default(),
            tester: true,
        })
    }

    /// What the departure station's loop says: departure given.
    pub(super) fn at_departure(&self) -> StationData {
        let section = &self.section;
        StationData {
            route: section.route,
            section: section.section,
            station: section.from_station,
            next_station: section.to_station,
            loop_id: section.from_loop,
            fixed_speed_kmh: None,
            running_mode: RunningMode::Normal,
            door_side: DoorSide::None,
            departure: true,
            train_number: TRAIN_NUMBER,
        }
    }

    /// What the arrival station's loop says.
    pub(super) fn at_arrival(&self) -> StationData {
        let section = &self.section;
        StationData {
            station: section.to_station,
            next_station: self.onward_station,
            loop_id: section.to_loop,
            door_side: DoorSide::from_label(&section.door_side).unwrap_or(DoorSide::None),
            departure: false,
            ..self.at_departure()
        }
    }
}

/// Code of a section that names none: with 5 km/h below its limit the target is S0's 60 km/h.
const DEFAULT_CODE: &str = "65";

fn list(names: impl Iterator<Item = String>) -> String {
    names.collect::<Vec<_>>().join(", ")
}
