//! `--unit` and the options that describe the unit, for commands that read a unit and do not drive it.

use clap::Args;

use ptu_runs::link::Endpoint;
use ptu_runs::unit_log::AskedUnit;

/// Options that name and describe the unit on a port.
#[derive(Debug, Args)]
pub struct UnitOption {
    /// The unit: serial:PATH[@BAUD] or tcp:HOST:PORT
    #[arg(long, value_name = "UNIT")]
    unit: Endpoint,
    /// Serial number that the unit should report
    #[arg(long, value_name = "TEXT")]
    serial_no: Option<String>,
    /// Unit configuration of the unit, units/NAME.toml
    #[arg(long, value_name = "NAME", default_value = "sg100")]
    unit_config: String,
    /// Line in the unit's track database, lines/NAME.toml
    #[arg(long, value_name = "NAME", default_value = "line8")]
    line: String,
    /// Train the unit is in, as the depot names it
    #[arg(long, value_name = "TEXT", default_value = "")]
    train_no: String,
    /// Who reads the unit
    #[arg(long, value_name = "TEXT", default_value = "")]
    who: String,
}

impl UnitOption {
    /// The unit that is asked for.
    pub fn asked(&self) -> AskedUnit {
        AskedUnit {
            endpoint: self.unit.clone(),
            serial: self.serial_no.clone(),
            unit_config: self.unit_config.clone(),
            line: self.line.clone(),
            train: self.train_no.clone(),
            operator: self.who.clone(),
        }
    }
}
