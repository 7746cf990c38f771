//! Consistency rules for the data of a line.

use alloc::format;
use alloc::string::String;
use core::ops::RangeInclusive;

use thiserror::Error;

use super::{Line, Section, Stretch};

/// Steepest gradient permitted, ‰: steeper than the track at any platform of an adhesion railway [default].
const STEEPEST_PERMILLE: f64 = 60.0;
/// Limits permitted, km/h [default].
const LIMITS_KMH: RangeInclusive<f64> = 5.0..=200.0;
/// Least radius of a curve permitted, m [default].
const TIGHTEST_M: f64 = 80.0;

/// A rule is broken.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{reason}")]
pub struct Broken {
    /// Where; `None` = the whole file.
    pub(super) place: Option<LineEntry>,
    pub(super) reason: String,
}

/// A place in a line file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LineEntry {
    /// Place of the section, from 0.
    pub section: usize,
    /// Key of the entry in the section.
    pub key: &'static str,
    /// Item of a list.
    pub item: Option<usize>,
}

pub(super) fn check(line: &Line) -> Result<(), Broken> {
    if line.sections.is_empty() {
        return Err(Broken {
            place: None,
            reason: "a line needs at least one section".into(),
        });
    }
    let reach = line.loops_m.unwrap_or_default();
    if !reach.iter().all(|m| (0.0..=1_000.0).contains(m)) {
        return Err(Broken {
            place: None,
            reason: format!("loops_m {reach:?}: a loop reaches 0 to 1000 m"),
        });
    }
    for (at, section) in line.sections.iter().enumerate() {
        let rules = Rules { at, section };
        rules.numbers()?;
        rules.lengths()?;
        rules.markers()?;
        rules.along()?;
        rules.fits(&line.sections[..at])?;
    }
    Ok(())
}

/// Rules for one section.
struct Rules<'a> {
    at: usize,
    section: &'a Section,
}

impl Rules<'_> {
    fn broken(&self, key: &'static str, item: Option<usize>, reason: &str) -> Result<(), Broken> {
        Err(Broken {
            place: Some(LineEntry {
                section: self.at,
                key,
                item,
            }),
            reason: format!("section {}: {reason}", self.section.section),
        })
    }

    fn numbers(&self) -> Result<(), Broken> {
        let s = self.section;
        if s.from_station == s.to_station {
            let reason = format!("to_station {} is from_station, too", s.to_station);
            return self.broken("to_station", None, &reason);
        }
        if s.from_loop == s.to_loop {
            let reason = format!("to_loop {} is from_loop, too", s.to_loop);
            return self.broken("to_loop", None, &reason);
        }
        if !["left", "right", "both"].contains(&s.door_side.as_str()) {
            let reason = format!("door_side \"{}\" must be left, right or both", s.door_side);
            return self.broken("door_side", None, &reason);
        }
        Ok(())
    }

    fn lengths(&self) -> Result<(), Broken> {
        let s = self.section;
        let ranges = [
            ("length_m", s.length_m, 50.0, 20_000.0),
            ("start_m", s.start_m, 0.0, 20_000.0),
            ("stop_m", s.stop_m, s.start_m + 1.0, s.start_m + s.length_m),
        ];
        for (key, value, low, high) in ranges {
            if !(low..=high).contains(&value) {
                let reason = format!("{key} = {value} is outside {low} .. {high}");
                return self.broken(key, None, &reason);
            }
        }
        Ok(())
    }

    fn markers(&self) -> Result<(), Broken> {
        let s = self.section;
        let mut last = (String::from("the start"), s.start_m);
        for (i, &at) in s.markers_m.iter().enumerate() {
            let psm = format!("PSM{}", i + 1);
            let misplaced = |place: &str, (other, other_m): (&str, f64)| {
                let reason = format!("{psm} at {at} m must lie {place} {other} at {other_m} m");
                self.broken("markers_m", Some(i), &reason)
            };
            if at <= last.1 || at.is_nan() {
                return misplaced("after", (&last.0, last.1));
            }
            if at >= s.stop_m {
                return misplaced("before", ("the stop point", s.stop_m));
            }
            last = (psm, at);
        }
        Ok(())
    }

    /// Gradients, curves and speed codes: in order, on the section, and possible.
    fn along(&self) -> Result<(), Broken> {
        let s = self.section;
        self.in_order("gradients", s.gradients.iter().map(|g| g.at_m))?;
        for (i, gradient) in s.gradients.iter().enumerate() {
            if !(-STEEPEST_PERMILLE..=STEEPEST_PERMILLE).contains(&gradient.permille) {
                let reason = format!(
                    "a gradient of {} ‰ is steeper than {STEEPEST_PERMILLE} ‰",
                    gradient.permille
                );
                return self.broken("gradients", Some(i), &reason);
            }
        }
        self.in_order("curves", s.curves.iter().map(|c| c.at_m))?;
        for (i, curve) in s.curves.iter().enumerate() {
            let straight = curve.radius_m == 0.0;
            if !straight && !(TIGHTEST_M..).contains(&curve.radius_m) {
                let reason = format!(
                    "a radius of {} m is tighter than {TIGHTEST_M} m; straight is 0",
                    curve.radius_m
                );
                return self.broken("curves", Some(i), &reason);
            }
        }
        self.in_order("speed_codes", s.speed_codes.iter().map(|c| c.at_m))?;
        self.limits()?;
        self.stretches("tunnels", s.tunnels.as_deref().unwrap_or_default())?;
        self.stretches("neutral_sections", &s.neutral_sections)
    }

    fn stretches(&self, key: &'static str, all: &[Stretch]) -> Result<(), Broken> {
        let ends = all
            .iter()
            .flat_map(|stretch| [stretch.from_m, stretch.to_m]);
        self.in_order(key, ends).map_err(|mut broken| {
            if let Some(place) = &mut broken.place {
                place.item = place.item.map(|end| end / 2);
            }
            broken
        })
    }

    fn limits(&self) -> Result<(), Broken> {
        let s = self.section;
        self.in_order("limits", s.limits.iter().map(|limit| limit.at_m))?;
        if !s.limits.is_empty() && !s.speed_codes.is_empty() {
            let reason = "limits beside speed_codes: give one of them";
            return self.broken("limits", None, reason);
        }
        let of_curves = s.curves.iter().map(|curve| curve.limit_kmh);
        if let (Some(i), true) = (
            of_curves.clone().position(|kmh| kmh.is_some()),
            s.limits.is_empty(),
        ) {
            let reason = "a limit in a curve needs limits of the section";
            return self.broken("curves", Some(i), reason);
        }
        let mut all = s
            .limits
            .iter()
            .map(|limit| limit.kmh)
            .chain(of_curves.flatten());
        match all.find(|kmh| !LIMITS_KMH.contains(kmh)) {
            Some(kmh) => self.broken(
                "limits",
                None,
                &format!("a limit of {kmh} km/h is outside {LIMITS_KMH:?}"),
            ),
            None => Ok(()),
        }
    }

    fn in_order(&self, key: &'static str, places: impl Iterator<Item = f64>) -> Result<(), Broken> {
        let s = self.section;
        let end_m = s.start_m + s.length_m;
        let mut last: Option<f64> = None;
        for (i, at) in places.enumerate() {
            if !(s.start_m..=end_m).contains(&at) {
                let reason = format!(
                    "{key}: at {at} m lies outside the section, {} .. {end_m} m",
                    s.start_m
                );
                return self.broken(key, Some(i), &reason);
            }
            if let Some(last) = last.filter(|&last| at <= last) {
                let reason = format!("{key}: at {at} m must lie after {last} m");
                return self.broken(key, Some(i), &reason);
            }
            last = Some(at);
        }
        Ok(())
    }

    /// Against the sections before: no number twice, and the next one begins where the last ends.
    fn fits(&self, before: &[Section]) -> Result<(), Broken> {
        let s = self.section;
        if before.iter().any(|b| b.section == s.section) {
            return self.twice();
        }
        let follows =
            |b: &&Section| b.route == s.route && b.section.checked_add(1) == Some(s.section);
        match before.last().filter(follows) {
            Some(last) if last.to_station != s.from_station => {
                let reason = format!(
                    "from_station {} must be to_station {} of section {}",
                    s.from_station, last.to_station, last.section
                );
                self.broken("from_station", None, &reason)
            }
            _ => Ok(()),
        }
    }

    fn twice(&self) -> Result<(), Broken> {
        Err(Broken {
            place: Some(LineEntry {
                section: self.at,
                key: "section",
                item: None,
            }),
            reason: format!("section {} is listed twice", self.section.section),
        })
    }
}
