//! Reduces a quantity to one interval per column of pixels, so that no extreme sample is lost.

use super::Window;

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

    /// Something is known.
    pub fn is_known(self) -> bool {
        !self.low.is_nan()
    }

    /// Takes a value in; one that is not known, or beyond all measure, changes nothing.
    pub fn add(&mut self, value: f64) {
        let value = value as f32;
        if value.is_finite() {
            // `min` and `max` prefer what is a number.
            self.low = self.low.min(value);
            self.high = self.high.max(value);
        }
    }

    /// Takes all values of another in.
    pub fn merge(&mut self, other: Self) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
    }
}

/// Columns of samples in order of time, each of which holds until the next: for plots of a few thousand
/// rows that move. `columns` is filled again, as many as are asked for.
pub fn of_samples(
    samples: impl Iterator<Item = (f64, f64)>,
    window: Window,
    pixels: usize,
    columns: &mut Vec<Column>,
) {
    columns.clear();
    columns.resize(pixels, Column::EMPTY);
    let pixel = |x: f64| window.share(x) * pixels as f64;
    let mut held: Option<(f64, f64)> = None;
    let mut fill = |(from, value): (f64, f64), to: f64| {
        let (from, to) = (pixel(from).max(0.0), pixel(to));
        if to >= 0.0 && from < pixels as f64 {
            let last = (to as usize).min(pixels - 1);
            columns[from as usize..=last]
                .iter_mut()
                .for_each(|column| column.add(value));
        }
    };
    for sample in samples {
        if let Some(before) = held.replace(sample) {
            fill(before, sample.0);
        }
    }
    if let Some(last) = held {
        fill(last, last.0);
    }
}

/// From the least to the greatest value of all columns; `None` where nothing is known.
pub fn extent(columns: &[Column]) -> Option<(f64, f64)> {
    let mut all = Column::EMPTY;
    columns.iter().for_each(|column| all.merge(*column));
    all.is_known()
        .then(|| (f64::from(all.low), f64::from(all.high)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lows_and_highs(samples: &[(f64, f64)], window: Window) -> Vec<(f32, f32)> {
        let mut columns = Vec::new();
        of_samples(samples.iter().copied(), window, 4, &mut columns);
        columns.iter().map(|c| (c.low, c.high)).collect()
    }

    const WINDOW: Window = Window { from: 0.0, to: 4.0 };

    #[test]
    fn a_value_holds_until_the_next_and_a_short_peak_is_not_lost() {
        let samples = [(0.0, 1.0), (2.1, 9.0), (2.2, 2.0), (3.5, 2.0)];
        let found = lows_and_highs(&samples, WINDOW);
        assert_eq!(found, [(1.0, 1.0), (1.0, 1.0), (1.0, 9.0), (2.0, 2.0)]);
    }

    #[test]
    fn unknown_values_are_empty_cells() {
        let samples = [
            (0.0, 1.0),
            (1.0, f64::NAN),
            (2.0, f64::MAX),
            (3.0, 2.0),
            (9.0, 2.0),
        ];
        let found = lows_and_highs(&samples, WINDOW);
        assert!(found[2].0.is_nan() && found[2].1.is_nan());
        assert_eq!((found[0], found[3]), ((1.0, 1.0), (2.0, 2.0)));
    }

    #[test]
    fn samples_outside_and_none_at_all_are_no_trouble() {
        assert!(lows_and_highs(&[], WINDOW)[0].0.is_nan());
        let beside = [(-9.0, 1.0), (-3.0, 2.0)];
        assert!(lows_and_highs(&beside, WINDOW).iter().all(|c| c.0.is_nan()));
        let across = [(-9.0, 1.0), (9.0, 2.0)];
        assert_eq!(lows_and_highs(&across, WINDOW), [(1.0, 1.0); 4]);
    }
}
