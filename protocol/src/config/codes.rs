//! The code table: what each speed code means, and what lines and scripts call it.

use alloc::string::String;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

crate::labelled! {
    /// Use of a code.
    #[derive(
        Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema,
    )]
    #[serde(rename_all = "snake_case")]
    pub enum CodeMeaning: label {
        /// The limit holds under cab signal.
        #[default]
        Line = "line",
        /// The limit holds in yard mode; under cab signal the code permits nothing.
        Yard = "yard",
        /// Ends the limit of yard mode.
        YardCancel = "yard_cancel",
    }
}

/// One speed code of the code table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpeedCode {
    /// Name in scripts, for instance `55`.
    pub name: String,
    /// Limit it stands for, km/h; 0 = stop.
    pub limit_kmh: f64,
    /// Carrier, Hz.
    pub carrier_hz: f64,
    /// Modulation, Hz.
    pub rate_hz: f64,
    /// Use of the code.
    #[serde(default)]
    pub meaning: CodeMeaning,
    /// Names of codes of other tables for which this code is sent where a line or script uses them.
    #[serde(default)]
    pub stands_for: Vec<String>,
}

impl SpeedCode {
    /// Limit under cab signal, km/h; a yard code permits nothing there.
    pub fn line_kmh(&self) -> f64 {
        match self.meaning {
            CodeMeaning::Line => self.limit_kmh,
            CodeMeaning::Yard | CodeMeaning::YardCancel => 0.0,
        }
    }
}

/// Mark before a limit in km/h that stands in place of a code's name, as in `≤60`.
pub const AT_MOST: char = '≤';

/// Index of the code that is called `name` or stands for that name; for `≤60` of the fastest code within 60 km/h.
pub fn find_code(codes: &[SpeedCode], name: &str) -> Option<usize> {
    if let Some(most_kmh) = name.strip_prefix(AT_MOST) {
        let most_kmh = most_kmh.parse().ok()?;
        let slow = |code: &SpeedCode| code.line_kmh() > 0.0 && code.line_kmh() <= most_kmh;
        let slow = codes.iter().enumerate().filter(|(_, code)| slow(code));
        let fastest = slow.max_by(|a, b| a.1.line_kmh().total_cmp(&b.1.line_kmh()));
        return Some(fastest?.0);
    }
    let called = |code: &SpeedCode| code.name == name;
    let sent_for = |code: &SpeedCode| code.stands_for.iter().any(|other| other == name);
    (codes.iter().position(called)).or_else(|| codes.iter().position(sent_for))
}

#[cfg(test)]
mod tests {
    use super::super::{ConfigError, UnitConfig};
    use super::*;

    const SEOUL34: &str = include_str!("../../../scripts/units/seoul34.toml");

    #[test]
    fn a_code_is_found_by_its_name_and_by_those_that_it_stands_for() {
        let config = UnitConfig::from_toml(SEOUL34).expect("shipped");
        let limit = |name: &str| {
            let at = find_code(&config.codes, name)?;
            Some(config.codes[at].limit_kmh)
        };
        for (name, kmh) in [
            ("60", 60.0),
            ("65", 60.0),
            ("75", 70.0),
            ("45", 40.0),
            ("0", 0.0),
        ] {
            assert_eq!(limit(name), Some(kmh), "{name}");
        }
        assert_eq!(limit("61"), None);
    }

    #[test]
    fn a_limit_is_sent_as_the_fastest_code_within_it() {
        let config = UnitConfig::from_toml(SEOUL34).expect("shipped");
        let sent = |name: &str| Some(config.codes[find_code(&config.codes, name)?].name.as_str());
        assert_eq!(
            [sent("≤79"), sent("≤70"), sent("≤5"), sent("≤x")],
            [Some("70"), Some("70"), None, None]
        );
    }

    /// Goal: no table lets a train run faster than a line permits, or leaves it open which code is sent.
    #[test]
    fn what_a_code_may_not_stand_for_is_refused() {
        let config = UnitConfig::from_toml(SEOUL34).expect("shipped");
        let place = |name: &str| find_code(&config.codes, name).expect("a code");
        for (name, other, why) in [
            ("60", "45", "two codes stand for it"),
            ("60", "70", "the name of a code"),
            ("60", "50", "permits more than \"50\""),
        ] {
            let mut changed = config.clone();
            changed.codes[place(name)].stands_for.push(other.into());
            let Err(ConfigError::Conflict(said)) = changed.check() else {
                panic!("{name} for {other} is taken");
            };
            assert!(said.contains(why), "{said}");
        }
        let mut changed = config.clone();
        changed.codes[place("YC")].limit_kmh = 25.0;
        assert!(changed.check().is_err(), "a code that ends yard mode");
    }
}
