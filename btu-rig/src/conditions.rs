//! Deviations of train, track and sensors in one run from what the unit is configured for.

/// Greatest factor on dead times and time constants that may be asked for.
pub const MAX_DELAY_FACTOR: f64 = 5.0;

/// A force that works against the train besides its resistance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Disturbance {
    /// The track's and the train's own resistance alone.
    #[default]
    None,
    /// `f_d·v` with `f_d = amplitude·sin(2π·hz·t)` [S1: 2e4 N·s/m at 1 Hz].
    Sine {
        /// Amplitude, N·s/m.
        amplitude_n_s_per_m: f64,
        /// Frequency, Hz.
        hz: f64,
    },
}

/// Differences from the nominal train and track. The default has none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Added to every gradient of the track, ‰, uphill positive.
    pub gradient_offset_permille: f64,
    /// Wheel–rail adhesion coefficient at standstill, less at speed [Curtius and Kniffler: 0.33 dry];
    /// wet about half of it, leaves or ice 0.05 to 0.1. S3's motor cars ask for 0.16 in full service.
    pub adhesion: f64,
    /// Factor on dead times and time constants of traction and brakes.
    pub delay_factor: f64,
    /// Factor on the braking effort the train gives for a demand.
    pub brake_factor: f64,
    /// True wheel diameter divided by the configured one.
    pub wheel_factor: f64,
    /// Where each marker really lies, relative to the track database, m.
    pub marker_offsets_m: [f64; 4],
    /// Force besides resistance and gradient.
    pub disturbance: Disturbance,
}

/// Deviations of sensors and signal sources from ideal ones, and their scatter. By default there are none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors {
    /// Level in the ATP antenna divided by the intended one: height and tuning of the antenna.
    pub level_factor: f64,
    /// Noise of that level from scan to scan, standard deviation as a share of it.
    pub level_noise: f64,
    /// Added to the carrier, Hz.
    pub carrier_offset_hz: f64,
    /// Added to the code rate, Hz.
    pub rate_offset_hz: f64,
    /// Noise of the code rate from scan to scan, standard deviation, Hz.
    pub rate_jitter_hz: f64,
    /// Displacement of each tooth of the tone wheels, standard deviation as a share of the pitch.
    pub tooth_pitch: f64,
    /// Seed of the displacements of the teeth.
    pub teeth_seed: u64,
    /// Spurious pulses of each tachometer channel, 1/s.
    pub spurious_pulses_per_s: f64,
}

impl Default for Sensors {
    fn default() -> Self {
        Self {
            level_factor: 1.0,
            level_noise: 0.0,
            carrier_offset_hz: 0.0,
            rate_offset_hz: 0.0,
            rate_jitter_hz: 0.0,
            tooth_pitch: 0.0,
            teeth_seed: 0,
            spurious_pulses_per_s: 0.0,
        }
    }
}

impl Default for Conditions {
    fn default() -> Self {
        Self {
            gradient_offset_permille: 0.0,
            adhesion: 0.33,
            delay_factor: 1.0,
            brake_factor: 1.0,
            wheel_factor: 1.0,
            marker_offsets_m: [0.0; 4],
            disturbance: Disturbance::None,
        }
    }
}
