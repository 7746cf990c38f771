//! Names that were probably meant.

use std::fmt;

/// The known name nearest to an unknown one; its text is ` (did you mean "x"?)`, in the alternate form ` ("x"?)`, or
/// nothing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Near(pub Option<String>);

impl fmt::Display for Near {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Some(name) if f.alternate() => write!(f, " (\"{name}\"?)"),
            Some(name) => write!(f, " (did you mean \"{name}\"?)"),
            None => Ok(()),
        }
    }
}

/// The known name nearest to `asked`, in capitals or not.
pub fn did_you_mean<'a>(asked: &str, known: impl IntoIterator<Item = &'a str>) -> Near {
    let asked = asked.to_lowercase();
    let near = known
        .into_iter()
        .map(|name| (strsim::jaro_winkler(&asked, &name.to_lowercase()), name))
        .filter(|(score, _)| *score > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0));
    Near(near.map(|(_, name)| name.to_owned()))
}

/// The serial number nearest to the one asked for. Serial numbers of a fleet are alike, and a number
/// with another digit belongs to another unit: a near one differs in capitals or signs, or by a slip
/// of one key.
pub fn did_you_mean_number<'a>(asked: &str, known: impl IntoIterator<Item = &'a str>) -> Near {
    let plain = |text: &str| -> String {
        let letters = text.chars().filter(|letter| letter.is_alphanumeric());
        letters.flat_map(char::to_lowercase).collect()
    };
    let asked = plain(asked);
    let near = known
        .into_iter()
        .map(|name| (slips(&asked, &plain(name)), name))
        .filter(|(slips, _)| *slips < 2)
        .min_by_key(|(slips, _)| *slips);
    Near(near.map(|(_, name)| name.to_owned()))
}

/// Number of keys pressed wrong; one digit in place of another is no slip.
fn slips(asked: &str, name: &str) -> usize {
    let both = || asked.chars().zip(name.chars());
    let other_digits = both().filter(|(a, b)| a != b && a.is_ascii_digit() && b.is_ascii_digit());
    let same_length = asked.chars().count() == name.chars().count();
    match other_digits.count() {
        1 if same_length => usize::MAX,
        _ => strsim::osa_distance(asked, name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_serial_number_is_suggested_only_if_it_is_similar() {
        let known = ["ATC-1001", "ATC-1002", "SG-0142"];
        for (asked, near) in [
            ("atc-1001", " (did you mean \"ATC-1001\"?)"),
            ("ATC 1002", " (did you mean \"ATC-1002\"?)"),
            ("SG-142", " (did you mean \"SG-0142\"?)"),
            ("SG-0412", " (did you mean \"SG-0142\"?)"),
            ("ATV-1001", " (did you mean \"ATC-1001\"?)"),
            ("ATC-1003", ""),
            ("BTC-1004", ""),
            ("99", ""),
            ("", ""),
        ] {
            assert_eq!(
                did_you_mean_number(asked, known).to_string(),
                near,
                "{asked}"
            );
        }
    }

    #[test]
    fn a_name_is_suggested_whatever_its_case() {
        let hint = did_you_mean("EB_RELY", ["tacho_a", "eb_relay"]);
        assert_eq!(hint.to_string(), " (did you mean \"eb_relay\"?)");
        assert_eq!(did_you_mean("xyz", ["eb_relay"]), Near(None));
    }
}
