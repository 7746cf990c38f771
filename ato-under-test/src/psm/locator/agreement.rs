//! Whether a marker that is believed agrees with the ways before it: doors are enabled only where it does.

use protocol::Instant;
use protocol::event::Event;

use super::super::marker_check::{MarkerDetection, PositionFix, place_m, window_m};
use super::{Locator, MARKERS};
use crate::kernel::{EventLog, hundredths, hundredths_of_percent};

impl Locator {
    /// Notes the way from the marker before; from the section's begin, which is known less well, only where the train
    /// stopped at the stop point before. Where the marker agrees with one that was not believed and not with the fix, both
    /// ways are noted: from the fix to the one between, and on from there.
    pub(super) fn note_way(&mut self, place_m: f64, end: &MarkerDetection) {
        let known = self.fix.marker != 0 || self.came_from.is_some();
        if !known || self.slid_m != 0.0 || self.rescaled {
            return;
        }
        let mut from = self.fix;
        if let Some((between, _)) = self.span_from(end, false).filter(|_| self.contradicted) {
            self.note_between(from, between);
            from = between;
        }
        let to = PositionFix {
            place_m,
            distance_m: end.distance_m,
            marker: end.marker,
        };
        self.note_between(from, to);
    }

    fn note_between(&mut self, from: PositionFix, to: PositionFix) {
        let off_m = match from.marker {
            0 => self.config.start_window_m,
            _ => 3.0 * core::f64::consts::SQRT_2 * self.config.scatter_m,
        };
        let wheel_m = to.distance_m - from.distance_m;
        self.ways.note(to.place_m - from.place_m, wheel_m, off_m);
    }

    /// Compares the ways of the section: wheels of any size measure each way wrong by the same share. Where the shares
    /// differ, markers are displaced: no doors, and nothing is learned of the wheels.
    pub(super) fn compare_ways(&mut self, now: Instant, log: &mut EventLog) {
        let holds = self.holds_markers && self.holds_ways;
        let Some(share) = self.ways.contradiction().filter(|_| holds) else {
            if self.ways.compared() {
                self.proved_farther = 0.0;
            }
            return;
        };
        self.contradicted = true;
        // Too high a speed is the safe error: the speed keeps what was proved of the wheels, the doors alone lose it.
        self.proved_farther = self.runs_farther();
        self.wheel = self.wheel.of_other_wheels(self.config.wheel_spread);
        log.push(now, Event::MarkersDisplaced, hundredths_of_percent(share));
    }

    /// Holds a marker that is believed against the way from the marker before. Both may be displaced, and then the stop
    /// point is elsewhere.
    pub(super) fn hold_against_the_way(
        &mut self,
        now: Instant,
        place_m: f64,
        detection: &MarkerDetection,
        log: &mut EventLog,
    ) {
        let wheels = self.wheels();
        let run_m = wheels.run_m(detection.distance_m - self.fix.distance_m);
        let by_fix_m = self.fix.place_m + run_m - place_m;
        let agrees = libm::fabs(by_fix_m) <= window_m(&self.fix, run_m, &wheels, &self.config);
        self.contradicted = self.holds_markers && !agrees && self.fix.marker != 0;
        self.by_way_m = 0.0;
        // The way on sliding wheels contradicts nothing.
        let start = self.span_from(detection, agrees);
        let rolled = |slid_m| self.holds_markers && detection.slid_m == slid_m;
        let Some((start, _)) = start.filter(|(_, slid_m)| rolled(*slid_m)) else {
            return;
        };
        let run_m = wheels.scale * (detection.distance_m - start.distance_m);
        let error_m = start.place_m + run_m - place_m;
        // 2σ: doors that stay closed cost less than doors that open elsewhere.
        let wrong_m = self.wheel.uncertainty() * libm::fabs(run_m);
        self.by_way_m = libm::copysign((libm::fabs(error_m) - wrong_m).max(0.0), error_m);
        if detection.marker == MARKERS && libm::fabs(self.by_way_m) > self.aligned_m {
            log.push(now, Event::MarkerPosition, hundredths(error_m));
        }
    }

    /// Sets whether markers are compared with the way before them, and, if not `tested`, all ways with each other.
    pub fn hold_markers(&mut self, holds: bool, tested: bool) {
        // Test markers are pulsed by a tester, whose requests take their time.
        self.holds_ways = !tested;
        self.holds_markers = holds;
    }

    /// Where a span that ends at a believed marker begins, and the distance slid from the fix until there, m: at the
    /// marker of the fix, or at the pending one, which waits for a second one to agree with.
    pub(super) fn span_from(
        &self,
        end: &MarkerDetection,
        at_fix: bool,
    ) -> Option<(PositionFix, f64)> {
        if at_fix {
            return (self.fix.marker != 0).then_some((self.fix, 0.0));
        }
        let first = self.pending.filter(|first| first.marker < end.marker)?;
        let start = PositionFix {
            place_m: place_m(self.section.as_ref()?, first.marker)?,
            distance_m: first.distance_m,
            marker: first.marker,
        };
        Some((start, first.slid_m))
    }
}
