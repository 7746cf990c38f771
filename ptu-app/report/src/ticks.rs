//! Round values for the ticks of an axis.

/// Round values along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ticks {
    step: f64,
    first: i64,
    last: i64,
}

impl Ticks {
    /// Ticks of an axis from one value to another, about `about` ticks and never many more.
    pub fn of((low, high): (f64, f64), about: f64) -> Self {
        let step = round_step((high - low).max(f64::MIN_POSITIVE) / about.max(1.0));
        Self::with_step(step, (low, high))
    }

    /// The multiples of a step from one value to another.
    pub fn with_step(step: f64, (low, high): (f64, f64)) -> Self {
        Self {
            step,
            first: (low / step - 1e-9).ceil() as i64,
            last: (high / step + 1e-9).floor() as i64,
        }
    }

    pub fn values(self) -> impl Iterator<Item = f64> {
        (self.first..=self.last).map(move |i| i as f64 * self.step)
    }

    /// A value as it is written beside the axis.
    pub fn written(self, value: f64) -> String {
        let decimals = (-self.step.log10().floor()).max(0.0) as usize;
        format!("{value:.decimals$}").replace('-', "−")
    }
}

/// Range of an axis for an extent: with room above and below, and never of length 0.
pub fn range((low, high): (f64, f64)) -> (f64, f64) {
    const FREE: f64 = 0.06;
    if high - low <= 1e-9 * high.abs().max(1.0) {
        return (low - 0.5, high + 0.5);
    }
    let room = (high - low) * FREE;
    (low - room, high + room)
}

/// The smallest of 1, 2 and 5 times a power of ten that is not below `step`.
pub fn round_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    let mantissa = step / power;
    let round = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .find(|round| mantissa <= round + 1e-9);
    round.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(extent: (f64, f64), about: f64) -> String {
        let ticks = Ticks::of(extent, about);
        let all: Vec<_> = ticks.values().map(|value| ticks.written(value)).collect();
        all.join(" ")
    }

    #[test]
    fn ticks_are_round_and_as_many_as_fit() {
        assert_eq!(written((0.0, 63.0), 6.0), "0 20 40 60");
        assert_eq!(written((-0.7, 0.9), 3.0), "0");
        assert_eq!(written((-0.7, 0.9), 6.0), "−0.5 0.0 0.5");
        assert_eq!(written((0.0, 0.12), 3.0), "0.00 0.05 0.10");
    }

    #[test]
    fn a_constant_has_a_range_too() {
        assert_eq!(range((3.0, 3.0)), (2.5, 3.5));
        assert_eq!(range((0.0, 100.0)), (-6.0, 106.0));
        assert_eq!(written(range((3.0, 3.0)), 2.0), "2.5 3.0 3.5");
    }
}
