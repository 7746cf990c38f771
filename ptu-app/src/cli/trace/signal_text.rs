//! Values of signals as text.

use fault_db::Channel;

use ptu_report::trace_view::value;
use ptu_report::words::Words;

/// A value as text: its label, the names of its set bits, or number and unit of measure.
pub fn named(channel: &Channel, value: f64) -> String {
    value::named(channel, value, Words::shown())
}

/// A value as text, also a value that is not known.
pub fn said(channel: &Channel, value: Option<f64>) -> String {
    named(channel, value.unwrap_or(f64::NAN))
}
