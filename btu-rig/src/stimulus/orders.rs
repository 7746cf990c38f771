//! Orders of the wayside.

use protocol::line::Section;
use protocol::message::TrainOrder;
use serde::{Deserialize, Serialize};

use crate::stored::train_order;

/// Orders that the wayside sends beside station data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub struct OrderData {
    /// Section whose length is given; 0 = no section is given.
    pub section: u16,
    /// Length of the section, 0.1 m.
    pub length_dm: u32,
    /// Station at which the train's run ends; 0 = none.
    pub destination: u16,
    /// Order to the train beside running.
    #[serde(with = "train_order")]
    pub order: TrainOrder,
    /// Train number; 0 = the train's own number.
    pub train_number: u16,
}

impl OrderData {
    /// An order that tells a section and its length, `length_m`; without a section the order tells section 0.
    pub fn of_section(order: TrainOrder, section: Option<&Section>, length_m: f64) -> Self {
        Self {
            section: section.map_or(0, |section| section.section),
            length_dm: (length_m * 10.0).round() as u32,
            destination: 0,
            order,
            train_number: 0,
        }
    }
}
