//! `ptu ports`: serial ports found on this machine.

use clap::Args;

use super::Json;
use ptu_report::words::Words;
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::link::ports::found;

/// List serial ports; a pseudo-terminal is not listed but can be named
#[derive(Debug, Args)]
pub struct PortsArguments {
    #[command(flatten)]
    json: Json,
}

impl PortsArguments {
    pub fn run(self) -> Result<Exit, Failure> {
        let ports = found()?;
        let lines = ports.iter().map(|p| format!("{}  {}", p.path, p.kind));
        let text = || match ports.is_empty() {
            true => Words::shown().terminal.no_ports.to_owned(),
            false => lines.collect::<Vec<_>>().join("\n"),
        };
        self.json.answer(|| &ports, text)
    }
}
