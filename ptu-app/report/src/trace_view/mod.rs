//! Recorded signals as lanes of a plot, without anything of a window: what each column of pixels has to
//! show, in time that depends on the pixels and not on the rows behind them.
//!
//! * [`Column`]: a quantity, least and greatest value per column of pixels; [`Span`]: a choice or bit, a stretch of one value;
//! * [`samples`]: columns and spans of a live plot, whose samples come one by one;
//! * [`TraceView`]: a trace with every signal summarised once ([`MinMaxIndex`], [`Runs`]);
//! * [`Axis`]: time or distance; [`VisibleRange`]: the part of it in view;
//! * [`statistics`], [`value`], [`csv`](mod@csv): statistics of a trace, its values as text, and its file;
//! * [`choose`]: the signals to show first;
//! * [`listing`]: which traces there are, and one read from the database with what happened in it;
//! * [`Overlay`]: another trace or the good twin behind a trace;
//! * [`TracePlot`]: all of this as one picture: lanes, view, cursors, the trace behind.

mod axis;
pub mod choose;
mod columns;
pub mod csv;
pub mod listing;
mod min_max_index;
mod overlay;
mod runs;
pub mod samples;
mod spans;
pub mod statistics;
mod trace_plot;
pub mod value;
mod view;
mod visible_range;

pub use axis::{Axis, Edges, Kind};
pub use columns::Column;
pub use min_max_index::MinMaxIndex;
pub use overlay::{FirstDifference, Overlay, OverlaySource, OverlayTrace};
pub use runs::Runs;
pub use spans::{Span, SpanKind};
pub use trace_plot::{Cursor, Lane, TracePlot, bare, toggled};
pub use view::{Summary, TraceView};
pub use visible_range::VisibleRange;

/// Part of an axis in view, in the axis' unit: s or m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Left edge.
    pub from: f64,
    /// Right edge, beyond the left one.
    pub to: f64,
}

impl Window {
    pub fn length(self) -> f64 {
        self.to - self.from
    }

    /// Where a value lies, 0 at the left edge and 1 at the right one.
    pub fn share(self, value: f64) -> f64 {
        (value - self.from) / self.length()
    }

    /// The value at a share of the window's length.
    pub fn at(self, share: f64) -> f64 {
        self.from + share * self.length()
    }
}

#[cfg(test)]
mod tests {
    use fault_db::{Channel, ChannelKind, TraceData};

    /// A trace of quantities with rows of 50 ms.
    pub fn trace(columns: &[(&str, &[f64])]) -> TraceData {
        let channel = |(name, _): &(&str, &[f64])| Channel {
            name: (*name).into(),
            unit: String::new(),
            kind: ChannelKind::Number { lsb: 0.001 },
        };
        TraceData {
            period_us: 50_000,
            channels: columns.iter().map(channel).collect(),
            columns: columns.iter().map(|(_, column)| column.to_vec()).collect(),
            ..TraceData::default()
        }
    }
}
