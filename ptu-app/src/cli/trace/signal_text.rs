//! Values of signals as text.

use fault_db::Channel;

use ptu_report::trace_view::value;
use ptu_report::words::Words;

/// A value as text: label, names of the set bits, or number and unit.
pub fn named(channel: &Channel, value: f64) -> String {
    value::named(channel, value, Words::shown())
}

/// Name of a value that may be unknown.
pub fn said(channel: &Channel, value: Option<f64>) -> String {
    named(channel, value.unwrap_or(f64::NAN))
}
