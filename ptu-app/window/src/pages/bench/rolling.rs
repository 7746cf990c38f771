//! The rolling plot's data: the latest rows of the chosen signals, in lanes.

use protocol::signal::{Kind, Signal};

use ptu_runs::bench_worker::LiveData;

/// Spans that can be chosen for the plot, s.
pub const SPANS_S: [u32; 4] = [10, 30, 60, 120];
/// Most signals in the plot; more could not be told apart.
pub const MOST: usize = 12;

/// Signals of a lane, as indices into the chosen signals.
#[derive(Debug, PartialEq, Eq)]
pub enum Lane {
    /// Quantities of one unit of measure, on one scale.
    Quantities(Vec<usize>),
    Choice(usize),
    /// A signal that is on or off.
    Bit(usize),
}

/// Lanes of the chosen signals: quantities of one unit of measure, such as limit and speed, share a lane.
pub fn lanes(signals: &[Signal]) -> Vec<Lane> {
    let mut lanes: Vec<Lane> = Vec::new();
    for (place, signal) in signals.iter().enumerate() {
        let definition = signal.definition();
        match definition.kind {
            Kind::Bit => lanes.push(Lane::Bit(place)),
            Kind::Enum(_) => lanes.push(Lane::Choice(place)),
            Kind::Number { .. } => {
                let shared = lanes.iter_mut().find_map(|lane| match lane {
                    Lane::Quantities(places) => {
                        let first = signals[places[0]].definition();
                        let same = !definition.unit.is_empty() && first.unit == definition.unit;
                        same.then_some(places)
                    }
                    _ => None,
                });
                match shared {
                    Some(places) => places.push(place),
                    None => lanes.push(Lane::Quantities(vec![place])),
                }
            }
        }
    }
    lanes
}

/// The chosen signals by their names; unknown names, which an older program may have saved, are ignored.
pub fn chosen(names: &[String]) -> Vec<Signal> {
    let known = names.iter().filter_map(|name| Signal::from_name(name));
    known.take(MOST).collect()
}

/// The latest rows, copied so that the bench is locked for a moment only. The buffers are used again in each frame.
#[derive(Debug, Default)]
pub struct Rows {
    times_s: Vec<f64>,
    values: Vec<Vec<f64>>,
}

impl Rows {
    /// Takes the rows of the last `span_s`; times are s before now, so at most 0.
    pub fn take(&mut self, live: &LiveData, signals: &[Signal], span_s: f64) {
        self.times_s.clear();
        self.values.resize_with(signals.len(), Vec::new);
        self.values.iter_mut().for_each(Vec::clear);
        let before_s = |at: protocol::Instant| -live.now.since(at).as_secs();
        // One row before the left edge is taken, too: its values hold until the next row.
        let rows = &live.rows.rows();
        let first = rows.partition_point(|row| before_s(row.at) < -span_s);
        for row in rows.range(first.saturating_sub(1)..) {
            self.times_s.push(before_s(row.at));
            for (signal, values) in signals.iter().zip(&mut self.values) {
                values.push(row.value(*signal));
            }
        }
        // The values of the last row hold until now.
        if self.times_s.last().is_some_and(|last| *last < 0.0) {
            self.times_s.push(0.0);
            for values in &mut self.values {
                let last = values.last().copied().unwrap_or(f64::NAN);
                values.push(last);
            }
        }
    }

    /// Time and value of a chosen signal.
    pub fn samples(&self, place: usize) -> impl Iterator<Item = (f64, f64)> + '_ {
        let values = self.values.get(place).map_or(&[][..], Vec::as_slice);
        self.times_s.iter().copied().zip(values.iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_of_one_unit_share_a_lane_and_counts_do_not() {
        let signals = chosen(
            &[
                "train_speed",
                "eb",
                "limit",
                "effort",
                "markers_of_old",
                "marker_count",
                "alarm",
            ]
            .map(str::to_owned),
        );
        assert_eq!(
            lanes(&signals),
            [
                Lane::Quantities(vec![0, 2]),
                Lane::Choice(1),
                Lane::Quantities(vec![3]),
                Lane::Quantities(vec![4]),
                Lane::Bit(5),
            ]
        );
    }

    #[test]
    fn no_rows_are_no_trouble() {
        let mut rows = Rows::default();
        rows.take(&LiveData::default(), &[Signal::Speed], 10.0);
        assert_eq!(rows.samples(0).count(), 0);
        assert_eq!(rows.samples(7).count(), 0);
    }
}
