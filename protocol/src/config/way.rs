//! What speed and position are measured by: tachometers and markers.

use serde::{Deserialize, Serialize};

/// Tachometers, standstill and rollback.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TachoConfig {
    /// Pulses per wheel turn.
    pub pulses_per_turn: u32,
    /// Wheel diameter, mm.
    pub wheel_diameter_mm: f64,
    /// Amount by which a diameter keyed in may be smaller than the configured one, mm: a wheel worn to its limit.
    #[serde(default = "thousandths::<80_000>")]
    pub worn_mm: f64,
    /// Amount by which a diameter keyed in may be greater than the configured one, mm: the error of measuring a new
    /// wheel.
    #[serde(default = "thousandths::<5000>")]
    pub over_mm: f64,
    /// Averaging time of the speed measurement, ms.
    pub window_ms: u32,
    /// Difference between the channels that is a fault, km/h.
    pub difference_kmh: f64,
    /// How long the difference must last, ms.
    pub difference_ms: u32,
    /// Greatest believable acceleration of a wheel, m/s².
    pub plausible_accel_mps2: f64,
    /// Coefficient of adhesion on a dry rail: a wheel spins or slides if its speed changes faster than adhesion lets
    /// the speed of a train change.
    #[serde(default = "thousandths::<350>")]
    pub adhesion: f64,
    /// Speed, km/h, by which the measured speed must have fallen below the lowest speed that adhesion allows. If
    /// neither tachometer gives pulses then, both are not believed.
    #[serde(default = "thousandths::<2000>")]
    pub fall_kmh: f64,
    /// How long that must last, ms.
    #[serde(default = "whole::<100>")]
    pub fall_ms: u32,
    /// Deceleration that the emergency brake has at the least, m/s². A train whose measured speed is not believed
    /// counts as stopped when a stop at this deceleration would be over, unless TCMS says that the train moves.
    #[serde(default = "thousandths::<800>")]
    pub least_brake_mps2: f64,
    /// Time for which power may be asked for before a tachometer gives a pulse, ms.
    #[serde(default = "whole::<6000>")]
    pub no_pulses_ms: u32,
    /// Speed of the axles that TCMS measures, km/h, above which a train moves although no tachometer gives pulses.
    #[serde(default = "thousandths::<2000>")]
    pub tcms_moves_kmh: f64,
    /// Speed, km/h, by which the axles that TCMS measures must be faster than both tachometers, so that these are not
    /// believed.
    #[serde(default = "thousandths::<10_000>")]
    pub tcms_difference_kmh: f64,
    /// Share by which the unit's clock may be faster than the pace of TCMS's alive counter.
    #[serde(default = "thousandths::<80>")]
    pub clock_share: f64,
    /// Share of the way by which the tachometers may differ from each other, and each from the track's way.
    #[serde(default = "thousandths::<30>")]
    pub share: f64,
    /// Speed that counts as standing, km/h [ASCE: 0.3 m/s].
    pub standstill_kmh: f64,
    /// How long it must last, ms.
    pub standstill_ms: u32,
    /// Way against the reverser that trips, m.
    pub rollback_m: f64,
    /// Way without a stop, at a speed that counts as standing, from which on a train moves, m.
    #[serde(default = "thousandths::<500>")]
    pub creep_m: f64,
}

/// Supervision of markers and TRA.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MarkerConfig {
    /// Distance from its place at which a marker is believed right after another one, m.
    pub window_m: f64,
    /// Distance from its place at which a marker is believed right after the section's start, where
    /// trains do not stand to the metre, m.
    pub start_window_m: f64,
    /// Greatest share of the way run since the last marker or the start by which the window widens, because wheels may
    /// differ from the configured diameter.
    pub window_share: f64,
    /// Scatter of markers around their places, m (1σ).
    pub scatter_m: f64,
    /// Scatter of wheels around the configured diameter, share (1σ).
    pub wheel_spread: f64,
    /// Time between TRA tests, ms.
    pub tra_test_ms: u32,
    /// Time within which the same marker again is the same edge, ms.
    #[serde(default = "whole::<100>")]
    pub debounce_ms: u32,
    /// Time within which a further pulse of the same marker comes from TRA's contact, and not from a marker of the
    /// track, ms.
    #[serde(default = "whole::<500>")]
    pub bounce_ms: u32,
    /// Tones of PSM1 to PSM4 behind the marker antenna, Hz.
    #[serde(default = "tones_hz")]
    pub tones_hz: [f64; 4],
    /// Level in the antenna over the marker's middle, mV rms.
    #[serde(default = "thousandths::<500_000>")]
    pub level_mv: f64,
    /// Distance from the middle at which it has fallen to 61 % (1σ of a bell), m.
    #[serde(default = "thousandths::<100>")]
    pub reach_m: f64,
}

/// Value of a key that a configuration may go without, as `sg100` has it: so many thousandths.
pub(super) const fn thousandths<const N: u32>() -> f64 {
    N as f64 / 1000.0
}

/// Value of a key that a configuration may go without, as `sg100` has it: a whole number.
pub(super) const fn whole<const N: u32>() -> u32 {
    N
}

const fn tones_hz() -> [f64; 4] {
    [16_000.0, 17_000.0, 18_000.0, 19_000.0]
}
