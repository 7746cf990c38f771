//! Parts of a unit's set-up: its configuration, track database and injected faults.

use alloc::string::String;
use alloc::vec::Vec;

use protocol::config::UnitConfig;
use protocol::injection::FaultMode;
use protocol::line::Line;

/// Everything a unit is built from at power-up.
#[derive(Clone, Debug)]
pub struct Setup {
    pub serial: String,
    pub config: UnitConfig,
    /// CRC-32 of the configuration file.
    pub config_crc: u32,
    /// Track database.
    pub line: Line,
    /// CRC-32 of the track database file.
    pub tdb_crc: u32,
    /// Seed of arm challenges and injected noise.
    pub seed: u64,
    /// Faults injected into the unit.
    pub faults: Vec<FaultMode>,
}
