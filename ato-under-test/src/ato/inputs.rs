//! Inputs of ATO in each cycle.

use protocol::Speed;
use protocol::config::SpeedCode;
use protocol::line::Section;
use protocol::message::{Mode, RunningMode};

use super::art::Checks;

#[derive(Clone, Copy, Debug)]
pub struct AtoInputs<'a> {
    /// Operating mode set by ATP.
    pub mode: Mode,
    /// Limit from ATP.
    pub limit: Speed,
    /// The unit's speed codes, by which the track database names limits.
    pub codes: &'a [SpeedCode],
    /// Time within which a new code is heard, s.
    pub heard_within_s: f64,
    /// Fixed speed ordered by the wayside.
    pub fixed_speed: Option<Speed>,
    /// Running mode ordered by the wayside.
    pub running_mode: RunningMode,
    /// Section of the track database the train is in.
    pub section: Option<&'a Section>,
    /// Position in the section, m.
    pub position_m: f64,
    /// Distance by which the train may be farther on while markers do not come, m.
    pub ahead_m: f64,
    /// Distance from the stop point that counts as aligned, m.
    pub aligned_m: f64,
    /// The section's last marker was seen.
    pub last_marker: bool,
    pub jogs: bool,
    /// Measured speed.
    pub speed: Speed,
    /// Standstill as ATP means it, below 0.3 m/s.
    pub standstill: bool,
    /// ATP or TCMS cuts powering.
    pub power_cut: bool,
    /// Report of TCMS on the train.
    pub train: TrainReport,
    /// Passenger load TCMS reports, kg.
    pub load_kg: f64,
    /// Results of KRN's checks.
    pub checks: Checks,
}

/// Report of TCMS on the train. Efforts are −1024 full brake .. 1023 full power.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrainReport {
    /// TCMS brakes by itself, or gives no power.
    pub overrides: bool,
    /// Effort last sent to TCMS.
    pub sent: i16,
    /// Effort the train gives; `None` = not known.
    pub given: Option<i16>,
}
