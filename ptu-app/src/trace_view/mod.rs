//! Recorded signals as lanes of a plot, without anything of a window: what each column of pixels has to
//! show, in time that depends on the pixels and not on the rows behind them.
//!
//! * [`columns`]: quantities, least and greatest value per column of pixels;
//! * [`spans`]: choices and bits, as stretches of one value;
//! * [`ticks`]: round values along an axis.

pub mod columns;
pub mod spans;
pub mod ticks;

pub use columns::Column;
pub use spans::{Shown, Span};

/// What part of an axis is in view, in the axis' unit: s or m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Left edge.
    pub from: f64,
    /// Right edge, beyond the left one.
    pub to: f64,
}

impl Window {
    /// Its length.
    pub fn length(self) -> f64 {
        self.to - self.from
    }

    /// Where a value lies, 0 at the left edge and 1 at the right one.
    pub fn share(self, value: f64) -> f64 {
        (value - self.from) / self.length()
    }

    /// The value at a share of its length.
    pub fn at(self, share: f64) -> f64 {
        self.from + share * self.length()
    }
}
