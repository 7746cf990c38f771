//! Data of a train's TCMS, the `[tcms]` table of its file.

use protocol::config::{ConfigError, within};
use serde::{Deserialize, Serialize};

/// Data of the train control and monitoring system.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
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
    /// Time the dead man may be released, s.
    pub dead_man_s: f64,
    /// Speed below which a brake that lasts becomes the holding brake, km/h (S4).
    pub holding_below_kmh: f64,
    /// Time it has to last, s (S4).
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
    /// Time it has to last, s.
    pub not_following_after_s: f64,
    /// Time an inverter or a brake control unit may be silent, s.
    pub silent_after_s: f64,
    /// Speed by which an inverter's axles may differ from the others' before they count as slipping
    /// or sliding, km/h (S3).
    pub slip_kmh: f64,
}

impl TcmsData {
    /// Checks ranges and order.
    ///
    /// # Errors
    /// The first thing that cannot be.
    pub fn check(&self) -> Result<(), ConfigError> {
        let time = |key, value| within(key, value, 0.0, 60.0);
        for share in self.power_notches.iter().chain(&self.brake_notches) {
            within("tcms: notch", *share, 0.0, 100.0)?;
        }
        for (key, notches) in [
            ("power_notches", &self.power_notches[..]),
            ("brake_notches", &self.brake_notches[..]),
        ] {
            if notches.windows(2).any(|pair| pair[1] <= pair[0]) {
                return Err(ConfigError::Conflict(format!(
                    "tcms.{key} {notches:?} must rise from notch to notch"
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
        time("tcms.order_timeout_s", self.order_timeout_s)?;
        time("tcms.dead_man_s", self.dead_man_s)?;
        within("tcms.holding_below_kmh", self.holding_below_kmh, 0.1, 20.0)?;
        time("tcms.holding_after_s", self.holding_after_s)?;
        within("tcms.holding_release", self.holding_release, 0.1, 100.0)?;
        within(
            "tcms.not_released_above",
            self.not_released_above,
            0.1,
            100.0,
        )?;
        time("tcms.not_released_after_s", self.not_released_after_s)?;
        within(
            "tcms.not_following_above",
            self.not_following_above,
            0.1,
            100.0,
        )?;
        time("tcms.not_following_after_s", self.not_following_after_s)?;
        time("tcms.silent_after_s", self.silent_after_s)?;
        within("tcms.slip_kmh", self.slip_kmh, 0.1, 50.0)
    }
}
