//! The program around the unit: arguments, data files, pacing and the wire's far end.

mod data;
mod wire;

use std::path::PathBuf;

use anyhow::{Context, Result};
use ato_under_test::Unit;
use clap::{ArgGroup, Parser};
use protocol::{Instant, SCAN};
use rustix::time::{ClockId, Timespec};

pub use data::UsageError;
use wire::Wire;

const NANOS_PER_SECOND: i64 = 1_000_000_000;
/// Time between scans that are made up.
const MAKE_UP_NANOS: i64 = 1_000_000;

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
    /// Serve one TCP client at a time
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
    /// Directory with units/ and lines/
    #[arg(long, value_name = "DIR", env = "PTU_SCRIPTS")]
    scripts: Option<PathBuf>,
}

/// Serves until the process is ended.
pub fn serve(arguments: &Arguments) -> Result<()> {
    let setup = data::setup(arguments)?;
    let mut wire = Wire::open(arguments)?;
    eprintln!(
        "unit {} with configuration {} is up",
        setup.serial, setup.config.name
    );
    run(Unit::new(setup), &mut wire)
}

/// One scan every 10 ms of the monotonic clock; a late scan is made up, not skipped.
fn run(mut unit: Unit, wire: &mut Wire) -> Result<()> {
    let mut due = rustix::time::clock_gettime(ClockId::Monotonic);
    let mut now = Instant::ZERO;
    let mut received = [0u8; 4096];
    let mut to_send = Vec::with_capacity(1024);
    loop {
        sleep_until(&mut due)?;
        let count = wire.read(&mut received).context("reading from the wire")?;
        unit.receive(&received[..count]);
        to_send.clear();
        unit.step(now, &mut to_send);
        wire.write(&to_send).context("writing to the wire")?;
        now += SCAN;
    }
}

/// Sleeps to the next scan. Late scans are made up no faster than one a millisecond, so that the
/// other end can follow scan by scan.
fn sleep_until(due: &mut Timespec) -> Result<()> {
    *due = later(*due, SCAN.as_us() as i64 * 1000);
    let soonest = later(
        rustix::time::clock_gettime(ClockId::Monotonic),
        MAKE_UP_NANOS,
    );
    let late = (due.tv_sec, due.tv_nsec) < (soonest.tv_sec, soonest.tv_nsec);
    let wake = if late { soonest } else { *due };
    while let Err(error) =
        rustix::thread::clock_nanosleep_absolute(rustix::thread::ClockId::Monotonic, &wake)
    {
        if error != rustix::io::Errno::INTR {
            return Err(error).context("waiting for the next scan");
        }
    }
    Ok(())
}

fn later(mut at: Timespec, nanos: i64) -> Timespec {
    at.tv_nsec += nanos;
    if at.tv_nsec >= NANOS_PER_SECOND {
        at.tv_nsec -= NANOS_PER_SECOND;
        at.tv_sec += 1;
    }
    at
}
