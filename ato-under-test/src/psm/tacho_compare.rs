//! Maintenance of the tachometers: two that differ by a share of the way, and one that counts another way between two
//! markers than the track has.
//!
//! A worn wheel and missing teeth change the way that a pulse stands for, always by the same share, and long before
//! the speeds differ by [`TachoConfig::difference_kmh`]. A wheel that spins or slides does so for a short time, and
//! begins with a change of speed that adhesion gives no train: what is counted around it is left out, and
//! of the rest two windows of the way must agree.
//!
//! The ratio says that one of two is wrong, the way between two markers says which.

use protocol::config::TachoConfig;
use protocol::event::Event;
use protocol::{Duration, Instant, Speed};

use crate::kernel::{EventLog, hundredths, hundredths_of_percent};
use crate::timer::Edge;

/// Speed of both wheels from which on they are compared [default].
const COMPARED_FROM: Speed = Speed::from_kmh(10.0);
/// Way over which the ratio is taken, m [default].
const WINDOW_M: f64 = 100.0;
/// Greatest difference between the shares of two windows that agree, share [default].
const SAME: f64 = 0.01;
/// Shortest way between two markers that tells a share, m [default].
const SHORTEST_M: f64 = 50.0;
/// Time after the last change of speed beyond adhesion until a wheel counts as rolling again [default].
const ROLLS_AGAIN: Duration = Duration::from_ms(1_000);
/// Markers of a section.
const MARKERS: usize = 4;

/// Motion of both wheels in one scan.
#[derive(Clone, Copy, Debug)]
pub struct WheelMotion {
    /// Way by each tachometer in this scan, m, backward negative.
    pub ways_m: [f64; 2],
    pub speeds: [Speed; 2],
    /// The greater of both wheels' changes of speed that adhesion does not explain, m/s²; `None` = both roll.
    pub loose_mps2: Option<f64>,
}

/// A way between two believed markers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkerSpan {
    /// Marker at its begin, 1 to 4.
    pub from: u8,
    /// Length of the span in the track database, m.
    pub track_m: f64,
}

/// Way by each tachometer, and the spins and slides until then.
#[derive(Clone, Copy, Debug, Default)]
struct Count {
    way_m: [f64; 2],
    loosened: u32,
}

/// Compares the tachometers; at first there is nothing to compare.
#[derive(Clone, Debug, Default)]
pub struct TachoCompare {
    total: Count,
    window: Option<Count>,
    last_share: Option<f64>,
    differs: bool,
    loose: Edge,
    loose_at: Option<Instant>,
    /// Where each marker was heard last.
    markers: [Option<Count>; MARKERS],
    named: [bool; 2],
}

impl TachoCompare {
    pub fn step(
        &mut self,
        now: Instant,
        motion: &WheelMotion,
        config: &TachoConfig,
        log: &mut EventLog,
    ) {
        for (way_m, moved_m) in self.total.way_m.iter_mut().zip(motion.ways_m) {
            *way_m += moved_m;
        }
        let fast = motion.speeds.iter().all(|speed| *speed >= COMPARED_FROM);
        if motion.loose_mps2.is_some() {
            self.loose_at = Some(now);
        }
        let loose = self.loose_at.is_some_and(|at| now.since(at) < ROLLS_AGAIN);
        if self.loose.rises(loose) {
            self.total.loosened = self.total.loosened.wrapping_add(1);
            if let Some(mps2) = motion.loose_mps2.filter(|_| fast) {
                log.push(now, Event::WheelSlip, hundredths(mps2));
            }
        }
        if loose || !fast {
            self.window = None;
            return;
        }
        let begin = *self.window.get_or_insert(self.total);
        let [one_m, two_m] = self.ways_since(&begin);
        if one_m.max(two_m) >= WINDOW_M && one_m.min(two_m) > 0.0 {
            self.window = None;
            self.judge_ratio(now, one_m / two_m - 1.0, config, log);
        }
    }

    fn judge_ratio(&mut self, now: Instant, share: f64, config: &TachoConfig, log: &mut EventLog) {
        let before = self.last_share.replace(share);
        if before.is_none_or(|before| libm::fabs(share - before) > SAME) {
            return;
        }
        let size = libm::fabs(share);
        if size > config.share && !self.differs {
            self.differs = true;
            log.push(now, Event::TachoRatio, hundredths_of_percent(share));
        }
        // Half of the limit, so that a share that stays near the limit is reported once.
        self.differs &= size > config.share / 2.0;
    }

    /// A marker has been heard; `span` is the way that it ends, if it was believed.
    pub fn pass_marker(
        &mut self,
        now: Instant,
        marker: u8,
        span: Option<MarkerSpan>,
        config: &TachoConfig,
        log: &mut EventLog,
    ) {
        let place = |marker: u8| usize::from(marker).checked_sub(1);
        let begin = span.and_then(|span| {
            let count = *self.markers.get(place(span.from)?)?;
            Some((span, count?))
        });
        if let Some((span, begin)) = begin
            && span.track_m >= SHORTEST_M
            && begin.loosened == self.total.loosened
        {
            self.judge_span(now, &begin, span.track_m, config, log);
        }
        let heard = place(marker).and_then(|place| self.markers.get_mut(place));
        if let Some(heard) = heard {
            *heard = Some(self.total);
        }
    }

    /// Reports a tachometer that tells another way than the track has and than its neighbour. Where both tell the same
    /// wrong way, the unit is set to a wrong diameter, which the calibration finds.
    fn judge_span(
        &mut self,
        now: Instant,
        begin: &Count,
        track_m: f64,
        config: &TachoConfig,
        log: &mut EventLog,
    ) {
        let shares = self.ways_since(begin).map(|way_m| way_m / track_m - 1.0);
        let worse = usize::from(libm::fabs(shares[1]) > libm::fabs(shares[0]));
        let apart = libm::fabs(shares[0] - shares[1]) > config.share;
        for (i, event) in [Event::TachoShare1, Event::TachoShare2]
            .into_iter()
            .enumerate()
        {
            let wrong = apart && i == worse && libm::fabs(shares[i]) > config.share;
            if wrong && !self.named[i] {
                log.push(now, event, hundredths_of_percent(shares[i]));
            }
            self.named[i] = wrong;
        }
    }

    fn ways_since(&self, begin: &Count) -> [f64; 2] {
        [0, 1].map(|i| libm::fabs(self.total.way_m[i] - begin.way_m[i]))
    }
}
