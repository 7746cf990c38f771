//! Reduces a quantity to one interval per column of pixels, so that no extreme sample is lost.

/// Content of one column of pixels for a quantity: all its values from the least to the greatest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// Least value; NaN where nothing is known.
    pub low: f32,
    /// Greatest value; NaN where nothing is known.
    pub high: f32,
}

impl Column {
    pub const EMPTY: Self = Self {
        low: f32::NAN,
        high: f32::NAN,
    };

    /// Whether any value in the column of pixels is known.
    pub fn is_known(self) -> bool {
        !self.low.is_nan()
    }

    /// From the least to the greatest value; `None` where nothing is known.
    pub fn extent(self) -> Option<(f64, f64)> {
        self.is_known()
            .then(|| (f64::from(self.low), f64::from(self.high)))
    }

    /// Widens the interval to a value; a value that is not known, or not finite, changes nothing.
    pub fn add(&mut self, value: f64) {
        let value = value as f32;
        if value.is_finite() {
            // `min` and `max` pass over NaN.
            self.low = self.low.min(value);
            self.high = self.high.max(value);
        }
    }

    /// Widens the interval to all values of another column.
    pub fn merge(&mut self, other: Self) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
    }
}
