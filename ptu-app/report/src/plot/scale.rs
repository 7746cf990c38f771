//! Maps values to coordinates and chooses round values for ticks.

use crate::ticks::{Ticks, round_step};

/// Least number of ticks of an axis, about.
const MARKS: f64 = 6.0;

#[derive(Clone, Copy, Debug)]
pub struct Scale {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
    step: f64,
}

impl Scale {
    /// An axis over `extent`, drawn from one coordinate to another, with the share `free` of `extent` left free
    /// at each end, but not at an end at 0.
    pub fn new(extent: (f64, f64), (from, to): (f64, f64), free: f64) -> Self {
        let (mut low, mut high) = extent;
        // All values alike, or too near each other to be told apart.
        if high - low <= 1e-9 * high.abs().max(1.0) {
            (low, high) = (low - 0.5, high + 0.5);
        }
        let step = round_step((high - low) / MARKS);
        let room = (high - low) * free;
        // An end close to 0 becomes 0: a value hardly below 0 is rounding, or the last of a holding brake.
        low = if low.abs() < room { 0.0 } else { low - room };
        high = if high.abs() < room { 0.0 } else { high + room };
        Self {
            low,
            high,
            from,
            to,
            step,
        }
    }

    /// Coordinate of a value.
    pub fn at(&self, value: f64) -> f64 {
        self.from + (value - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Whether the axis reaches as far as this value.
    pub fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// The value, or the end of the axis it is beyond.
    pub fn clamp(&self, value: f64) -> f64 {
        value.clamp(self.low, self.high)
    }

    /// Values of the ticks, and how they are written.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        let ticks = Ticks::with_step(self.step, (self.low, self.high));
        let written = ticks.values().map(|value| (value, ticks.written(value)));
        written.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(extent: (f64, f64), free: f64) -> String {
        let scale = Scale::new(extent, (0.0, 100.0), free);
        let ticks: Vec<_> = scale.ticks().into_iter().map(|tick| tick.1).collect();
        ticks.join(" ")
    }

    #[test]
    fn marks_are_round_and_few() {
        assert_eq!(written((0.0, 63.0), 0.03), "0 20 40 60");
        assert_eq!(written((-0.001, 63.0), 0.03), "0 20 40 60");
        assert_eq!(written((-0.7, 0.9), 0.03), "−0.5 0.0 0.5");
        assert_eq!(written((-1024.0, 1023.0), 0.03), "−1000 −500 0 500 1000");
        assert_eq!(written((0.0, 850.03), 0.0), "0 200 400 600 800");
        assert_eq!(written((838.0, 851.0), 0.0), "840 845 850");
        assert_eq!(written((3.0, 3.0), 0.0), "2.6 2.8 3.0 3.2 3.4");
    }

    #[test]
    fn ends_of_an_axis_with_nothing_free_lie_at_its_coordinates() {
        let scale = Scale::new((-0.5, 74.7), (62.0, 986.0), 0.0);
        assert_eq!((scale.at(-0.5), scale.at(74.7)), (62.0, 986.0));
        assert!(scale.holds(74.7) && !scale.holds(74.8));
    }
}
