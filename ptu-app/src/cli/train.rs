//! `ptu train`: serves a simulated train with a maintenance port for a laptop.

use std::path::PathBuf;

use btu_rig::rig::Harness;
use clap::{ArgGroup, Args};
use ptu_runs::drive::SectionChoice;
use ptu_runs::failure::{Exit, Failure, RunTrouble};
use ptu_runs::run::BenchChoice;
use ptu_runs::stdio;
use ptu_runs::stop::Stop;
use ptu_runs::train_server::{self, NO_AUTHENTICATION, PortAddress, TrainRequest, check_exposed};

use super::ScriptsOption;

/// Serve a unit built into a simulated train: other programs reach only the unit's maintenance port
///
/// The train itself drives all inputs and outputs of the unit. The train stands in a depot with the cab on, mode
/// manual, doors closed and the maintenance key on. Standard output has the port's name alone. Each line on standard
/// input is an action in the cab: key on|off, mode NAME, cab on|off, doors open|closed, ack, start, move KMH, stop,
/// code NAME|off, power on|off, quit. Ends with exit code 0 by quit, Ctrl-C or SIGTERM.
///
/// Examples:
///   ptu train --pty
///   ptu train --pty --service 61,62,63          after three sections: with a log and a run record
///   ptu train --tcp 127.0.0.1:7000 --inject tra.dead
///   ptu train --serial /dev/ttyUSB1 --section 61   at a station instead of in the depot
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
#[command(group(ArgGroup::new("port").required(true).args(["pty", "serial", "tcp"])))]
pub struct TrainArguments {
    /// Serve on a new pseudo-terminal
    #[arg(long)]
    pty: bool,
    /// Serve on a serial port [default rate: 115200]
    #[arg(long, value_name = "PATH[@BAUD]", value_parser = PortAddress::serial)]
    serial: Option<PortAddress>,
    /// Serve one TCP client at a time; others get the answer that the unit is taken
    #[arg(long, value_name = "HOST:PORT")]
    tcp: Option<String>,
    /// Serve at an address that other computers reach, too: there is no authentication
    #[arg(long, requires = "tcp")]
    expose: bool,
    /// Line, lines/NAME.toml
    #[arg(long, value_name = "NAME", default_value = "line8")]
    line: String,
    /// Stand at the departure station of this section, over its loop and under its codes
    #[arg(long, value_name = "N", conflicts_with = "service")]
    section: Option<u16>,
    /// Drive these sections by the unit's ATO, in virtual time, before the port is opened
    #[arg(long, value_name = "N,N|A-B|all", value_delimiter = ',')]
    service: Vec<SectionChoice>,
    /// Train, trains/NAME.toml or a file ending in .toml
    #[arg(long, value_name = "NAME|FILE", default_value = "line6")]
    train: String,
    /// Unit configuration, units/NAME.toml
    #[arg(long, value_name = "NAME", default_value = "sg100")]
    unit_config: String,
    /// Serial number the unit reports
    #[arg(long, value_name = "TEXT", default_value = "SIM-0001")]
    serial_no: String,
    /// Faults to inject into unit or train, see `ptu catalog faults`
    #[arg(long, value_name = "FAULT[,FAULT]", value_delimiter = ',')]
    inject: Vec<String>,
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Keep the unit's event log and run record in this file for the next start; the file is made if it is not there
    #[arg(long, value_name = "FILE")]
    flash: Option<PathBuf>,
    /// Run N times slower than real time; the tester must do the same, `ptu run --slower`
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100))]
    slower: u32,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl TrainArguments {
    /// Serves the train until it is stopped.
    pub fn run(self) -> Result<Exit, Failure> {
        let directory = self.scripts.find()?;
        let place = match (self.serial, self.tcp) {
            (Some(port), _) => port,
            (_, Some(address)) => {
                check_exposed(&address, self.expose)
                    .map_err(|why| Failure::usage(RunTrouble::NotServed(why)))?;
                stdio::note(NO_AUTHENTICATION);
                PortAddress::Tcp(address)
            }
            _ => PortAddress::Pty,
        };
        let request = TrainRequest {
            place,
            choice: BenchChoice {
                line: self.line,
                unit_config: self.unit_config,
                train: self.train,
                serial: self.serial_no,
                faults: self.inject,
                harness: Harness::None,
                seed: self.seed,
                slower: self.slower,
                ..BenchChoice::default()
            },
            section: self.section,
            service: self.service,
            flash: self.flash,
        };
        let stop = Stop::default();
        stop.listen();
        train_server::serve(&request, &directory, &stop)?;
        Ok(Exit::Passed)
    }
}
