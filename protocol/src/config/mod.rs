//! Unit configuration: the code table, margins and times of one type of unit, as checked data.
//!
//! No number of a real unit is public, so every value in a configuration file is a bench default
//! unless the file says where it comes from. Files are TOML; see `scripts/units/`.

use alloc::string::{String, ToString};
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::check_ranges;

mod ato;
mod check;
mod codes;
mod driverless;
mod way;

pub use ato::{
    AtoConfig, AtoTrainConfig, AtoWatchConfig, ControllerKind, FuzzyConfig, GainUnit, JogConfig,
    ObserverConfig, PiConfig, ProfileConfig, PssConfig, ServoConfig,
};
pub use codes::{AT_MOST, CodeMeaning, SpeedCode, find_code};
pub use driverless::DriverlessConfig;
pub use way::{MarkerConfig, TachoConfig};

/// Why a configuration or line file is refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ConfigError {
    /// The text does not parse; the message has line and column.
    #[error("{0}")]
    Syntax(String),
    /// A value is out of its range.
    #[error("{key} = {value} is outside {low} .. {high}")]
    Range {
        /// Path of the key in the file, as `tacho.window_ms`.
        key: String,
        /// Value in the file.
        value: String,
        /// Least value allowed.
        low: String,
        /// Greatest value allowed.
        high: String,
    },
    /// Values do not fit together.
    #[error("{0}")]
    Conflict(String),
}

/// ATP receiver and decoder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReceiverConfig {
    /// Accepted distance from the carrier, Hz.
    pub carrier_tolerance_hz: f64,
    /// Accepted distance from the code rate, Hz.
    pub rate_tolerance_hz: f64,
    /// Weakest level decoded, mV.
    pub level_min_mv: f64,
    /// Strongest level decoded, mV.
    pub level_max_mv: f64,
    /// Nominal level, mV.
    pub level_nominal_mv: f64,
    /// Least level of the code that is taken over any other code in the antenna, dB.
    #[serde(default = "way::thousandths::<4000>")]
    pub apart_db: f64,
    /// By how much the code shifts the carrier up and down, Hz; 0 = it keys the carrier on and off.
    #[serde(default)]
    pub shift_hz: f64,
    /// Further carriers, Hz, beside those of the code table, on which any code of the table may come.
    #[serde(default)]
    pub other_carriers_hz: Vec<f64>,
    /// Time a code must be steady before it counts, ms.
    pub detect_ms: u32,
    /// Time the last code stays in force when none is decoded, ms.
    pub hold_ms: u32,
}

/// Stop and proceed: without a code the driver of a train that was stopped may go on at a low limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StopAndProceedConfig {
    /// Limit after the acknowledged stop, km/h.
    pub limit_kmh: f64,
    /// Time from one warning to the next, ms.
    pub warning_ms: u32,
    /// Duration of each sound, ms.
    pub sounds_ms: u32,
}

/// Overspeed supervision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OverspeedConfig {
    /// Alarm above limit plus this, km/h.
    pub alarm_margin_kmh: f64,
    /// Full service brake above limit plus this, km/h.
    pub fsb_margin_kmh: f64,
    /// Emergency brake above limit plus this, km/h; without this margin no overspeed alone applies the emergency brake,
    /// only a service brake that does not slow the train.
    #[serde(default)]
    pub eb_margin_kmh: Option<f64>,
    /// How long the speed must stay above the alarm margin, ms.
    pub alarm_delay_ms: u32,
    /// How long the speed must stay above the service margin, ms.
    pub fsb_delay_ms: u32,
    /// How long the speed must stay above the emergency margin, ms.
    pub eb_delay_ms: u32,
    /// Time the service brake has to show its effect, ms.
    pub brake_proof_ms: u32,
    /// Deceleration that proves the effect of the service brake, m/s².
    pub brake_proof_mps2: f64,
    /// Time after a step down of the limit without an emergency brake for overspeed, ms; later there is none, either,
    /// while the service brake is proved (S2 runs 55 → 45 at 50 km/h, the grace is not printed).
    pub step_down_grace_ms: u32,
    /// Time the brake line has to follow the EB relay, ms.
    pub eb_feedback_ms: u32,
    /// Limit in yard mode, km/h.
    pub yard_kmh: f64,
    /// Limit in emergency mode, km/h.
    pub emergency_kmh: f64,
    /// Speed above which a jog to the stop point is braked, km/h.
    #[serde(default = "way::thousandths::<5000>")]
    pub jog_kmh: f64,
}

/// Supervision of the doors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DoorConfig {
    /// Distance from the stop point that counts as aligned, m [S0: ±0.30].
    pub aligned_m: f64,
    /// How long doors must be seen open while moving, or on a side that is not enabled, ms.
    pub open_moving_ms: u32,
    /// How long the lines of the doors must contradict each other, ms.
    #[serde(default = "way::whole::<500>")]
    pub lines_ms: u32,
}

/// The train that the unit is in.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrainConfig {
    /// Train number; 0 = none: station data for any train are taken, and the answers carry the number received.
    pub number: u16,
}

/// Orders of the wayside, and what is keyed in at the cab.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct OrdersConfig {
    /// Difference between the section length in orders and in the track database, m.
    pub length_tolerance_m: f64,
    /// Time within which the cabs must be changed at a turn-back, ms.
    pub cab_change_ms: u32,
    /// Frames in a row with one train number after which this number counts as keyed in.
    pub entry_frames: u8,
}

/// The values of `sg100`, for configurations without this table.
impl Default for OrdersConfig {
    fn default() -> Self {
        Self {
            length_tolerance_m: 1.0,
            cab_change_ms: 3000,
            entry_frames: 3,
        }
    }
}

/// Silence that each channel is allowed, and frames rejected on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LinkConfig {
    /// I/O silence that applies the emergency brake, ms.
    pub io_timeout_ms: u32,
    /// TCMS silence, or a standing alive counter, that counts as lost, ms.
    pub tcms_timeout_ms: u32,
    /// TWC silence that counts as lost, ms.
    pub twc_timeout_ms: u32,
    /// Tester silence that ends arming, ms (design: 1 s).
    pub tester_timeout_ms: u32,
    /// Rejected frames on one channel within 10 s that are worth an event.
    pub rejected_per_10s: u32,
}

/// Tolerances of the signals of the TEST board, against the values it is asked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TestBoardConfig {
    /// Carrier, Hz.
    pub carrier_tolerance_hz: f64,
    /// Code rate, Hz.
    pub rate_tolerance_hz: f64,
    /// Level, share of the level asked for.
    pub level_tolerance: f64,
    /// Speed, share of the speed asked for.
    pub speed_tolerance: f64,
}

/// The values of `sg100`, for configurations without this table.
impl Default for TestBoardConfig {
    fn default() -> Self {
        Self {
            carrier_tolerance_hz: 5.0,
            rate_tolerance_hz: 0.05,
            level_tolerance: 0.05,
            speed_tolerance: 0.02,
        }
    }
}

/// TWC in its loop: two tones for the two values of a bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TwcConfig {
    /// Middle of the two tones, Hz.
    pub middle_hz: f64,
    /// Distance of each tone from the middle, Hz; the upper tone is bit 1.
    pub apart_hz: f64,
    /// Bits per second.
    pub bits_per_s: f64,
    /// Level in the antenna, mV rms.
    pub level_mv: f64,
}

/// The values of `sg100`, for configurations without this table.
impl Default for TwcConfig {
    fn default() -> Self {
        Self {
            middle_hz: 9650.0,
            apart_hz: 2400.0,
            bits_per_s: 4800.0,
            level_mv: 500.0,
        }
    }
}

/// Start after power-up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StartConfig {
    /// How long the self-test takes, ms.
    pub self_test_ms: u32,
}

/// Everything one type of unit is configured with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UnitConfig {
    /// Name, at most 16 ASCII characters.
    pub name: String,
    /// The code table; each code's place is its index on the wire.
    pub codes: Vec<SpeedCode>,
    /// ATP receiver and decoder.
    pub receiver: ReceiverConfig,
    /// Tachometers.
    pub tacho: TachoConfig,
    /// Overspeed supervision.
    pub overspeed: OverspeedConfig,
    /// Stop and proceed; without it a train without a code stays where it is.
    #[serde(default)]
    pub stop_and_proceed: Option<StopAndProceedConfig>,
    /// Supervision of the doors.
    pub doors: DoorConfig,
    /// The train that the unit is in.
    #[serde(default)]
    pub train: TrainConfig,
    /// Orders of the wayside, and what is keyed in at the cab.
    #[serde(default)]
    pub orders: OrdersConfig,
    /// Time-outs of the channels.
    pub link: LinkConfig,
    /// TWC in its loop.
    #[serde(default)]
    pub twc: TwcConfig,
    /// Supervision of markers and TRA.
    pub marker: MarkerConfig,
    /// Accuracy of the TEST board.
    #[serde(default)]
    pub test_board: TestBoardConfig,
    /// Automatic operation.
    pub ato: AtoConfig,
    /// Driverless operation.
    #[serde(default)]
    pub driverless: DriverlessConfig,
    /// Start after power-up.
    pub start: StartConfig,
}

impl UnitConfig {
    /// Reads and checks a configuration file.
    ///
    /// # Errors
    /// The first thing wrong: syntax with line and column, a value out of range, or values that do
    /// not fit together.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        let config: Self = toml::from_str(text).map_err(|e| ConfigError::Syntax(e.to_string()))?;
        config.check()?;
        Ok(config)
    }

    /// Carriers that the receiver listens on, Hz, each once.
    pub fn carriers_hz(&self) -> Vec<f64> {
        let mut carriers = Vec::new();
        let of_codes = self.codes.iter().map(|code| code.carrier_hz);
        for carrier_hz in of_codes.chain(self.receiver.other_carriers_hz.iter().copied()) {
            if !carriers.contains(&carrier_hz) {
                carriers.push(carrier_hz);
            }
        }
        carriers
    }

    /// Whether a code may come on the carrier heard, Hz, within the tolerance.
    pub fn is_on_carrier(&self, code: &SpeedCode, heard_hz: f64) -> bool {
        let others = self.receiver.other_carriers_hz.iter().copied();
        let mut carriers = core::iter::once(code.carrier_hz).chain(others);
        carriers.any(|of| libm::fabs(heard_hz - of) <= self.receiver.carrier_tolerance_hz)
    }

    /// Distance one pulse stands for, m.
    pub fn metres_per_pulse(&self) -> f64 {
        core::f64::consts::PI * self.tacho.wheel_diameter_mm
            / 1000.0
            / f64::from(self.tacho.pulses_per_turn)
    }
}

/// CRC-32 of a configuration or line file, as the unit reports it in its identity.
pub fn checksum(text: &str) -> u32 {
    crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(text.as_bytes())
}

pub(crate) fn conflict(text: &str) -> ConfigError {
    ConfigError::Conflict(text.to_string())
}

/// Checks ranges of numbers of a configuration. Each line gives the path to a field (prefix and path are the key in the
/// file), the least and the greatest value permitted.
#[macro_export]
macro_rules! check_ranges {
    ($of:expr, $prefix:literal; $($first:ident $(. $rest:ident)*: $low:expr, $high:expr;)*) => {
        $($crate::config::within(
            concat!($prefix, stringify!($first) $(, ".", stringify!($rest))*),
            f64::from($of.$first $(.$rest)*),
            $low,
            $high,
        )?;)*
    };
}

/// Checks that a value lies in its range; not-a-number lies in none.
///
/// # Errors
/// [`ConfigError::Range`], with the key.
pub fn within(key: &str, value: f64, low: f64, high: f64) -> Result<(), ConfigError> {
    // A negated comparison so that not-a-number is refused, too.
    if value >= low && value <= high {
        return Ok(());
    }
    Err(ConfigError::Range {
        key: key.to_string(),
        value: value.to_string(),
        low: low.to_string(),
        high: high.to_string(),
    })
}
