//! The program around the unit: arguments, data files, pacing and the wire's far end.

mod data;
mod stdio;
mod tcp;
mod wire;

use std::path::PathBuf;

use anyhow::{Context, Result};
use ato_under_test::{Port, Unit};
use clap::{ArgGroup, Parser};
use protocol::frame::SCAN_END;
use protocol::{Backlog, Instant, SCAN, ScanDeadlines};

pub use data::UsageError;
pub use stdio::note;
use wire::Wire;

/// An on-board ATC unit (ATP + ATO + TWC) to be tested over a wire.
///
/// Examples:
///   ato-under-test --pty
///   ato-under-test --pty --inject eb_relay.welded
///   ato-under-test --tcp 127.0.0.1:7000 --unit-config sg100
#[derive(Debug, Parser)]
#[command(version, verbatim_doc_comment)]
#[command(group(ArgGroup::new("wire").required(true).args(["pty", "serial", "tcp"])))]
pub struct Arguments {
    /// Serve on a new pseudo-terminal and print its name
    #[arg(long)]
    pty: bool,
    /// Serve on a serial port
    #[arg(long, value_name = "PATH[@BAUD]")]
    serial: Option<String>,
    /// Serve one TCP client at a time; others are told that the unit is taken
    #[arg(long, value_name = "HOST:PORT")]
    tcp: Option<String>,
    /// Faults to inject, from `ptu catalog faults`
    #[arg(long, value_name = "FAULT[,FAULT]", value_delimiter = ',')]
    inject: Vec<String>,
    /// Unit configuration, scripts/units/NAME.toml
    #[arg(long, value_name = "NAME", default_value = "sg100")]
    unit_config: String,
    /// Track database, scripts/lines/NAME.toml
    #[arg(long, value_name = "NAME", default_value = "line8")]
    line: String,
    /// Serial number the unit reports
    #[arg(long, value_name = "TEXT", default_value = "SIM-0001")]
    serial_no: String,
    /// Seed of arm challenges and injected noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Go so many times slower than the clock, for a computer too busy for real time; the tester must do
    /// the same, `ptu run --slower`
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100))]
    slower: u32,
    /// Scan once for each scan of the tester instead of by the clock; the tester is `ptu run --unit
    /// lockstep:PATH`
    #[arg(long, requires = "pty", conflicts_with = "slower")]
    lock_step: bool,
    /// Directory with units/ and lines/
    #[arg(long, value_name = "DIR", env = "PTU_SCRIPTS")]
    scripts: Option<PathBuf>,
}

/// Serves until the process is ended.
pub fn serve(arguments: &Arguments) -> Result<()> {
    let setup = data::setup(arguments)?;
    let mut wire = Wire::open(arguments)?;
    stdio::note(&format!(
        "unit {} with configuration {} is up",
        setup.serial, setup.config.name
    ));
    let unit = Unit::new(setup);
    if arguments.lock_step {
        return run_in_lock_step(unit, &mut wire);
    }
    run(unit, &mut wire, arguments.slower)
}

/// One scan for each that the tester has sent, and the answer to it at once.
fn run_in_lock_step(mut unit: Unit, wire: &mut Wire) -> Result<()> {
    let mut now = Instant::ZERO;
    let mut received = Vec::with_capacity(1024);
    let mut to_send = Vec::with_capacity(1024);
    loop {
        received.clear();
        while !received.ends_with(&SCAN_END) {
            let mut read = [0u8; 4096];
            let count = wire.read(&mut read).context("reading from the wire")?;
            received.extend_from_slice(&read[..count]);
        }
        unit.receive(&received);
        to_send.clear();
        unit.step(now, &mut to_send);
        to_send.extend(SCAN_END);
        wire.write(&to_send).context("writing to the wire")?;
        now += SCAN;
    }
}

/// One scan every 10 ms of the monotonic clock, or so many times that; a late scan is made up, not skipped.
fn run(mut unit: Unit, wire: &mut Wire, slower: u32) -> Result<()> {
    let began = std::time::Instant::now();
    let clock = || Instant::from_us(began.elapsed().as_micros() as u64);
    let mut deadlines = ScanDeadlines::new(clock(), slower);
    let mut now = Instant::ZERO;
    let mut read = [0u8; 4096];
    let mut backlog = Backlog::default();
    let mut received = Vec::with_capacity(1024);
    let mut to_send = Vec::with_capacity(1024);
    loop {
        let wait = deadlines.next(clock()).since(clock());
        std::thread::sleep(std::time::Duration::from_micros(wait.as_us()));
        let behind = deadlines.behind(clock());
        let another = wire.attend(now, behind, unit.frames_accepted(Port::Harness));
        if another.context("attending to the wire")? {
            backlog = Backlog::default();
            unit.reset_connection(Port::Harness);
        }
        let count = wire.read(&mut read).context("reading from the wire")?;
        received.clear();
        backlog.share(&read[..count], behind, &mut received);
        unit.receive(&received);
        to_send.clear();
        unit.step(now, &mut to_send);
        wire.write(&to_send).context("writing to the wire")?;
        now += SCAN;
    }
}
