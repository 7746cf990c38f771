//! Measured values and their limits as text and as the shares of a bar.

use crate::words::{Words, fill};

/// Share of a bar beyond each limit.
const BEYOND: f64 = 0.25;

/// A number in at most four significant digits.
pub fn short(value: f64) -> String {
    let text = match value.abs() {
        big if big >= 1000.0 => format!("{value:.0}"),
        middle if middle >= 100.0 => format!("{value:.1}"),
        middle if middle >= 1.0 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    };
    if !text.contains('.') {
        return text;
    }
    match text.trim_end_matches('0').trim_end_matches('.') {
        "-0" => "0".into(),
        text => text.to_owned(),
    }
}

/// Limits in words: `at most 472`; empty without any.
pub fn limits_text(words: &Words, low: Option<f64>, high: Option<f64>) -> String {
    let (low, high) = (low.map(short), high.map(short));
    match (&low, &high) {
        (Some(low), Some(high)) => fill(words.common.from_to, &[("low", low), ("high", high)]),
        (None, Some(high)) => fill(words.common.at_most, &[("n", high)]),
        (Some(low), None) => fill(words.common.at_least, &[("n", low)]),
        (None, None) => String::new(),
    }
}

/// Where value and limits lie on the bar, 0 to 1; none without a value or without any limit.
pub fn places(value: Option<f64>, low: Option<f64>, high: Option<f64>) -> Option<(f64, f64, f64)> {
    let value = value.filter(|value| value.is_finite())?;
    let (from, to) = match (low, high) {
        (Some(low), Some(high)) => (low, high),
        (None, None) => return None,
        (Some(limit), None) | (None, Some(limit)) => {
            // One-sided: from zero to beyond the greater of value and limit, so that the other end looks like no limit.
            let beyond = 1.0 + BEYOND;
            let start = (beyond * value.min(limit)).min(0.0);
            let span = (beyond * value.max(limit)).max(0.0) - start;
            let place = |x: f64| (x - start) / span.max(f64::MIN_POSITIVE);
            let at = place(limit);
            return Some(match low {
                Some(_) => (place(value), at, 1.0),
                None => (place(value), 0.0, at),
            });
        }
    };
    let long = 1.0 + 2.0 * BEYOND;
    let (start, span) = if to > from {
        (from - (to - from) * BEYOND, to - from)
    } else {
        // One value only is allowed: it stands in the middle.
        let span = from.abs().max(1.0);
        (from - span * long / 2.0, span)
    };
    let place = |x: f64| ((x - start) / (span * long)).clamp(0.0, 1.0);
    Some((place(value), place(from), place(to)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_inside_lies_in_the_band_and_one_outside_beyond_it() {
        let inside = places(Some(0.3), Some(0.2), Some(0.4)).expect("a bar");
        assert!(inside.1 < inside.0 && inside.0 < inside.2);
        let outside = places(Some(9.0), Some(0.2), Some(0.4)).expect("a bar");
        assert_eq!(outside.0, 1.0);
    }

    #[test]
    fn one_limit_is_enough_and_none_gives_no_bar() {
        let (value, from, to) = places(Some(640.0), None, Some(472.0)).expect("a bar");
        assert_eq!(from, 0.0, "no lower limit is drawn");
        assert!(to < value && value < 1.0, "nor is the value at the end");
        let (value, from, to) = places(Some(0.1), Some(0.4), None).expect("a bar");
        assert_eq!(to, 1.0, "no upper limit is drawn");
        assert!(value < from && 0.0 < value);
        let below_zero = places(Some(-3.0), None, Some(-1.0)).expect("a bar");
        assert!(0.0 < below_zero.0 && below_zero.0 < below_zero.2 && below_zero.2 < 1.0);
        assert_eq!(places(Some(1.0), None, None), None);
        assert_eq!(places(Some(f64::NAN), Some(0.0), None), None);
        assert_eq!(places(None, Some(0.0), None), None);
        assert!(
            places(Some(0.0), None, Some(0.0)).is_some(),
            "a limit of zero"
        );
    }

    #[test]
    fn a_single_allowed_value_is_in_the_middle_of_the_bar() {
        let places = |value| places(Some(value), Some(4.0), Some(4.0)).expect("a bar");
        assert_eq!(places(4.0), (0.5, 0.5, 0.5));
        assert!(places(3.0).0 < 0.5 && places(5.0).0 > 0.5);
    }

    #[test]
    fn numbers_are_short() {
        let all = [0.0, -0.0001, 0.3, 0.12345, 12.3456, 123.456, 12345.6];
        let texts: Vec<_> = all.map(short).into();
        assert_eq!(texts, ["0", "0", "0.3", "0.123", "12.35", "123.5", "12346"]);
    }
}
