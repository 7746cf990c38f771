//! Where the stimuli of a bench go and its readings come from: frames, instruments one can buy, a person.
//!
//! [`Places`] is a bench file, [`Model`] the driver of an instrument: both are data. [`Placed`] stands between rig and
//! unit: it takes what has a place out of the rig's frames and puts what instruments read into those of the unit, so that
//! rig, scripts and verdicts know nothing of places. [`Places::fit`] says beforehand what the bench cannot do, and widens
//! what it cannot do in time.
//!
//! Terms: a *point* is one stimulus or one reading; an *act* is what a SCPI instrument does for a point.

mod by_sound;
mod error;
mod file;
mod fit;
mod instrument;
mod line;
mod modbus;
mod model;
mod needs;
mod placed;
mod points;
mod relay;
mod scpi;
mod teller;
#[cfg(test)]
mod tests;
mod widen;
mod worker;

pub use error::PlacesError;
pub use file::{Places, Written};
pub use instrument::InstrumentEntry;
pub use model::Model;
pub use placed::{Checked, Placed};
pub use points::{Place, Point, UnitInput};
pub use teller::Teller;
