//! Links of the ways through the structure.

use protocol::LruId;
use protocol::event::Event;
use protocol::signal::Signal;

/// Result of a link of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LinkOutput {
    Signal(Signal),
    /// An event that the unit logs.
    Event(Event),
}

impl LinkOutput {
    pub(super) fn signal(self) -> Option<Signal> {
        match self {
            Self::Signal(signal) => Some(signal),
            Self::Event(_) => None,
        }
    }
}

/// Parts, and what they make of the link before.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Link {
    pub made: LinkOutput,
    pub parts: Vec<LruId>,
}

/// A way from a sensor to what a step judges.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chain {
    /// The part, if all links need it, as the supply; none where the part is in a link.
    pub before: Option<LruId>,
    /// From the sensor to what is judged.
    pub links: Vec<Link>,
    /// The first link that the part fails; the links after this one fail because it does.
    pub failing: usize,
}

/// One step of a way: the parts that make a signal, and what they make it of.
#[derive(Clone, Debug)]
pub(super) struct WayStep {
    pub parts: Vec<LruId>,
    pub from: Vec<LinkOutput>,
}
