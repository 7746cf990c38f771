//! Position in the section: distance run from the departure, corrected at markers.

use protocol::event::Event;
use protocol::line::{Line, Section};
use protocol::message::TwcWayside;
use protocol::{Instant, Speed};

use crate::kernel::EventLog;
use crate::signals::MarkerPulse;

/// How the train moves in this scan.
#[derive(Clone, Copy, Debug, Default)]
pub struct Movement {
    /// Distance run since the last scan, m, backward negative.
    pub moved_m: f64,
    /// Measured speed.
    pub speed: Speed,
    /// Standing still.
    pub standstill: bool,
}

/// Section, position and marker order.
#[derive(Debug)]
pub struct Locator {
    window_m: f64,
    section: Option<Section>,
    position_m: f64,
    expected: u8,
    corrected: bool,
    last_marker: u8,
    count: u8,
}

impl Locator {
    /// Believes markers within `window_m` of their place.
    pub fn new(window_m: f64) -> Self {
        Self {
            window_m,
            section: None,
            position_m: 0.0,
            expected: 1,
            corrected: false,
            last_marker: 0,
            count: 0,
        }
    }

    /// At a departure loop the section begins anew.
    pub fn locate(&mut self, data: &TwcWayside, line: &Line, standstill: bool) {
        let Some(section) = line.section(data.section) else {
            return;
        };
        let same = self
            .section
            .as_ref()
            .is_some_and(|s| s.section == section.section);
        let departing = data.loop_id == section.from_loop;
        let run = same && self.position_m > section.start_m + self.window_m;
        if standstill && (!same || (departing && run)) {
            self.section = Some(section.clone());
            self.position_m = section.start_m;
            self.expected = 1;
            self.corrected = false;
        }
    }

    /// One scan.
    pub fn step(
        &mut self,
        now: Instant,
        movement: Movement,
        pulse: Option<MarkerPulse>,
        log: &mut EventLog,
    ) {
        self.position_m += movement.moved_m;
        if let Some(pulse) = pulse {
            self.pass_marker(now, movement, pulse, log);
        }
    }

    fn pass_marker(
        &mut self,
        now: Instant,
        movement: Movement,
        pulse: MarkerPulse,
        log: &mut EventLog,
    ) {
        let marker = pulse.marker;
        self.last_marker = marker;
        self.count = self.count.wrapping_add(1);
        if marker < self.expected && marker != 1 {
            log.push(now, Event::MarkerOrder, i32::from(marker));
            return;
        }
        if marker > self.expected {
            log.push(now, Event::MarkerMissing, i32::from(self.expected));
        }
        self.expected = if marker == 4 { 1 } else { marker + 1 };
        self.correct(now, movement, pulse, log);
    }

    /// Takes the marker's place as the position. A pulse at standstill comes from a test marker:
    /// its order counts, its place cannot.
    fn correct(
        &mut self,
        now: Instant,
        movement: Movement,
        pulse: MarkerPulse,
        log: &mut EventLog,
    ) {
        let Some(section) = &self.section else { return };
        let Some(&place) = section
            .markers_m
            .get(usize::from(pulse.marker).wrapping_sub(1))
        else {
            return;
        };
        if movement.standstill {
            return;
        }
        let since_m = movement.speed.mps() * f64::from(pulse.age_us) / 1e6;
        let error = self.position_m - since_m - place;
        if libm::fabs(error) > self.window_m {
            log.push(
                now,
                Event::MarkerPosition,
                libm::round(error * 100.0) as i32,
            );
            return;
        }
        self.position_m = place + since_m;
        self.corrected |= pulse.marker == 4;
    }

    /// Stopped within `tolerance_m` of the stop point, the last marker having been seen.
    pub fn aligned(&self, tolerance_m: f64) -> bool {
        self.corrected
            && self
                .section
                .as_ref()
                .is_some_and(|s| libm::fabs(self.position_m - s.stop_m) <= tolerance_m)
    }

    /// Distance to the stop point, m.
    pub fn to_stop_m(&self) -> Option<f64> {
        self.section
            .as_ref()
            .map(|section| section.stop_m - self.position_m)
    }

    /// What is added to the way the wheels tell, as a share.
    pub fn wheel_correction(&self) -> f64 {
        0.0
    }

    /// Section the train is in.
    pub fn section(&self) -> Option<&Section> {
        self.section.as_ref()
    }

    /// Position, m.
    pub fn position_m(&self) -> f64 {
        self.position_m
    }

    /// Last marker detected, 0 = none.
    pub fn last_marker(&self) -> u8 {
        self.last_marker
    }

    /// Markers detected, wrapping.
    pub fn count(&self) -> u8 {
        self.count
    }
}
