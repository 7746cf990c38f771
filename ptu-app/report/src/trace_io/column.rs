//! Name of a signal in files, and form of its samples: the same in every format.

use fault_db::{Channel, ChannelKind};

/// A signal's name in files: its name with its unit behind it, in letters that any program takes, unless it ends with
/// the unit already.
pub fn column_name(channel: &Channel) -> String {
    let unit = match channel.unit.as_str() {
        "km/h" => "kmh".to_owned(),
        unit => unit
            .to_lowercase()
            .replace('/', "_")
            .replace('²', "2")
            .replace('³', "3")
            .replace('%', "percent"),
    };
    let name = &channel.name;
    match name.strip_suffix(&unit) {
        Some(before) if unit.is_empty() || before.ends_with('_') => name.clone(),
        _ => format!("{name}_{unit}"),
    }
}

/// The word for a sample of an enumeration; `None` for a sample without a word, which stays a number.
pub fn word(channel: &Channel, sample: f64) -> Option<&str> {
    let ChannelKind::Enum { labels } = &channel.kind else {
        return None;
    };
    let whole = Some(sample as i64).filter(|whole| *whole as f64 == sample)?;
    labels.get(&whole).map(String::as_str)
}

#[cfg(test)]
mod tests {
    use protocol::signal::Signal;

    use super::*;

    /// Goal: a file names each unit once, and in letters that need no quotation. Method: all signals there are.
    #[test]
    fn names_in_files_are_plain_and_end_with_one_unit() {
        let channel = |signal: &Signal| Channel {
            name: signal.definition().name.to_owned(),
            unit: signal.definition().unit.to_owned(),
            kind: ChannelKind::Bit,
        };
        let names: Vec<_> = Signal::ALL
            .iter()
            .map(|signal| column_name(&channel(signal)))
            .collect();
        for name in &names {
            let plain = |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit();
            assert!(name.chars().all(|l| plain(l) || l == '_'), "{name}");
        }
        for expected in [
            "carrier_hz",
            "level_mv",
            "train_accel_m_s2",
            "train_jerk_m_s3",
            "speed_kmh",
            "wheel_correction_percent",
            "traction_n",
            "mode",
        ] {
            assert!(names.iter().any(|name| name == expected), "{expected}");
        }
        let mut once = names.clone();
        once.sort();
        once.dedup();
        assert_eq!(once.len(), names.len(), "each is of one signal");
    }
}
