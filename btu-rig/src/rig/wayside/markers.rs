//! Marker coil: single pulses on request, and markers lying along a section.

use std::collections::VecDeque;

use protocol::SCAN;
use protocol::line::Section;

use crate::procedure::Refusal;

use crate::rig::train_side::{MAX_AGE_US, Motion};

/// Pulses that may wait: a frame tells one marker edge, so each scan makes one at most.
const MAX_PENDING: usize = 8;

/// The coil over which the markers pass.
#[derive(Debug)]
pub struct Markers {
    /// Markers along the way, by position on the rig's own scale.
    along_m: [Option<f64>; 4],
    /// Distance of each marker from its place.
    pub offsets_m: [f64; 4],
    /// Marker and age at the coming stamp, µs, and whether it was asked for instead of passed.
    pending: VecDeque<(u8, f64, bool)>,
    /// Marker entered last; 0 = none yet.
    pub last: u8,
    /// Markers entered so far, wrapping.
    pub edges: u8,
    age_us: f64,
    /// Marker that was asked for and pulses in this scan.
    pub asked: Option<u8>,
}

impl Default for Markers {
    fn default() -> Self {
        Self {
            along_m: [None; 4],
            offsets_m: [0.0; 4],
            pending: VecDeque::with_capacity(MAX_PENDING),
            last: 0,
            edges: 0,
            age_us: MAX_AGE_US,
            asked: None,
        }
    }
}

impl Markers {
    /// Pulses a marker once, at the next scan.
    ///
    /// # Errors
    /// When too many pulses are waiting.
    pub fn pulse(&mut self, psm: u8) -> Result<(), Refusal> {
        if self.pending.len() >= MAX_PENDING {
            return Err(Refusal(format!(
                "{MAX_PENDING} marker pulses are waiting already: a scan carries one at most"
            )));
        }
        self.pending.push_back((psm, -(SCAN.as_us() as f64), true));
        Ok(())
    }

    /// Lays a section's markers along the way; its start is at `position_m`.
    pub fn lay(&mut self, section: &Section, position_m: f64) {
        self.along_m = section
            .markers_m
            .map(|at| Some(position_m + at - section.start_m));
    }

    /// Moves one of the markers along the way by this number of metres, or takes it away.
    ///
    /// # Errors
    /// When it does not lie along the way.
    pub fn move_one(&mut self, psm: u8, by_m: Option<f64>) -> Result<(), Refusal> {
        let places = self.along_m.iter_mut();
        match places.zip(1..).find(|(_, number)| *number == psm) {
            Some((place @ Some(_), _)) => {
                *place = place.zip(by_m).map(|(at, by)| at + by);
                Ok(())
            }
            _ => Err(Refusal(format!("no PSM{psm} lies along the way"))),
        }
    }

    /// Takes the markers along the way away.
    pub fn lift(&mut self) {
        self.along_m = [None; 4];
    }

    /// Forgets pulses that still wait, and the markers along the way.
    pub fn clear(&mut self) {
        self.lift();
        self.pending.clear();
    }

    pub fn step(&mut self, motion: &Motion) {
        let scan_us = SCAN.as_us() as f64;
        self.age_us = (self.age_us + scan_us).min(MAX_AGE_US);
        for waiting in &mut self.pending {
            waiting.1 += scan_us;
        }
        for (psm, (at, offset)) in (1..).zip(self.along_m.into_iter().zip(self.offsets_m)) {
            let crossed = at.and_then(|at| motion.age_of_position_s(at + offset));
            // A full queue means four markers within centimetres: one coil cannot tell them apart.
            if let Some(age_s) = crossed.filter(|_| self.pending.len() < MAX_PENDING) {
                self.pending.push_back((psm, age_s * 1e6, false));
            }
        }
        self.asked = None;
        if let Some((psm, age_us, asked)) = self.pending.pop_front() {
            self.asked = asked.then_some(psm);
            self.last = psm;
            self.edges = self.edges.wrapping_add(1);
            self.age_us = age_us.min(MAX_AGE_US);
        }
    }

    /// Numbers and places of the markers along the way.
    pub fn along(&self) -> impl Iterator<Item = (u8, f64)> + '_ {
        let places = self.along_m.iter().zip(self.offsets_m);
        (1..)
            .zip(places)
            .filter_map(|(psm, (at, offset))| Some((psm, at.as_ref()? + offset)))
    }

    /// Age of the last edge, µs, at most 65535.
    pub fn age_us(&self) -> u16 {
        self.age_us.round() as u16
    }
}

#[cfg(test)]
mod tests {
    use protocol::Speed;
    use protocol::line::Line;

    use super::*;
    use crate::rig::train_side::Wheel;

    /// Each marker pulses once, and position minus distance since the edge is its place to 1 mm.
    #[test]
    fn markers_pulse_at_their_places() {
        let line = Line::from_toml(include_str!("../../../../scripts/lines/line8.toml")).unwrap();
        let (mut wheel, mut markers) = (Wheel::default(), Markers::default());
        let section = line.section(61).unwrap();
        markers.lay(section, 0.0);
        wheel.travel(850.03, Speed::from_kmh(60.0), 0.8).unwrap();
        let mut seen = Vec::new();
        while !wheel.settled() {
            let before = markers.edges;
            wheel.step();
            markers.step(&wheel.motion);
            if markers.edges != before {
                let since = f64::from(markers.age_us()) / 1e6 * wheel.speed().mps();
                seen.push((markers.last, wheel.motion.position_m - since));
            }
        }
        assert_eq!(seen.len(), 4);
        for ((psm, at), (expected, place)) in seen.into_iter().zip((1..).zip(section.markers_m)) {
            assert_eq!(psm, expected);
            assert!((at - place).abs() < 1e-3, "PSM{psm}: {at}");
        }
    }

    /// A marker that is moved pulses elsewhere, one that is missing not at all; when they are laid again all are back.
    #[test]
    fn a_marker_can_be_moved_and_missing() {
        let line = Line::from_toml(include_str!("../../../../scripts/lines/line8.toml")).unwrap();
        let section = line.section(61).unwrap();
        let mut markers = Markers::default();
        assert!(
            markers.move_one(2, None).is_err(),
            "nothing lies along the way"
        );
        markers.lay(section, 100.0);
        markers.move_one(1, Some(-4.0)).unwrap();
        markers.move_one(2, None).unwrap();
        assert!(markers.move_one(5, Some(1.0)).is_err());
        let places = [Some(400.03), None, Some(929.03), Some(946.53)];
        for (found, expected) in markers.along_m.into_iter().zip(places) {
            assert_eq!(found.map(f64::round), expected.map(f64::round));
        }
        markers.lay(section, 100.0);
        assert!(markers.along_m.iter().all(Option::is_some));
    }

    #[test]
    fn single_pulses_come_one_a_scan_and_are_bounded() {
        let (mut wheel, mut markers) = (Wheel::default(), Markers::default());
        for psm in [1, 3, 2, 4, 1, 1, 1, 1] {
            markers.pulse(psm).unwrap();
        }
        assert!(markers.pulse(1).is_err());
        wheel.step();
        markers.step(&wheel.motion);
        assert_eq!((markers.last, markers.edges, markers.age_us()), (1, 1, 0));
        markers.step(&wheel.motion);
        assert_eq!(
            (markers.last, markers.edges, markers.age_us()),
            (3, 2, 10_000)
        );
        markers.clear();
        for _ in 0..20 {
            markers.step(&wheel.motion);
        }
        assert_eq!((markers.edges, markers.age_us()), (2, u16::MAX));
    }
}
