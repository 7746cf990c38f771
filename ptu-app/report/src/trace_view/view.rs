//! A trace prepared for drawing: the kind of each signal, and a summary of its samples computed once.

use std::ops::Range;

use btu_rig::procedure::describe::bit_names;
use fault_db::{Channel, ChannelKind, TraceData};
use protocol::signal::Signal;

use super::min_max_index::MinMaxIndex;
use super::runs::Runs;

/// A trace made ready to be drawn.
#[derive(Debug)]
pub struct TraceView {
    data: TraceData,
    summaries: Vec<Summary>,
}

/// Kind of a signal, with a summary of its samples.
#[derive(Debug)]
pub enum Summary {
    /// A number that is measured or counted.
    Quantity(MinMaxIndex),
    /// A word, or a set of bits with names.
    Choice(Runs),
    /// On or off.
    Bit(Runs),
    /// No sample is known.
    Unknown,
}

impl TraceView {
    pub fn data(&self) -> &TraceData {
        &self.data
    }

    /// Summarises all signals of a trace.
    pub fn new(data: TraceData) -> Self {
        let summaries = data
            .channels
            .iter()
            .zip(&data.columns)
            .map(|(channel, samples)| Summary::of(channel, samples))
            .collect();
        Self { data, summaries }
    }

    /// Place of the signal of this name; `None` when the trace has no such signal.
    pub fn place(&self, name: &str) -> Option<usize> {
        self.data.channels.iter().position(|c| c.name == name)
    }

    /// The signal at a place.
    pub fn channel(&self, place: usize) -> &Channel {
        &self.data.channels[place]
    }

    pub fn samples(&self, place: usize) -> &[f64] {
        &self.data.columns[place]
    }

    pub fn summary(&self, place: usize) -> &Summary {
        &self.summaries[place]
    }

    /// Row of the trigger; the first where there is none.
    pub fn trigger_row(&self) -> usize {
        self.data.trigger_row.unwrap_or(0) as usize
    }

    /// From the least to the greatest value of a quantity; `None` for anything else.
    pub fn extent(&self, place: usize) -> Option<(f64, f64)> {
        self.extent_of(place, 0..self.data.rows())
    }

    /// Extent of the signal at this place over some rows.
    pub fn extent_of(&self, place: usize, rows: Range<usize>) -> Option<(f64, f64)> {
        let Summary::Quantity(pyramid) = self.summary(place) else {
            return None;
        };
        let all = pyramid.range(self.samples(place), rows.start, rows.end);
        all.extent()
    }
}

impl Summary {
    fn of(channel: &Channel, samples: &[f64]) -> Self {
        if !samples.iter().any(|value| value.is_finite()) {
            return Self::Unknown;
        }
        match channel.kind {
            ChannelKind::Bit => Self::Bit(Runs::of(samples)),
            ChannelKind::Enum { .. } => Self::Choice(Runs::of(samples)),
            ChannelKind::Number { .. } if is_set(&channel.name) => Self::Choice(Runs::of(samples)),
            ChannelKind::Number { .. } => Self::Quantity(MinMaxIndex::of(samples)),
        }
    }
}

/// The signal is a set of bits that have names.
fn is_set(name: &str) -> bool {
    Signal::from_name(name).is_some_and(|signal| bit_names(signal, 0).is_some())
}

#[cfg(test)]
mod tests {
    use super::super::tests::trace;
    use super::*;

    #[test]
    fn the_kind_of_a_signal_follows_its_channel() {
        let mut data = trace(&[
            ("speed", &[1.0, 3.0]),
            ("lamps", &[0.0, 2.0]),
            ("eb", &[0.0, 1.0]),
            ("target", &[f64::NAN; 2]),
        ]);
        data.channels[2].kind = ChannelKind::Bit;
        let view = TraceView::new(data);
        assert!(matches!(view.summary(0), Summary::Quantity(_)));
        assert!(matches!(view.summary(1), Summary::Choice(_)));
        assert!(matches!(view.summary(2), Summary::Bit(_)));
        assert!(matches!(view.summary(3), Summary::Unknown));
        assert_eq!(view.extent(0), Some((1.0, 3.0)));
        assert_eq!(view.extent_of(0, 1..2), Some((3.0, 3.0)));
        assert_eq!(view.extent(2), None);
        assert_eq!((view.place("eb"), view.place("nothing")), (Some(2), None));
    }
}
