//! What is chosen for a unit.

use std::str::FromStr;

use btu_rig::procedure::plan::Connection;
use serde::{Deserialize, Serialize};

use crate::failure::Failure;
use crate::link::Endpoint;
use crate::run::Choice;

/// What is chosen for a unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct UnitChoice {
    /// `sim`, `serial:PATH[@BAUD]` or `tcp:HOST:PORT`.
    pub endpoint: String,
    /// The laptop on the maintenance port, which has no bench harness.
    pub as_ptu: bool,
    /// Line.
    pub line: String,
    /// Unit configuration.
    pub unit_config: String,
    /// Train.
    pub train: String,
    /// Serial number expected, or given to the embedded unit; empty = any.
    pub serial: String,
    /// The train the unit is in, as the depot names it; empty = nobody says.
    pub train_no: String,
    /// Faults injected; nobody wants to find one left over from yesterday.
    #[serde(skip)]
    pub faults: Vec<String>,
    /// Seed of everything random.
    pub seed: u64,
    /// Good units differ.
    pub scatter: bool,
    /// Runs on the embedded unit take as long as on a real one.
    pub realtime: bool,
}

impl Default for UnitChoice {
    fn default() -> Self {
        Self {
            endpoint: "sim".into(),
            as_ptu: false,
            line: "line8".into(),
            unit_config: "sg100".into(),
            train: "line6".into(),
            serial: String::new(),
            train_no: String::new(),
            faults: Vec::new(),
            seed: 1,
            scatter: false,
            realtime: false,
        }
    }
}

impl UnitChoice {
    /// The embedded unit.
    pub fn is_simulated(&self) -> bool {
        self.endpoint == "sim"
    }

    /// How it is connected.
    pub fn connection(&self) -> Connection {
        if self.as_ptu {
            Connection::Ptu
        } else {
            Connection::Btu
        }
    }

    /// As the command line would have it.
    ///
    /// # Errors
    /// The endpoint is none.
    pub fn named(&self) -> Result<Choice, Failure> {
        let unit = Endpoint::from_str(&self.endpoint).map_err(Failure::usage)?;
        let faults = match unit {
            Endpoint::Sim => self.faults.clone(),
            _ => Vec::new(),
        };
        Ok(Choice {
            unit,
            line: self.line.clone(),
            unit_config: self.unit_config.clone(),
            train: self.train.clone(),
            settings: Vec::new(),
            serial: (!self.serial.is_empty()).then(|| self.serial.clone()),
            faults,
            seed: self.seed,
            scatter: self.scatter.then_some(None),
            realtime: self.realtime,
            slower: 1,
        })
    }
}
