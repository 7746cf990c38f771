//! The dial's scale and the bars' lengths.

/// Steps of the dial's numbers, km/h.
const STEP_KMH: f64 = 20.0;
/// Room above the highest limit, km/h: an overspeed must still be on the dial.
const ROOM_KMH: f64 = 15.0;

/// The dial's scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dial {
    /// Last number of the dial, km/h.
    pub full_kmh: f64,
}

impl Dial {
    /// A dial for a unit with this highest limit, km/h.
    pub fn up_to(highest_kmh: f64) -> Self {
        let steps = ((highest_kmh + ROOM_KMH) / STEP_KMH).ceil().max(1.0);
        Self {
            full_kmh: steps * STEP_KMH,
        }
    }

    /// Position of a speed on the dial: 0 at standstill, 1 at the last number and above.
    pub fn share(self, kmh: f64) -> f32 {
        (kmh / self.full_kmh).clamp(0.0, 1.0) as f32
    }

    /// Speeds at which the dial has a number, km/h.
    pub fn numbers(self) -> impl Iterator<Item = f64> {
        let count = (self.full_kmh / STEP_KMH).round() as u32;
        (0..=count).map(|place| f64::from(place) * STEP_KMH)
    }

    /// Speeds at which the dial has a stroke, km/h: at each number, and three between two numbers.
    pub fn strokes(self) -> impl Iterator<Item = f64> {
        let count = (self.full_kmh / STEP_KMH).round() as u32 * 4;
        (0..=count).map(|place| f64::from(place) * STEP_KMH / 4.0)
    }
}

/// Length of a bar from its middle, −1 to 1; ±1 at `full` and beyond.
pub fn from_middle(value: f64, full: f64) -> f32 {
    (value / full).clamp(-1.0, 1.0) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dial_ends_above_the_highest_limit_and_stops_at_its_end() {
        for (highest, full) in [(75.0, 100.0), (80.0, 100.0), (90.0, 120.0), (0.0, 20.0)] {
            assert_eq!(Dial::up_to(highest).full_kmh, full);
        }
        let dial = Dial::up_to(75.0);
        assert_eq!(dial.share(50.0), 0.5);
        assert_eq!((dial.share(-3.0), dial.share(180.0)), (0.0, 1.0));
        assert_eq!(dial.numbers().count(), 6);
        assert_eq!(dial.strokes().last(), Some(100.0));
    }

    #[test]
    fn a_bar_stays_within_its_frame() {
        assert_eq!(from_middle(-512.0, 1024.0), -0.5);
        assert_eq!(from_middle(9_999.0, 1024.0), 1.0);
    }
}
