//! Statistics of a signal over a range of rows.

use std::ops::Range;

use super::view::{Summary, TraceView};

/// Statistics of a signal over a stretch of rows.
#[derive(Clone, Debug, PartialEq)]
pub enum Statistics {
    Quantity {
        /// Least value.
        low: f64,
        /// Greatest value.
        high: f64,
        /// Mean of the rows that are known.
        mean: f64,
        /// Root of the mean square of the differences between the rows and the mean.
        rms: f64,
    },
    /// Statistics of a choice or a bit.
    States {
        /// Changes from one known value to another.
        changes: usize,
        /// Values, each with its share of the known rows, 0 to 1; the greatest share first.
        shares: Vec<(f64, f64)>,
    },
    /// No row has a known value.
    Unknown,
}

/// Statistics of the signal at this place over these rows.
pub fn over(view: &TraceView, place: usize, rows: Range<usize>) -> Statistics {
    match view.summary(place) {
        Summary::Quantity(_) => quantity(view.samples(place).get(rows).unwrap_or_default()),
        Summary::Choice(runs) | Summary::Bit(runs) => {
            let held = runs.shares(rows.clone());
            let known: usize = held.iter().map(|(_, rows)| rows).sum();
            if known == 0 {
                return Statistics::Unknown;
            }
            let mut shares: Vec<_> = held
                .into_iter()
                .map(|(value, rows)| (value, rows as f64 / known as f64))
                .collect();
            shares.sort_by(|a, b| b.1.total_cmp(&a.1));
            Statistics::States {
                changes: runs.changes(rows),
                shares,
            }
        }
        Summary::Unknown => Statistics::Unknown,
    }
}

fn quantity(samples: &[f64]) -> Statistics {
    let known = || samples.iter().copied().filter(|value| !value.is_nan());
    let count = known().count();
    if count == 0 {
        return Statistics::Unknown;
    }
    let mean = known().sum::<f64>() / count as f64;
    let square = known().map(|value| (value - mean).powi(2)).sum::<f64>() / count as f64;
    Statistics::Quantity {
        low: known().fold(f64::INFINITY, f64::min),
        high: known().fold(f64::NEG_INFINITY, f64::max),
        mean,
        rms: square.sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use fault_db::ChannelKind;

    use super::super::tests::trace;
    use super::*;

    #[test]
    fn quantities_and_states_have_their_statistics() {
        let mut data = trace(&[
            ("speed", &[2.0, 4.0, f64::NAN, 6.0, 100.0]),
            ("eb", &[0.0, 1.0, 1.0, 1.0, 0.0]),
            ("target", &[f64::NAN, f64::NAN, f64::NAN, f64::NAN, 1.0]),
        ]);
        data.channels[1].kind = ChannelKind::Bit;
        let view = TraceView::new(data);
        let expected = Statistics::Quantity {
            low: 2.0,
            high: 6.0,
            mean: 4.0,
            rms: (8.0_f64 / 3.0).sqrt(),
        };
        assert_eq!(over(&view, 0, 0..4), expected);
        let expected = Statistics::States {
            changes: 1,
            shares: vec![(1.0, 0.75), (0.0, 0.25)],
        };
        assert_eq!(over(&view, 1, 0..4), expected);
        assert_eq!(over(&view, 2, 0..4), Statistics::Unknown);
        assert_eq!(over(&view, 0, 4..99), Statistics::Unknown);
    }
}
