//! Track database: the record of S0 §3.3 for each section of a line, as checked data.

mod file;
mod rules;

use alloc::string::String;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

pub use file::{LineError, checksum, file_schema};
pub use rules::Broken;

/// A gradient from a position on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gradient {
    /// Where it begins, m from the section's start.
    pub at_m: f64,
    /// Its value, ‰, uphill positive.
    pub permille: f64,
}

/// A curve from a position on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// Where it begins, m from the section's start.
    pub at_m: f64,
    /// Its radius, m; 0 = straight from here on.
    pub radius_m: f64,
}

/// A speed code that the wayside sends from a position on. A unit's ATO slows for a lower one before its place;
/// the limit that its ATP supervises is read from the antenna alone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CodeFrom {
    /// Where it begins, m from the section's start.
    pub at_m: f64,
    /// Name of the code in the unit's code table.
    pub code: String,
}

/// One section, from a departure to an arrival station.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// Section number.
    pub section: u16,
    /// Route number.
    pub route: u16,
    /// Length, m.
    pub length_m: f64,
    /// Departure station number.
    pub from_station: u16,
    /// Its TWC loop number.
    pub from_loop: u16,
    /// Arrival station number.
    pub to_station: u16,
    /// Its TWC loop number.
    pub to_loop: u16,
    /// Start position, m.
    pub start_m: f64,
    /// Stop position, m.
    pub stop_m: f64,
    /// Positions of PSM1 to PSM4, m.
    pub markers_m: [f64; 4],
    /// Platform side at the arrival station: `left`, `right` or `both`.
    pub door_side: String,
    /// Gradients in order.
    #[serde(default)]
    pub gradients: Vec<Gradient>,
    /// Curves in order.
    #[serde(default)]
    pub curves: Vec<Curve>,
    /// Speed codes along the section, in order.
    #[serde(default)]
    pub speed_codes: Vec<CodeFrom>,
}

/// The track database of a line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Line {
    /// Name, for instance `line8`.
    pub name: String,
    /// How far the TWC loop of a station reaches before and behind the place where the head of a train stands there, m;
    /// `None` = loops lie all along the line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loops_m: Option<[f64; 2]>,
    /// Sections in running order.
    pub sections: Vec<Section>,
}

impl Line {
    /// Reads and checks a line file.
    ///
    /// # Errors
    /// The first thing wrong, with its line in the file.
    pub fn from_toml(text: &str) -> Result<Self, LineError> {
        file::read(text)
    }

    /// Checks the data, wherever they come from.
    ///
    /// # Errors
    /// The first rule broken.
    pub fn check(&self) -> Result<(), Broken> {
        rules::check(self)
    }

    /// Whether no loop lies at a position of a section, m from its start: nothing is heard there.
    pub fn between_loops(&self, section: &Section, position_m: f64) -> bool {
        self.loops_m.is_some_and(|[before_m, behind_m]| {
            position_m > section.start_m + behind_m && position_m < section.stop_m - before_m
        })
    }

    /// The section numbered `number`.
    pub fn section(&self, number: u16) -> Option<&Section> {
        self.sections.iter().find(|s| s.section == number)
    }

    /// The section that begins at the arrival station of `section`; `None` at the line's end.
    pub fn after(&self, section: &Section) -> Option<&Section> {
        let mut sections = self.sections.iter();
        sections.find(|after| after.from_station == section.to_station)
    }

    /// The station after the arrival station of `section`; that one itself at the line's end.
    pub fn station_after(&self, section: &Section) -> u16 {
        let after = self.after(section);
        after.map_or(section.to_station, |after| after.to_station)
    }

    /// The section that ends at the departure station of `section`; `None` at the line's begin.
    pub fn before(&self, section: &Section) -> Option<&Section> {
        let mut sections = self.sections.iter();
        sections.find(|before| before.to_station == section.from_station)
    }
}
