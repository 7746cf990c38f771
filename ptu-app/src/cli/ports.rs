//! `ptu ports`: serial ports found on this machine.

use clap::Args;

use super::{print_json, print_out};
use ptu_bench::failure::{Exit, Failure};
use ptu_bench::link::ports::found;

/// List serial ports; a pseudo-terminal is not listed but can be named
#[derive(Debug, Args)]
pub struct PortsArguments {
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl PortsArguments {
    /// Lists them.
    pub fn run(self) -> Result<Exit, Failure> {
        let ports = found()?;
        if self.json {
            return print_json(&ports);
        }
        if ports.is_empty() {
            return print_out("no serial ports found; name one with --unit serial:PATH");
        }
        let lines: Vec<_> = ports
            .iter()
            .map(|p| format!("{}  {}", p.path, p.kind))
            .collect();
        print_out(&lines.join("\n"))
    }
}
