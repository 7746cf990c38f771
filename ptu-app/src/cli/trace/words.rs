//! Values of signals as people read them.

use btu_rig::procedure::describe::bit_names;
use fault_db::{Channel, ChannelKind};
use protocol::signal::Signal;

/// A value in its own words: label, lit bits, or number and unit.
pub fn named(channel: &Channel, value: f64) -> String {
    match &channel.kind {
        ChannelKind::Enum { labels } => labels
            .get(&(value as i64))
            .cloned()
            .unwrap_or_else(|| value.to_string()),
        ChannelKind::Bit => if value == 0.0 { "off" } else { "on" }.into(),
        ChannelKind::Number { .. } => {
            let bits =
                Signal::from_name(&channel.name).and_then(|signal| bit_names(signal, value as u16));
            if let Some(bits) = bits {
                return bits;
            }
            format!("{} {}", (value * 1000.0).round() / 1000.0, channel.unit)
                .trim_end()
                .to_owned()
        }
    }
}

/// The same, where it may not be known.
pub fn said(channel: &Channel, value: Option<f64>) -> String {
    value.map_or_else(|| "not known".into(), |value| named(channel, value))
}
