//! The common axis of all lanes: time from the trigger, or distance from there.

use fault_db::TraceData;

use super::Window;

/// Signals with the position of the train, m: the true position counts before the one that the unit reports.
const POSITIONS: [&str; 2] = ["train_position", "position"];

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// Seconds.
    #[default]
    Time,
    /// Metres.
    Distance,
}

/// Rows of a trace along the axis, never backwards; 0 lies at the zero row, which is the trigger unless
/// the trace is shifted.
#[derive(Clone, Debug, PartialEq)]
pub enum Axis {
    /// Seconds.
    Time {
        /// Row that lies at 0; it may lie outside the trace.
        zero_row: i64,
        /// Time from row to row.
        period_us: i64,
        rows: usize,
    },
    /// Metres in the direction in which the train moved on the whole.
    Distance {
        /// For each row, the farthest point reached so far, m.
        at_m: Vec<f64>,
        /// Rows at which the train was behind the farthest point: they lie at that point.
        rows_back: usize,
        /// Greatest distance by which the train was behind, m.
        back_m: f64,
    },
}

/// The first row of each column of pixels.
#[derive(Clone, Debug, Default)]
pub struct Edges {
    /// First rows of the columns, and one entry more for the end of the last column.
    pub rows: Vec<usize>,
    /// First column after the end of the trace.
    pub end: usize,
}

impl Axis {
    pub fn time(trace: &TraceData, zero_row: i64) -> Self {
        Self::Time {
            zero_row,
            period_us: trace.period_us,
            rows: trace.rows(),
        }
    }

    /// Distance; `None` when no signal of the trace tells it.
    pub fn distance(trace: &TraceData, zero_row: i64) -> Option<Self> {
        let known = |name: &&str| {
            let column = trace.column(name)?;
            column.iter().any(|m| !m.is_nan()).then_some(column)
        };
        let column = POSITIONS.iter().find_map(known)?;
        let first = column.iter().copied().find(|m| !m.is_nan())?;
        let last = column.iter().copied().rfind(|m| !m.is_nan())?;
        let sign = if last < first { -1.0 } else { 1.0 };
        let (mut farthest, mut rows_back, mut back_m) = (first * sign, 0, 0.0_f64);
        let mut at_m: Vec<f64> = Vec::with_capacity(column.len());
        for m in column {
            // In a row without a known position the train counts as standing.
            if *m * sign > farthest {
                farthest = *m * sign;
            } else if *m * sign < farthest {
                rows_back += 1;
                back_m = back_m.max(farthest - *m * sign);
            }
            at_m.push(farthest);
        }
        let zero_row = usize::try_from(zero_row).unwrap_or(0);
        let zero = at_m[zero_row.min(at_m.len() - 1)];
        at_m.iter_mut().for_each(|m| *m -= zero);
        Some(Self::Distance {
            at_m,
            rows_back,
            back_m,
        })
    }

    /// An axis on which each row lies at its own place, or a sample of a live plot at its own time.
    pub fn places(at_m: Vec<f64>) -> Self {
        Self::Distance {
            at_m,
            rows_back: 0,
            back_m: 0.0,
        }
    }

    /// The axis of a trace that lies this many rows later; `None` when no signal of the trace tells a distance.
    pub fn of(kind: Kind, trace: &TraceData, later_rows: i64) -> Option<Self> {
        let trigger = i64::from(trace.trigger_row.unwrap_or(0));
        let zero_row = trigger.saturating_sub(later_rows);
        match kind {
            Kind::Time => Some(Self::time(trace, zero_row)),
            Kind::Distance => Self::distance(trace, zero_row),
        }
    }

    pub fn kind(&self) -> Kind {
        match self {
            Self::Time { .. } => Kind::Time,
            Self::Distance { .. } => Kind::Distance,
        }
    }

    pub fn rows(&self) -> usize {
        match self {
            Self::Time { rows, .. } => *rows,
            Self::Distance { at_m, .. } => at_m.len(),
        }
    }

    /// Place of a row on the axis; by distance, a row beyond the end lies at the end.
    pub fn at(&self, row: usize) -> f64 {
        match self {
            Self::Time {
                zero_row,
                period_us,
                ..
            } => ((row as i64 - zero_row) * period_us) as f64 / 1e6,
            Self::Distance { at_m, .. } => at_m.get(row).or(at_m.last()).copied().unwrap_or(0.0),
        }
    }

    /// The whole axis, with the time for which the last row holds.
    pub fn whole(&self) -> Window {
        let (from, to) = (self.at(0), self.at(self.rows()));
        // A train that stands still covers no distance: the axis gets a length of 1 m.
        let to = if to > from { to } else { from + 1.0 };
        Window { from, to }
    }

    /// The last row at or before a place; `None` before the first.
    pub fn row_at(&self, place: f64) -> Option<usize> {
        self.first_from(place + self.crumb()).checked_sub(1)
    }

    /// Rows in view, with the row that still holds when the view begins.
    pub fn rows_in(&self, window: Window) -> std::ops::Range<usize> {
        let first = self.row_at(window.from).unwrap_or(0);
        let last = self.row_at(window.to).map_or(0, |row| row + 1);
        first.min(last)..last
    }

    /// The first row at or beyond a place.
    fn first_from(&self, place: f64) -> usize {
        match self {
            Self::Time {
                zero_row,
                period_us,
                rows,
            } => {
                let row = (place * 1e6 / *period_us as f64 - 1e-6).ceil() as i64 + zero_row;
                row.clamp(0, *rows as i64) as usize
            }
            Self::Distance { at_m, .. } => at_m.partition_point(|m| *m < place),
        }
    }

    /// Places closer together than this count as one.
    fn crumb(&self) -> f64 {
        match self {
            Self::Time { period_us, .. } => *period_us as f64 * 1e-9,
            Self::Distance { .. } => 1e-6,
        }
    }

    /// Fills `edges` with the first row of each of this many columns.
    pub fn edges(&self, window: Window, columns: usize, edges: &mut Edges) {
        let place = |column: usize| window.at(column as f64 / columns.max(1) as f64);
        edges.rows.clear();
        edges
            .rows
            .extend((0..=columns).map(|column| self.first_from(place(column))));
        let end = self.whole().to;
        edges.end = (window.share(end) * columns as f64 - 1e-6)
            .ceil()
            .clamp(0.0, columns as f64) as usize;
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::trace;
    use super::*;

    #[test]
    fn time_counts_from_the_trigger_and_a_cursor_takes_the_row_before() {
        let axis = Axis::time(&trace(&[("speed", &[0.0; 10])]), 4);
        assert_eq!((axis.at(0), axis.at(4)), (-0.2, 0.0));
        assert_eq!(axis.row_at(0.049), Some(4));
        assert_eq!(axis.row_at(0.05), Some(5));
        assert_eq!(axis.row_at(-0.21), None);
        assert_eq!(axis.row_at(99.0), Some(9));
        assert_eq!(
            axis.whole(),
            Window {
                from: -0.2,
                to: 0.3
            }
        );
    }

    #[test]
    fn rows_of_a_train_that_rolls_back_are_at_the_farthest_point() {
        let way = [0.0, 1.0, 3.0, 2.0, 1.5, f64::NAN, 3.5, 5.0];
        let axis = Axis::distance(&trace(&[("train_position", &way)]), 1).expect("distance");
        let Axis::Distance {
            at_m,
            rows_back,
            back_m,
        } = &axis
        else {
            panic!("no distance");
        };
        assert_eq!(at_m[..], [-1.0, 0.0, 2.0, 2.0, 2.0, 2.0, 2.5, 4.0]);
        assert_eq!((*rows_back, *back_m), (2, 1.5));
        assert_eq!(axis.row_at(2.0), Some(5));
        assert_eq!(axis.row_at(1.9), Some(1));
    }

    #[test]
    fn a_train_that_runs_backwards_covers_a_distance_too() {
        let axis = Axis::distance(&trace(&[("position", &[5.0, 3.0, 0.0])]), 0);
        let axis = axis.expect("distance");
        assert_eq!([axis.at(0), axis.at(1), axis.at(2)], [0.0, 2.0, 5.0]);
        let unknown = trace(&[("train_position", &[f64::NAN; 3])]);
        assert_eq!(Axis::distance(&unknown, 0), None);
        assert_eq!(Axis::distance(&trace(&[("speed", &[1.0; 3])]), 0), None);
    }

    #[test]
    fn every_row_in_view_falls_into_one_column() {
        let axis = Axis::time(&trace(&[("speed", &[0.0; 100])]), 0);
        let mut edges = Edges::default();
        let window = Window {
            from: 0.0,
            to: 10.0,
        };
        axis.edges(window, 20, &mut edges);
        assert_eq!(edges.rows.len(), 21);
        assert_eq!((edges.rows[0], edges.rows[1], edges.rows[20]), (0, 10, 100));
        assert_eq!(edges.end, 10);
    }
}
