//! Texts with placeholders.

use std::fmt::Display;

/// The wording with each `{name}` replaced.
pub fn fill(wording: &str, values: &[(&str, &dyn Display)]) -> String {
    let mut text = wording.to_owned();
    for (name, value) in values {
        text = text.replace(&format!("{{{name}}}"), &value.to_string());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_placeholder_is_filled_in() {
        let text = fill("{n} of {of}, {n}", &[("n", &2), ("of", &"three")]);
        assert_eq!(text, "2 of three, 2");
    }
}
