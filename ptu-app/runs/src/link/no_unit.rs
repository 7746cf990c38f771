//! Why a unit on a port cannot be tested.

use btu_rig::rig::LinkTrouble;
use protocol::Duration;

use super::Endpoint;
use crate::failure::{Failure, Trouble};

/// Why a unit on a port cannot be tested, and the next move.
#[derive(Clone, Debug, thiserror::Error)]
pub enum NoUnit {
    /// A program holds this port: which.
    #[error("another program holds the port {0}: {1}; end it, or choose one of `ptu ports`")]
    PortHeld(String, String),
    /// This port does not open: why.
    #[error("cannot open port {0}: {1}; check the cable, or choose one of `ptu ports`")]
    PortClosed(String, String),
    /// Nobody listens at this address: why.
    #[error("cannot connect to {0}: {1}; check that the unit is served there")]
    NotServed(String, String),
    /// Another tester has the one there: which.
    #[error("{0}: {1}; wait until it has left, or end it there")]
    Taken(Endpoint, LinkTrouble),
    /// The port failed so.
    #[error("{0}; check the cable and that the unit is served there")]
    PortFailed(LinkTrouble),
    /// What comes from there is not what a unit sends.
    #[error("{0}: {1}")]
    BadLink(Endpoint, LinkTrouble),
    /// The one there answers, and its start did not end in this time.
    #[error("{0}: the unit answers but does not become ready within {1}; power it off and on")]
    NotReady(Endpoint, Duration),
    /// Its clock goes so many times as fast as the tester's.
    #[error(
        "{0}: the unit's clock goes {1:.1} times as fast as the tester's; slow both ends down alike, or neither"
    )]
    OtherPace(Endpoint, f64),
    /// There is one with this serial number, and another is expected.
    #[error("the unit on {0} is {1}, not {2}; check the port and the serial number asked for")]
    Other(Endpoint, String, String),
    /// Its configuration has this checksum, that of the tests another.
    #[error(
        "the unit configuration of unit {0} has checksum {1:08x}, the tests were loaded for {2:08x}; choose the unit \
         configuration of that unit"
    )]
    OtherConfiguration(String, u32, u32),
    /// So it is with its track database.
    #[error(
        "the track database of unit {0} has checksum {1:08x}, the tests were loaded for {2:08x}; choose the track \
         database of that unit"
    )]
    OtherTrack(String, u32, u32),
}

impl From<NoUnit> for Failure {
    fn from(why: NoUnit) -> Self {
        Self::bench(Trouble::NoUnit(why))
    }
}
