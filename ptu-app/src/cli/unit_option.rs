//! `--unit` and what is known of the unit, for commands that read it and drive nothing.

use clap::Args;

use ptu_runs::link::Endpoint;
use ptu_runs::unit_log::AskedUnit;

/// The unit on a port.
#[derive(Debug, Args)]
pub struct UnitOption {
    /// The unit: serial:PATH[@BAUD] or tcp:HOST:PORT
    #[arg(long, value_name = "UNIT")]
    unit: Endpoint,
    /// Serial number expected of it
    #[arg(long, value_name = "TEXT")]
    serial_no: Option<String>,
    /// Unit configuration it has, units/NAME.toml
    #[arg(long, value_name = "NAME", default_value = "sg100")]
    unit_config: String,
    /// Line it has, lines/NAME.toml
    #[arg(long, value_name = "NAME", default_value = "line8")]
    line: String,
    /// Train the unit is in, as the depot names it
    #[arg(long, value_name = "TEXT", default_value = "")]
    train_no: String,
    /// Who reads
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
