//! Ways between the markers of a section, held against each other.

use super::wheel::{CREEP, share};

/// Most ways of a section: its begin and four markers.
const MOST: usize = 4;

/// A way by the track database and by the wheels.
#[derive(Clone, Copy, Debug, Default)]
struct Way {
    /// Way by the track over way by the wheels, less 1.
    share: f64,
    /// Share of the way by which displaced ends may falsify it.
    off: f64,
}

/// The ways of a section so far.
#[derive(Clone, Debug, Default)]
pub struct Ways {
    noted: [Way; MOST],
    count: usize,
}

impl Ways {
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Notes a way of `track_m` that the wheels measured as `wheel_m`, whose ends may be off by `off_m` together.
    pub fn note(&mut self, track_m: f64, wheel_m: f64, off_m: f64) {
        let Some(share) = share(track_m, wheel_m).filter(|_| self.count < MOST) else {
            return;
        };
        self.noted[self.count] = Way {
            share,
            off: off_m / track_m + CREEP,
        };
        self.count += 1;
    }

    /// There are at least two ways to be held against each other.
    pub fn compared(&self) -> bool {
        self.count > 1
    }

    /// Difference of the shares of two ways that no wheel explains.
    pub fn contradiction(&self) -> Option<f64> {
        let ways = &self.noted[..self.count];
        let pairs = ways
            .iter()
            .enumerate()
            .flat_map(|(place, one)| ways[..place].iter().map(move |other| (one, other)));
        pairs
            .map(|(one, other)| (one.share - other.share, one.off + other.off))
            .find(|(share, off)| libm::fabs(*share) > *off)
            .map(|(share, _)| share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ways of section 61 from its begin on, measured `wheel` times as long, with PSM2 and PSM3 off by these metres.
    fn contradicts(wheel: f64, second_m: f64, third_m: f64) -> bool {
        let mut ways = Ways::default();
        ways.note(304.03, 304.03 * wheel, 5.0);
        ways.note(437.5, (437.5 + second_m) * wheel, 0.21);
        ways.note(87.5, (87.5 + third_m - second_m) * wheel, 0.21);
        ways.contradiction().is_some()
    }

    #[test]
    fn wheels_of_any_size_agree_and_displaced_markers_do_not() {
        for wheel in [0.9, 1.0, 1.1] {
            assert!(!contradicts(wheel, 0.0, 0.0));
            assert!(!contradicts(wheel, 0.1, 0.0));
            for by_m in [-30.0, -20.0, -3.0, 3.0, 20.0, 30.0] {
                assert!(contradicts(wheel, by_m, by_m), "{by_m} m alike");
                assert!(contradicts(wheel, 0.0, by_m), "PSM3 and PSM4 {by_m} m");
            }
        }
    }
}
