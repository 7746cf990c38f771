//! Track database: the record of S0 §3.3 for each section of a line, as checked data.

mod file;
mod rules;

use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::config::{AT_MOST, SpeedCode, find_code};

pub use file::{LineError, checksum, file_schema};
pub use rules::Broken;

/// A gradient from a position on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gradient {
    /// Where it begins, m from the section's start.
    pub at_m: f64,
    /// Gradient, ‰, uphill positive.
    pub permille: f64,
}

/// A curve from a position on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// Where it begins, m from the section's start.
    pub at_m: f64,
    /// Radius, m; 0 = straight from here on.
    pub radius_m: f64,
    /// Limit in the curve, km/h, in addition to `limits` of the section.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit_kmh: Option<f64>,
}

/// A limit from a position on, for a line whose speed codes are not known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LimitFrom {
    /// Where it begins, m from the section's start.
    pub at_m: f64,
    /// Limit, km/h.
    pub kmh: f64,
}

/// A part of a section.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stretch {
    /// Where it begins, m from the section's start.
    pub from_m: f64,
    /// Where the part ends, m from the section's start.
    pub to_m: f64,
}

/// A speed code that the wayside sends from a position on. The unit's ATO slows down ahead of a lower code;
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
    /// TWC loop number of the departure station.
    pub from_loop: u16,
    /// Arrival station number.
    pub to_station: u16,
    /// TWC loop number of the arrival station.
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
    /// Limits in order, in place of `speed_codes`: for each limit the unit's fastest code within it is sent.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub limits: Vec<LimitFrom>,
    /// Tunnels in order; `None` = a tunnel all along.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tunnels: Option<Vec<Stretch>>,
    /// Where the contact line has no voltage, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub neutral_sections: Vec<Stretch>,
}

impl Section {
    /// Turns the limits by position and in curves into speed codes, and removes them.
    fn send_limits(&mut self) {
        let limits = core::mem::take(&mut self.limits);
        let Some(first) = limits.first() else {
            return;
        };
        let curves: Vec<_> = (self.curves.iter_mut())
            .map(|curve| (curve.at_m, curve.limit_kmh.take()))
            .collect();
        let curved = curves.iter().map(|(at_m, _)| *at_m);
        let mut places: Vec<f64> = limits.iter().map(|l| l.at_m).chain(curved).collect();
        places.sort_by(f64::total_cmp);
        for at_m in places {
            let limit = limits.iter().rev().find(|limit| limit.at_m <= at_m);
            let curve = curves.iter().rev().find(|curve| curve.0 <= at_m);
            let kmh = limit.unwrap_or(first).kmh;
            let kmh = curve
                .and_then(|curve| curve.1)
                .map_or(kmh, |limit| kmh.min(limit));
            let code = format!("{AT_MOST}{kmh}");
            if self.speed_codes.last().is_none_or(|last| last.code != code) {
                self.speed_codes.push(CodeFrom { at_m, code });
            }
        }
    }
}

/// The track database of a line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Line {
    /// Name, for instance `line8`.
    pub name: String,
    /// How far the TWC loop of a station reaches before and behind the place where the head of a train stands there, m;
    /// `None` = loops lie all along the line.
    #[serde(default)]
    pub loops_m: Option<[f64; 2]>,
    /// Sections in running order.
    pub sections: Vec<Section>,
}

impl Line {
    /// Gives the codes that were made from limits the names of the unit's code table.
    pub fn name_codes(&mut self, codes: &[SpeedCode]) {
        let all = self.sections.iter_mut().flat_map(|s| &mut s.speed_codes);
        for from in all.filter(|from| from.code.starts_with(AT_MOST)) {
            if let Some(place) = find_code(codes, &from.code) {
                from.code.clone_from(&codes[place].name);
            }
        }
    }

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

    /// The station after the arrival station of `section`; at the line's end the arrival station itself.
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
