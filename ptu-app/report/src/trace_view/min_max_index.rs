//! Minimum and maximum of any range of rows, in a time logarithmic in the length of the range.

use super::axis::Edges;
use super::columns::Column;

/// Rows, or stretches of the level below, that one stretch holds.
const FAN: usize = 4;

/// Extremes of stretches of 4, 16, 64 … rows, made once.
#[derive(Clone, Debug, Default)]
pub struct MinMaxIndex {
    levels: Vec<Vec<Column>>,
}

impl MinMaxIndex {
    /// Index of a column of samples; unknown samples (NaN) count for nothing.
    pub fn of(samples: &[f64]) -> Self {
        let mut levels: Vec<Vec<Column>> = Vec::new();
        let first = samples.chunks(FAN).map(|rows| {
            let mut all = Column::EMPTY;
            rows.iter().for_each(|value| all.add(*value));
            all
        });
        levels.push(first.collect());
        while let Some(below) = levels.last().filter(|below| below.len() > FAN) {
            let above = below.chunks(FAN).map(|stretches| {
                let mut all = Column::EMPTY;
                stretches.iter().for_each(|stretch| all.merge(*stretch));
                all
            });
            let above = above.collect();
            levels.push(above);
        }
        Self { levels }
    }

    /// Extremes of rows `from..to`.
    pub fn range(&self, samples: &[f64], from: usize, to: usize) -> Column {
        let mut all = Column::EMPTY;
        let (mut from, mut to) = (from, to.min(samples.len()));
        // At both ends the rows outside whole stretches, then on each level the stretches that do not fill a stretch
        // of the next level.
        while from < to && !from.is_multiple_of(FAN) {
            all.add(samples[from]);
            from += 1;
        }
        while from < to && !to.is_multiple_of(FAN) {
            to -= 1;
            all.add(samples[to]);
        }
        for level in &self.levels {
            (from, to) = (from / FAN, to / FAN);
            let last = level.len() <= FAN;
            while from < to && (last || !from.is_multiple_of(FAN)) {
                all.merge(level[from]);
                from += 1;
            }
            while from < to && !to.is_multiple_of(FAN) {
                to -= 1;
                all.merge(level[to]);
            }
        }
        all
    }

    /// Fills each column of pixels with the values of its rows, and with the value that still holds when the column
    /// begins.
    pub fn columns(&self, samples: &[f64], edges: &Edges, columns: &mut Vec<Column>) {
        columns.clear();
        columns.extend(edges.rows.windows(2).enumerate().map(|(place, rows)| {
            if place >= edges.end {
                return Column::EMPTY;
            }
            let mut all = self.range(samples, rows[0], rows[1]);
            if let Some(held) = rows[0].checked_sub(1).and_then(|row| samples.get(row)) {
                all.add(*held);
            }
            all
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(rows: usize) -> Vec<f64> {
        let value = |i: usize| match (i * 7919) % 101 {
            n if n % 17 == 3 => f64::NAN,
            n => n as f64,
        };
        (0..rows).map(value).collect()
    }

    #[test]
    fn any_stretch_has_the_extremes_of_its_rows() {
        for rows in [1, 3, 4, 5, 16, 17, 64, 65, 200, 257] {
            let samples = noise(rows);
            let pyramid = MinMaxIndex::of(&samples);
            for from in 0..rows {
                for to in from..=rows {
                    let found = pyramid.range(&samples, from, to);
                    let mut all = Column::EMPTY;
                    samples[from..to].iter().for_each(|value| all.add(*value));
                    let same = |a: f32, b: f32| a == b || (a.is_nan() && b.is_nan());
                    assert!(
                        same(found.low, all.low) && same(found.high, all.high),
                        "{rows} rows, {from}..{to}: {found:?}, not {all:?}"
                    );
                }
            }
        }
    }
}
