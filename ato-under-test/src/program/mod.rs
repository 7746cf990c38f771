//! The program around the unit: arguments and data files.

mod data;
mod stdio;

use std::error::Error;
use std::hash::{BuildHasher as _, RandomState};
use std::ops::ControlFlow;
use std::path::PathBuf;

use ato_under_test::serve::{
    Listener, NO_AUTHENTICATION, PortAddress, ServeError, Served, Wire, check_exposed, in_real_time,
};
use ato_under_test::{Port, Unit};
use clap::{ArgGroup, Parser};
use protocol::frame::SCAN_END;
use protocol::{Instant, SCAN};

pub use data::UsageError;
pub use stdio::note;

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
    #[arg(long, value_name = "PATH[@BAUD]", value_parser = PortAddress::serial)]
    serial: Option<PortAddress>,
    /// Serve one TCP client at a time; others are told that the unit is taken
    #[arg(long, value_name = "HOST:PORT")]
    tcp: Option<String>,
    /// Serve at an address that other computers reach, too: there is no authentication
    #[arg(long, requires = "tcp")]
    expose: bool,
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
    /// Seed of injected noise, and in lock step of arm challenges, which otherwise differ from start to start
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
    /// Keep event log and run record in this file from start to start; made if it is not there
    #[arg(long, value_name = "FILE")]
    flash: Option<PathBuf>,
    /// Hear codes, TWC and markers at a sound card instead of in the frames: the first channel is the ATP
    /// antenna, the second that of TWC and markers
    #[arg(long, value_name = "sound:DEVICE", value_parser = sound_device, conflicts_with_all = ["lock_step", "slower"])]
    signals: Option<String>,
    /// What a whole sample of the sound card stands for
    #[arg(
        long,
        value_name = "MV",
        default_value_t = 4000.0,
        value_parser = millivolts,
        requires = "signals"
    )]
    full_scale_mv: f32,
    /// Directory with units/ and lines/
    #[arg(long, value_name = "DIR", env = "PTU_SCRIPTS")]
    scripts: Option<PathBuf>,
}

/// Error of the program: a [`UsageError`], or what a port, file or pipe says.
type Failure = Box<dyn Error>;

/// Serves until the process is ended.
pub fn serve(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(address) = &arguments.tcp {
        check_exposed(address, arguments.expose).map_err(UsageError)?;
        stdio::note(NO_AUTHENTICATION);
    }
    let setup = data::setup(arguments)?;
    let flash = arguments.flash.as_deref().map(data::flash).transpose()?;
    let mut wire = match (&arguments.serial, &arguments.tcp) {
        (Some(port), _) => Wire::open(port)?,
        (_, Some(address)) => Wire::open(&PortAddress::Tcp(address.clone()))?,
        _ if arguments.lock_step => Wire::open_lock_step()?,
        _ => Wire::open(&PortAddress::Pty)?,
    };
    stdio::place(&wire.name)?;
    stdio::note(&format!(
        "unit {} with configuration {} is up",
        setup.serial, setup.config.name
    ));
    let listen = |device: &String| Listener::start(device, arguments.full_scale_mv);
    let mut unit = OnHarness {
        listener: arguments.signals.as_ref().map(listen).transpose()?,
        deaf: None,
        unit: match flash {
            Some(flash) => Unit::with_flash(setup, flash),
            None => Unit::new(setup),
        },
        now: Instant::ZERO,
    };
    if arguments.lock_step {
        // In lock step each run of a seed is the same.
        return run_in_lock_step(unit, &mut wire);
    }
    let started = RandomState::new().hash_one(arguments.seed);
    unit.unit.draw_challenges(started);
    in_real_time(&mut unit, &mut wire, arguments.slower)?;
    unit.deaf.map_or(Ok(()), |why| Err(why.into()))
}

fn sound_device(text: &str) -> Result<String, String> {
    let device = text
        .strip_prefix("sound:")
        .filter(|device| !device.is_empty());
    device
        .map(str::to_owned)
        .ok_or_else(|| "it is sound:DEVICE".to_owned())
}

/// Levels to which a sound device can be calibrated, mV.
fn millivolts(text: &str) -> Result<f32, String> {
    let mv = text.parse().ok().filter(|mv| (1e-3..1e9).contains(mv));
    mv.ok_or_else(|| "it is from 0.001 to 1e9".to_owned())
}

/// The unit, served at its harness.
struct OnHarness {
    unit: Unit,
    listener: Option<Listener>,
    /// Error for which the unit hears nothing any more.
    deaf: Option<ServeError>,
    /// Time of the next scan since power-up.
    now: Instant,
}

impl Served for OnHarness {
    fn scan(&mut self, received: &[u8], to_send: &mut Vec<u8>) -> ControlFlow<()> {
        match self.listener.as_mut().map(Listener::scan) {
            Some(Ok(heard)) => self.unit.hear(&heard),
            Some(Err(why)) => {
                self.deaf = Some(why);
                return ControlFlow::Break(());
            }
            None => {}
        }
        self.unit.receive(received);
        self.unit.step(self.now, to_send);
        self.now += SCAN;
        ControlFlow::Continue(())
    }

    fn frames_accepted(&self) -> u64 {
        self.unit.frames_accepted(Port::Harness)
    }

    fn reset_connection(&mut self) {
        self.unit.reset_connection(Port::Harness);
    }
}

/// One scan of the unit for each scan of the tester, answered at once.
fn run_in_lock_step(mut unit: OnHarness, wire: &mut Wire) -> Result<(), Failure> {
    let mut received = Vec::with_capacity(1024);
    let mut to_send = Vec::with_capacity(1024);
    loop {
        received.clear();
        while !received.ends_with(&SCAN_END) {
            let mut read = [0u8; 4096];
            let count = wire.read(&mut read)?;
            received.extend_from_slice(&read[..count]);
        }
        to_send.clear();
        let _ = unit.scan(&received, &mut to_send);
        to_send.extend(SCAN_END);
        wire.write(&to_send)?;
    }
}
