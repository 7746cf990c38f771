//! `ptu train`: serves the embedded unit aboard a simulated train, by the clock. The train does all inputs and outputs
//! of the unit by itself; only the maintenance port leaves the process.
//!
//! * `cab`: what a person in the cab says, one order a line;
//! * `service`: sections driven before the port is opened, in virtual time.

mod cab;
mod keys;
mod service;
#[cfg(test)]
mod tests;

use std::hash::{BuildHasher as _, RandomState};
use std::ops::ControlFlow;
use std::path::PathBuf;

use ato_under_test::flash::FileFlash;
pub use ato_under_test::serve::{NO_AUTHENTICATION, PortAddress, check_exposed};
use ato_under_test::serve::{Served, Wire, in_real_time};
use btu_rig::rig::UnitLink;
use protocol::Instant;

use crate::aboard::UnitAboard;
use crate::data::ScriptsDirectory;
use crate::drive::SectionChoice;
use crate::failure::{Failure, RunTrouble};
use crate::run::{BenchChoice, BenchSetup};
use crate::stdio;
use crate::stop::Stop;
use crate::typed::Typed;

use cab::{Cab, Order};

#[derive(Clone, Debug)]
pub struct TrainRequest {
    /// Where the maintenance port is served.
    pub place: PortAddress,
    /// Unit, train, line and faults; its endpoint is the embedded unit.
    pub choice: BenchChoice,
    /// Section at whose departure station the train stands; none = in a depot.
    pub section: Option<u16>,
    /// Sections that are driven before, in this order.
    pub service: Vec<SectionChoice>,
    /// File in which the unit's memory lasts from start to start; none = it begins empty.
    pub flash: Option<PathBuf>,
}

/// Serves until the process is stopped or somebody in the cab quits.
///
/// # Errors
/// A name is wrong, or the port does not work.
pub fn serve(
    request: &TrainRequest,
    directory: &ScriptsDirectory,
    stop: &Stop,
) -> Result<(), Failure> {
    let setup = request.choice.setup(directory)?;
    let mut aboard = setup.aboard(setup.seed, Instant::ZERO);
    aboard.draw_challenges(RandomState::new().hash_one(setup.seed));
    if let Some(file) = &request.flash {
        let flash =
            FileFlash::open(file).map_err(|why| Failure::usage(RunTrouble::NotServed(why)))?;
        aboard.set_flash(Box::new(flash));
    }
    stdio::note(&format!(
        "unit {} with configuration {} is up aboard train {} of line {}",
        setup.expected_serial(),
        setup.config.name,
        setup.train.name(),
        setup.line.name
    ));
    let sections = service::sections(&request.service, &setup)?;
    service::drive(&sections, &mut aboard, &setup, stop)?;
    stdio::note(&stand(request.section, &mut aboard, &setup)?);
    if stop.presses() > 0 {
        return Ok(());
    }
    let mut wire = Wire::open(&request.place)
        .map_err(|error| Failure::bench(RunTrouble::NotServed(error.to_string())))?;
    let typed = Typed::listen();
    stdio::note(&cab::help());
    stdio::answer(&wire.name)?;
    let mut train = Train {
        aboard,
        cab: Cab::new(&setup.config.content),
        typed,
        stop: stop.clone(),
    };
    in_real_time(&mut train, &mut wire, setup.slower)
        .map_err(|error| Failure::bench(RunTrouble::NotServed(error.to_string())))
}

/// Leaves the train where it is to stand, and says how it stands.
fn stand(
    section: Option<u16>,
    aboard: &mut UnitAboard,
    setup: &BenchSetup,
) -> Result<String, Failure> {
    let place = match section {
        None => "in the depot, no code in the rail and no loop".to_owned(),
        Some(number) => {
            let line = &setup.line.content;
            SectionChoice::One(number).numbers(line)?;
            let section = line.section(number).expect("it was looked for");
            let stands = aboard.stand_at(section);
            stands.map_err(|refusal| Failure::usage(RunTrouble::NoStand(refusal.0.to_string())))?;
            format!("at the departure of section {number}, over its loop")
        }
    };
    Ok(format!(
        "the train stands {place}: cab on, mode manual, doors closed; the maintenance key is on"
    ))
}

/// The train on the wire.
struct Train {
    aboard: UnitAboard,
    cab: Cab,
    typed: Typed,
    stop: Stop,
}

impl Train {
    /// Carries out an order of the cab; false when the order is to quit.
    fn obey(&mut self, line: &str) -> bool {
        let order = match self.cab.order(line) {
            Ok(order) => order,
            Err(text) => {
                stdio::note(&text);
                return true;
            }
        };
        let done = match order {
            Order::Quit => return false,
            Order::Do(stimulus) => self.aboard.apply(&stimulus),
            Order::Push(speed) => self.aboard.push(speed),
            Order::Power(on) => {
                self.aboard.set_power(on);
                Ok(())
            }
        };
        stdio::note(&match done {
            Ok(()) => order.to_string(),
            Err(refusal) => format!("cannot: {}", refusal.0),
        });
        true
    }
}

impl Served for Train {
    fn scan(&mut self, received: &[u8], to_send: &mut Vec<u8>) -> ControlFlow<()> {
        for line in self.typed.lines() {
            if !self.obey(&line) {
                return ControlFlow::Break(());
            }
        }
        let now = self.aboard.now();
        let exchanged = self.aboard.exchange(now, received, to_send);
        if exchanged.is_err() || self.stop.presses() > 0 {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    fn frames_accepted(&self) -> u64 {
        self.aboard.frames_accepted()
    }

    fn reset_connection(&mut self) {
        self.aboard.reset_connection();
    }
}
