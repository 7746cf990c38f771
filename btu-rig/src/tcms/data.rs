//! Data of a train's TCMS, the `[tcms]` table of its file.

use protocol::check_ranges;
use protocol::config::{ConfigError, within};
use serde::{Deserialize, Serialize};

/// Longest time that may be set, s.
const LONGEST_S: f64 = 60.0;

/// Data of the train control and monitoring system.
#[derive(Clone, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub struct TcmsData {
    /// Powering of P0.5, P1 .. P4, % of full effort (S3).
    pub power_notches: [f64; 5],
    /// Braking of B1 .. B7, % of full service (S3).
    pub brake_notches: [f64; 7],
    /// Break points a < b < c < d of the master controller's voltage, V (S4).
    pub controller_v: [f64; 4],
    /// Age at which orders of ATO no longer count, s.
    pub order_timeout_s: f64,
    /// Number of refused frames of the unit that is logged when they come within `refused_within_s`.
    pub refused_frames: u32,
    /// Time within which `refused_frames` must come, s.
    pub refused_within_s: f64,
    /// Time the dead man may be released, s.
    pub dead_man_s: f64,
    /// Speed below which a brake that lasts becomes the holding brake, km/h (S4).
    pub holding_below_kmh: f64,
    /// Time for which this brake has to last, s (S4).
    pub holding_after_s: f64,
    /// Traction of one motor car that releases the holding brake, % of its greatest (S4: motor
    /// current).
    pub holding_release: f64,
    /// Cylinder force of a car, % of its full service, above which its brake is not released (S4).
    pub not_released_above: f64,
    /// Time after which a brake must be released, s.
    pub not_released_after_s: f64,
    /// Difference between a car's air brake and its demand, % of its full service, that counts as
    /// not following.
    pub not_following_above: f64,
    /// Time for which this difference has to last, s.
    pub not_following_after_s: f64,
    /// Time an inverter or a brake control unit may be silent, s.
    pub silent_after_s: f64,
    /// Speed by which an inverter's axles may differ from the others' before they count as slipping
    /// or sliding, km/h (S3).
    pub slip_kmh: f64,
    /// Time between giving a cab up and taking the other at a turn-back, s.
    #[serde(default = "cab_change_s")]
    pub cab_change_s: f64,
}

/// Time of a change of cabs on `line6`, for files without it.
const fn cab_change_s() -> f64 {
    1.0
}

impl TcmsData {
    /// Checks ranges and order.
    ///
    /// # Errors
    /// The first thing that cannot be.
    pub fn check(&self) -> Result<(), ConfigError> {
        for (key, notches) in [
            ("tcms.power_notches", &self.power_notches[..]),
            ("tcms.brake_notches", &self.brake_notches[..]),
        ] {
            for share in notches {
                within(key, *share, 0.0, 100.0)?;
            }
            if notches.windows(2).any(|pair| pair[1] <= pair[0]) {
                return Err(ConfigError::Conflict(format!(
                    "{key} {notches:?} must rise from notch to notch"
                )));
            }
        }
        for volts in self.controller_v {
            within("tcms.controller_v", volts, 0.0, 10.0)?;
        }
        if self.controller_v.windows(2).any(|pair| pair[1] <= pair[0]) {
            return Err(ConfigError::Conflict(format!(
                "tcms.controller_v {:?} must rise: a < b < c < d",
                self.controller_v
            )));
        }
        check_ranges! { self, "tcms.";
            order_timeout_s: 0.0, LONGEST_S;
            refused_frames: 1.0, 1000.0;
            refused_within_s: 0.0, LONGEST_S;
            dead_man_s: 0.0, LONGEST_S;
            holding_below_kmh: 0.1, 20.0;
            holding_after_s: 0.0, LONGEST_S;
            holding_release: 0.1, 100.0;
            not_released_above: 0.1, 100.0;
            not_released_after_s: 0.0, LONGEST_S;
            not_following_above: 0.1, 100.0;
            not_following_after_s: 0.0, LONGEST_S;
            silent_after_s: 0.0, LONGEST_S;
            slip_kmh: 0.1, 50.0;
            cab_change_s: 0.0, LONGEST_S;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::train::TrainData;

    const LINE6: &str = include_str!("../../../scripts/trains/line6.toml");

    /// The file with one of its lines under `[tcms]` written otherwise.
    fn with(key: &str, value: &str) -> String {
        let (head, tcms) = LINE6.split_once("[tcms]").unwrap();
        let mut found = false;
        let lines = tcms.lines().map(|line| {
            if line.split('=').next().is_some_and(|k| k.trim() == key) {
                found = true;
                format!("{key} = {value}")
            } else {
                line.to_owned()
            }
        });
        let tcms: Vec<_> = lines.collect();
        assert!(found, "{key}");
        format!("{head}[tcms]{}", tcms.join("\n"))
    }

    #[test]
    fn impossible_tcms_data_is_refused_and_the_key_is_named() {
        let mut keys = std::collections::BTreeSet::new();
        for (key, value) in [
            ("power_notches", "[15, 30, 30, 75, 100]"),
            ("power_notches", "[-1, 30, 50, 75, 100]"),
            ("power_notches", "[15, 30, 50, 75, 101]"),
            ("brake_notches", "[13.5, 27.5, 42, 56.5, 71, 85.5, nan]"),
            ("brake_notches", "[27.5, 13.5, 42, 56.5, 71, 85.5, 100]"),
            ("controller_v", "[0.5, 4.8, 4.8, 9.5]"),
            ("controller_v", "[0.5, 4.8, 5.2, 10.5]"),
            ("controller_v", "[-0.5, 4.8, 5.2, 9.5]"),
            ("order_timeout_s", "-0.1"),
            ("refused_frames", "0"),
            ("refused_frames", "1001"),
            ("refused_within_s", "61.0"),
            ("dead_man_s", "nan"),
            ("holding_below_kmh", "0.0"),
            ("holding_after_s", "inf"),
            ("holding_release", "0.0"),
            ("not_released_above", "101.0"),
            ("not_released_after_s", "-1.0"),
            ("not_following_above", "0.0"),
            ("not_following_after_s", "61.0"),
            ("silent_after_s", "-1.0"),
            ("slip_kmh", "0.0"),
            ("cab_change_s", "61.0"),
        ] {
            let error = TrainData::from_toml(&with(key, value)).unwrap_err();
            let named = error.to_string().contains(&format!("tcms.{key}"));
            assert!(named, "{key} = {value}: {error}");
            keys.insert(key);
        }
        let table = LINE6.split_once("[tcms]").unwrap().1;
        let table = table.split("[[").next().unwrap();
        let all = table.lines().filter(|line| line.contains('=')).count();
        assert_eq!(keys.len(), all, "every key of the table");
    }

    #[test]
    fn keys_missing_unknown_or_of_another_kind_are_named() {
        for (text, word) in [
            (LINE6.replace("slip_kmh = 5", ""), "slip_kmh"),
            (LINE6.replace("slip_kmh = 5", "slip_mph = 5"), "slip_mph"),
            (with("power_notches", "[15, 30]"), "power_notches"),
            (with("refused_frames", "-5"), "refused_frames"),
            (with("dead_man_s", "\"long\""), "dead_man_s"),
        ] {
            let error = TrainData::from_toml(&text).unwrap_err().to_string();
            assert!(error.contains(word), "{word}: {error}");
        }
    }
}
