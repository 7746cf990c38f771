//! Record of a 50 ms cycle of a drive: every signal, and true values that no signal has.

use protocol::signal::Signal;

use crate::recorder;

#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Every signal.
    pub signals: recorder::Row,
    /// Time since the train began to move, s; while the run is under way, bench time.
    pub t_s: f64,
    /// True position of the train's head in the section, m.
    pub x_m: f64,
    /// True speed, km/h; forward positive.
    pub speed_kmh: f64,
    /// Power of traction at the wheels, mean of the cycle, W.
    pub power_w: f64,
    /// A car slips or slides.
    pub sliding: bool,
}

impl Row {
    /// A signal's value; not-a-number when it was not known.
    pub fn value(&self, signal: Signal) -> f64 {
        self.signals.value(signal)
    }
}
