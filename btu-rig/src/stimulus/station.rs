//! Station data.

use protocol::line::Section;
use protocol::message::{DoorSide, RunningMode};
use serde::{Deserialize, Serialize};

use crate::stored::{door_side, running_mode};

/// Station data for the wayside or the TWC TEST module.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub struct StationData {
    pub route: u16,
    pub section: u16,
    pub station: u16,
    pub next_station: u16,
    pub loop_id: u16,
    /// Fixed speed, km/h; `None` = no order.
    pub fixed_speed_kmh: Option<u8>,
    #[serde(with = "running_mode")]
    pub running_mode: RunningMode,
    #[serde(with = "door_side")]
    pub door_side: DoorSide,
    pub departure: bool,
    /// Train number; 0 = the train's own number.
    pub train_number: u16,
}

impl StationData {
    /// Station data of a section's departure loop: no door side, departure held.
    pub fn at_departure(section: &Section) -> Self {
        Self {
            route: section.route,
            section: section.section,
            station: section.from_station,
            next_station: section.to_station,
            loop_id: section.from_loop,
            fixed_speed_kmh: None,
            running_mode: RunningMode::Normal,
            door_side: DoorSide::None,
            departure: false,
            train_number: 0,
        }
    }

    /// Station data of a section's arrival loop; `next_station` is the station after the arrival station.
    pub fn at_arrival(section: &Section, next_station: u16) -> Self {
        Self {
            station: section.to_station,
            next_station,
            loop_id: section.to_loop,
            door_side: DoorSide::from_label(&section.door_side).unwrap_or(DoorSide::None),
            ..Self::at_departure(section)
        }
    }
}
