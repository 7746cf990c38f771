//! Values of signals as text in the language of the window.

use protocol::signal::{Kind, Signal};

use super::live_copy::BenchSnapshot;
use ptu_report::words::{Bench, fill};

/// Text of an unknown value.
pub const UNKNOWN: &str = "—";

/// A signal's value: a word, or a number with its unit.
pub fn value(words: &Bench, signal: Signal, seen: &BenchSnapshot) -> String {
    match seen.value(signal) {
        Some(value) => known(words, signal, value),
        None => UNKNOWN.to_owned(),
    }
}

pub fn known(words: &Bench, signal: Signal, value: f64) -> String {
    let definition = signal.definition();
    match definition.kind {
        Kind::Bit if value == 0.0 => words.off.to_owned(),
        Kind::Bit => words.on.to_owned(),
        Kind::Enum(labels) => {
            let place = value as usize;
            let own = words.states(signal).get(place).copied();
            match own.or_else(|| labels.get(place).copied()) {
                Some(label) => label.to_owned(),
                None => format!("{value}"),
            }
        }
        Kind::Number { lsb } => {
            let decimals = if lsb >= 1.0 { 0 } else { 1 };
            let number = format!("{value:.decimals$} {}", definition.unit);
            number.trim_end().to_owned()
        }
    }
}

/// Names of the bits that are set; "none" if no bit is set.
pub fn bits(words: &Bench, signal: Signal, seen: &BenchSnapshot) -> String {
    let Some(bits) = seen.bits(signal) else {
        return UNKNOWN.to_owned();
    };
    if bits == 0 {
        return words.none.to_owned();
    }
    let names = words.bits(signal);
    let set = (0..u16::BITS as usize).filter(|place| bits & (1 << place) != 0);
    let set: Vec<String> = set
        .map(|place| match names.get(place) {
            Some(name) => (*name).to_owned(),
            None => format!("bit {place}"),
        })
        .collect();
    set.join(", ")
}

/// Text of the master controller's notch; the unit's input tells no half notches.
pub fn controller(seen: &BenchSnapshot) -> String {
    match seen.value(Signal::Controller) {
        None => UNKNOWN.to_owned(),
        Some(notch) if notch <= -8.0 => "EB".to_owned(),
        Some(notch) if notch < 0.0 => format!("B{}", -notch),
        Some(0.0) => "N".to_owned(),
        Some(notch) => format!("P{notch}"),
    }
}

/// Time since a unit's start, s with milliseconds.
pub fn since_start(words: &Bench, at_ms: u32) -> String {
    let time = format!("{:.3}", f64::from(at_ms) / 1000.0);
    fill(words.seconds, &[("time", &time)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use ptu_report::words::Language;

    fn seen(signal: Signal, value: f64) -> BenchSnapshot {
        let mut seen = BenchSnapshot::default();
        seen.sample.set(signal, value);
        seen
    }

    #[test]
    fn values_are_words_or_numbers_with_their_unit() {
        let words = &Language::English.words().bench;
        let korean = &Language::Korean.words().bench;
        let cases = [
            (Signal::Eb, 1.0, "applied", "체결"),
            (Signal::Doors, 0.0, "open", "열림"),
            (Signal::Armed, 0.0, "off", "꺼짐"),
            (Signal::Speed, 54.986, "55.0 km/h", "55.0 km/h"),
            (Signal::MarkerCount, 3.0, "3", "3"),
            (Signal::Mode, 4.0, "automatic run", "자동 주행"),
            (Signal::Mode, 77.0, "77", "77"),
        ];
        for (signal, number, english, korean_word) in cases {
            let seen = seen(signal, number);
            assert_eq!(value(words, signal, &seen), english);
            assert_eq!(value(korean, signal, &seen), korean_word);
        }
        assert_eq!(value(words, Signal::Eb, &BenchSnapshot::default()), UNKNOWN);
    }

    #[test]
    fn bits_are_named_and_one_without_a_name_is_given_by_its_number() {
        let words = &Language::English.words().bench;
        let signal = Signal::EbSources;
        assert_eq!(bits(words, signal, &BenchSnapshot::default()), UNKNOWN);
        assert_eq!(bits(words, signal, &seen(signal, 0.0)), "none");
        let set = f64::from(0b1000_0000_1001_u16);
        assert_eq!(
            bits(words, signal, &seen(signal, set)),
            "Controller, ATC, bit 11"
        );
    }

    #[test]
    fn the_lever_position_is_given_as_its_notch() {
        for (notch, name) in [(-8.0, "EB"), (-3.0, "B3"), (0.0, "N"), (4.0, "P4")] {
            assert_eq!(controller(&seen(Signal::Controller, notch)), name);
        }
    }
}
