//! Position in the section: distance run from the departure, corrected at markers.
//!
//! Markers correct the position ([`super::marker_check`]) and calibrate the wheel ([`super::wheel`]). An overdue marker
//! leaves the position unsure: from there on [`Locator::ahead_m`] grows, the distance by which the train may be further
//! than it seems. ATO stops by the most advanced position that can be believed, so that a train without markers, or
//! after a marker that came too early to be believed, stops short rather than beyond the platform. Doors are enabled
//! only where the last marker and the way from the marker before agree on the stop point.

mod agreement;
mod stop_place;

use protocol::Instant;
use protocol::config::{MarkerConfig, UnitConfig};
use protocol::event::Event;
use protocol::line::{Line, Section};
use protocol::message::TwcWayside;

use super::marker_check::{
    MarkerCheck, MarkerDetection, PendingDetection, PositionFix, Wheels, further_m, judge, place_m,
    window_m,
};
use super::ways::Ways;
use super::{MarkerSpan, Movement, Odometer, WheelCalibration};
use crate::kernel::{EventLog, hundredths, hundredths_of_percent};
use crate::signals::MarkerPulse;

/// Markers of a section.
const MARKERS: u8 = 4;
/// Greatest share of the distance run by which [`Locator::ahead_m`] grows, so that the stop point comes
/// nearer gently [default].
const AHEAD_SHARE: f64 = 0.5;
/// Time without a tachometer pulse after which the wheels stand, s: ATP's standstill is up to 0.3 m/s, at
/// which a train that is stopping still passes a marker.
const STANDS_S: f64 = 0.5;

/// Section, position and marker order.
#[derive(Clone, Debug)]
pub struct Locator {
    config: MarkerConfig,
    /// Tolerance of the stop point, m.
    aligned_m: f64,
    odometer: Odometer,
    pub wheel: WheelCalibration,
    pub section: Option<Section>,
    fix: PositionFix,
    /// Number the next pulse should have; pulses of test markers count, too.
    expected: u8,
    pending: Option<MarkerDetection>,
    /// Distance run on sliding wheels since the fix, m.
    slid_m: f64,
    /// Distance measured when the position became unsure, m.
    unsure_since_m: Option<f64>,
    /// Distance by which a marker that was not believed came early, m.
    early_m: f64,
    /// Position by the way from the marker before, minus the place of the last marker, m, reduced by what the wheels
    /// may be wrong on that way; 0 where they slid, or where no marker was before.
    by_way_m: f64,
    /// The last markers agree with each other and not with one that was believed before.
    contradicted: bool,
    /// The train has run under the unit's supervision: the section that follows the stop point is known.
    placed: bool,
    /// The section that ended where this one begins, if the train stopped there.
    came_from: Option<Section>,
    /// Ways between believed markers of this section.
    ways: Ways,
    /// Another wheel diameter was keyed in since the last believed marker: this way was measured with both diameters.
    rescaled: bool,
    holds_ways: bool,
    /// Markers are held against the way: nothing is wrong with that.
    holds_markers: bool,
    wheel_reported: bool,
    /// Share by which the wheels run farther than they tell: markers proved it before later markers contradicted them.
    proved_farther: f64,
    /// Way that the marker of this scan ends, if it was believed and the wheels rolled.
    pub span: Option<MarkerSpan>,
    /// Last marker detected, 0 = none.
    pub last_marker: u8,
    /// Markers detected, wrapping.
    pub count: u8,
}

impl Locator {
    /// A locator that knows nothing yet.
    pub fn new(config: &UnitConfig) -> Self {
        let marker = config.marker.clone();
        Self {
            odometer: Odometer::new(
                config.metres_per_pulse(),
                f64::from(config.tacho.window_ms) / 1000.0,
            ),
            wheel: WheelCalibration::new(
                marker.wheel_spread,
                marker.scatter_m,
                config.ato.watch.wheel_error,
            ),
            config: marker,
            aligned_m: config.doors.aligned_m,
            section: None,
            fix: PositionFix::default(),
            expected: 1,
            pending: None,
            slid_m: 0.0,
            unsure_since_m: None,
            early_m: 0.0,
            by_way_m: 0.0,
            contradicted: false,
            placed: false,
            came_from: None,
            ways: Ways::default(),
            rescaled: false,
            holds_ways: true,
            holds_markers: true,
            wheel_reported: false,
            proved_farther: 0.0,
            span: None,
            last_marker: 0,
            count: 0,
        }
    }

    /// Sets the way per pulse, m, of other wheels, whose calibration begins anew.
    pub fn set_pulse(&mut self, pulse_m: f64) {
        self.odometer.set_pulse(pulse_m);
        self.wheel = self.wheel.of_other_wheels(self.config.wheel_spread);
        self.wheel_reported = false;
        self.proved_farther = 0.0;
        self.ways.clear();
        self.rescaled = true;
    }

    /// Begins a new section at a departure loop; returns whether one began.
    pub fn locate(&mut self, data: &TwcWayside, line: &Line, standstill: bool) -> bool {
        let Some(section) = line.section(data.section) else {
            return false;
        };
        if standstill && self.contradicts(data, section, line) {
            return false;
        }
        let left = self.anchor().cloned();
        let same = self
            .section
            .as_ref()
            .is_some_and(|s| s.section == section.section);
        let departing = data.loop_id == section.from_loop;
        let run = same && self.position_m() > section.start_m + self.config.start_window_m;
        let begins = standstill && (!same || (departing && run));
        if begins {
            self.fix = PositionFix {
                place_m: section.start_m,
                distance_m: self.odometer.distance_m(),
                marker: 0,
            };
            self.section = Some(section.clone());
            self.came_from = left;
            self.ways.clear();
            self.expected = 1;
            self.pending = None;
            self.slid_m = 0.0;
            self.unsure_since_m = None;
            self.early_m = 0.0;
            self.by_way_m = 0.0;
            self.contradicted = false;
            self.wheel_reported = false;
        }
        begins
    }

    pub fn step(
        &mut self,
        now: Instant,
        movement: Movement,
        pulse: Option<MarkerPulse>,
        log: &mut EventLog,
    ) {
        self.odometer.step(&movement);
        self.span = None;
        if let Some(pulse) = pulse {
            self.last_marker = pulse.marker;
            self.count = self.count.wrapping_add(1);
            let stands = movement.edge_age_s > STANDS_S || !movement.driven;
            if movement.standstill && stands || self.section.is_none() {
                self.take_standing(now, pulse.marker, log);
            } else {
                let age_s = f64::from(pulse.age_us) / 1e6;
                let detection = MarkerDetection {
                    marker: pulse.marker,
                    distance_m: self.odometer.distance_ago_m(age_s),
                    slid_m: self.slid_m,
                };
                self.pass_marker(now, detection, log);
            }
        }
        if movement.driven && self.unsure_since_m.is_none() {
            self.look_for_overdue(now, log);
        }
    }

    /// A pulse at standstill comes from a test marker: its order counts, its place cannot.
    fn take_standing(&mut self, now: Instant, marker: u8, log: &mut EventLog) {
        if marker < self.expected && marker != 1 {
            log.push(now, Event::MarkerOrder, i32::from(marker));
            return;
        }
        if marker > self.expected {
            log.push(now, Event::MarkerMissing, i32::from(self.expected));
        }
        self.expected = marker % MARKERS + 1;
    }

    /// A marker pulse. One that is not believed is reported and changes nothing.
    fn pass_marker(&mut self, now: Instant, detection: MarkerDetection, log: &mut EventLog) {
        let Some(section) = &self.section else { return };
        let wheels = self.wheels();
        let pending = PendingDetection {
            detection: self.pending,
            unsure: self.unsure_since_m.is_some(),
        };
        let config = &self.config;
        match judge(section, &self.fix, detection, pending, &wheels, config) {
            MarkerCheck::Accepted => self.believe(now, detection, log),
            MarkerCheck::OutOfOrder => {
                log.push(now, Event::MarkerOrder, i32::from(detection.marker));
            }
            MarkerCheck::Away(error_m) => {
                log.push(now, Event::MarkerPosition, hundredths(error_m));
                let further_m = further_m(&self.fix, detection, error_m, &wheels, config);
                self.early_m = self.early_m.max(further_m);
                self.pending = Some(detection);
            }
        }
    }

    /// Takes the marker's place as the position.
    fn believe(&mut self, now: Instant, detection: MarkerDetection, log: &mut EventLog) {
        let marker = detection.marker;
        let place = self.section.as_ref().and_then(|s| place_m(s, marker));
        let Some(place_m) = place else { return };
        for missing in self.fix.marker + 1..marker {
            // A marker that was heard and not believed is not missing.
            if self.pending.is_none_or(|d| d.marker != missing) {
                log.push(now, Event::MarkerMissing, i32::from(missing));
            }
        }
        self.hold_against_the_way(now, place_m, &detection, log);
        self.note_way(place_m, &detection);
        // At the start of a section only the distance is known; a span on sliding wheels tells nothing of their
        // diameter.
        let start = self.span_from(&detection, self.fix.marker != 0);
        if let Some((start, _)) = start.filter(|_| self.slid_m == 0.0) {
            let track_m = place_m - start.place_m;
            self.span = Some(MarkerSpan {
                from: start.marker,
                track_m,
            });
            let wheel_m = detection.distance_m - start.distance_m;
            self.wheel.learn(track_m, wheel_m);
            self.report_wheel(now, log);
        }
        self.fix = PositionFix {
            place_m,
            distance_m: detection.distance_m,
            marker,
        };
        self.expected = marker % MARKERS + 1;
        self.pending = None;
        self.slid_m = 0.0;
        self.rescaled = false;
        self.unsure_since_m = None;
        self.early_m = 0.0;
        if marker == MARKERS {
            self.compare_ways(now, log);
        }
    }

    fn report_wheel(&mut self, now: Instant, log: &mut EventLog) {
        let Some(share) = self.wheel.impossible() else {
            return;
        };
        if !self.wheel_reported {
            self.wheel_reported = true;
            log.push(now, Event::WheelDiameter, hundredths_of_percent(share));
        }
    }

    /// A marker that is overdue: the train is past the end of its window.
    fn look_for_overdue(&mut self, now: Instant, log: &mut EventLog) {
        let next = self.fix.marker + 1;
        let Some(place_m) = self.section.as_ref().and_then(|s| place_m(s, next)) else {
            return;
        };
        let run_m = self.position_m() - self.fix.place_m;
        if self.position_m() > place_m + window_m(&self.fix, run_m, &self.wheels(), &self.config) {
            self.unsure_since_m = Some(self.odometer.distance_m());
            log.push(now, Event::PositionUnsure, i32::from(next));
        }
    }

    /// Stopped within tolerance of the stop point, by the last marker and by the way from the marker before.
    pub fn aligned(&self) -> bool {
        let within = |distance_m: f64| libm::fabs(distance_m) <= self.aligned_m;
        self.knows_stop_point()
            && self
                .to_stop_m()
                .is_some_and(|to_stop_m| within(to_stop_m) && within(to_stop_m - self.by_way_m))
    }

    /// The section's last marker was seen, and no way contradicts it.
    pub fn knows_stop_point(&self) -> bool {
        self.fix.marker == MARKERS && !self.contradicted
    }

    /// Distance to the stop point, m.
    pub fn to_stop_m(&self) -> Option<f64> {
        self.section
            .as_ref()
            .map(|section| section.stop_m - self.position_m())
    }

    /// Share by which markers prove that the wheels run farther than is measured; 0 within what wheels may differ by.
    pub fn runs_farther(&self) -> f64 {
        let proved = self.wheel.impossible().unwrap_or_default();
        proved.max(self.proved_farther)
    }

    /// Position, m.
    pub fn position_m(&self) -> f64 {
        let odometer_m = self.odometer.distance_m() - self.fix.distance_m;
        self.fix.place_m + self.wheels().run_m(odometer_m)
    }

    /// Adds a distance run on sliding wheels, which they did not count, m.
    pub fn slide(&mut self, distance_m: f64) {
        self.slid_m += distance_m;
    }

    fn wheels(&self) -> Wheels {
        Wheels {
            scale: 1.0 + self.wheel.correction(),
            // 4σ: a good marker that is not believed costs more than a displaced one that is.
            uncertainty: 2.0 * self.wheel.uncertainty(),
            slid_m: self.slid_m,
        }
    }

    /// Distance by which the train may be farther on, m; 0 as long as markers come when they
    /// should.
    pub fn ahead_m(&self) -> f64 {
        let unsure_m = self.unsure_since_m.map_or(0.0, |since_m| {
            let distance_m = self.odometer.distance_m();
            let run_m = libm::fabs(distance_m - self.fix.distance_m);
            let grown_m = libm::fabs(distance_m - since_m) * AHEAD_SHARE;
            (run_m * self.wheel.uncertainty()).min(grown_m)
        });
        unsure_m.max(self.early_m)
    }

    /// Goes on with the count of another instance.
    pub fn count_on_from(&mut self, other: &Self) {
        self.count = other.count;
    }
}

#[cfg(test)]
mod tests;
