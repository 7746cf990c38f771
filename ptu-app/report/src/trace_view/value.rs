//! Values of signals as text in a given language.

use btu_rig::procedure::describe::bit_names;
use fault_db::{Channel, ChannelKind};
use protocol::signal::Signal;

use crate::words::Words;

/// A value as text: label, names of the set bits, or number and unit.
pub fn named(channel: &Channel, value: f64, words: &Words) -> String {
    let traces = &words.traces;
    if value.is_nan() {
        return traces.not_known.to_owned();
    }
    let state = |label: &str| words.state(&channel.name, label).into_owned();
    match &channel.kind {
        ChannelKind::Enum { labels } => labels
            .get(&(value as i64))
            .map_or_else(|| value.to_string(), |label| state(label)),
        ChannelKind::Bit => if value == 0.0 { traces.off } else { traces.on }.to_owned(),
        ChannelKind::Number { .. } => {
            let bits =
                Signal::from_name(&channel.name).and_then(|signal| bit_names(signal, value as u16));
            let unit = words.unit(&channel.unit);
            bits.map_or_else(|| number(value, unit), |bits| state(&bits))
        }
    }
}

/// A number to three places, with its unit.
pub fn number(value: f64, unit: &str) -> String {
    format!("{} {unit}", (value * 1000.0).round() / 1000.0)
        .trim_end()
        .to_owned()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::words::Language;

    #[test]
    fn values_are_labels_bit_names_or_numbers_with_units() {
        let words = Language::English.words();
        let of = |name: &str, unit: &str, kind, value| {
            let channel = Channel {
                name: name.into(),
                unit: unit.into(),
                kind,
            };
            named(&channel, value, words)
        };
        let labels = BTreeMap::from([(1, "applied".to_owned())]);
        let number = ChannelKind::Number { lsb: 0.036 };
        assert_eq!(of("eb", "", ChannelKind::Enum { labels }, 1.0), "applied");
        assert_eq!(of("hcr", "", ChannelKind::Bit, 1.0), "on");
        assert_eq!(of("speed", "km/h", number.clone(), 40.0004), "40 km/h");
        assert_eq!(of("speed", "km/h", number.clone(), f64::NAN), "not known");
        assert_eq!(of("not_released", "", number, 5.0), "car 1 + car 3");
    }
}
