//! One row of an automatic run's record, each 50 ms cycle.

/// One cycle. What the unit has not said is not-a-number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Time since the train began to move, s.
    pub t_s: f64,
    /// Head of the train in the section, m; true.
    pub x_m: f64,
    /// True speed, km/h.
    pub speed_kmh: f64,
    /// Speed the unit measures, km/h.
    pub measured_kmh: f64,
    /// Limit in force, km/h.
    pub limit_kmh: f64,
    /// ATO's target, km/h.
    pub target_kmh: f64,
    /// Effort sent to TCMS, −1024..1023.
    pub effort: f64,
    /// True acceleration, mean of 50 ms, m/s².
    pub accel_mps2: f64,
    /// Change of that in 200 ms, by time, m/s³.
    pub jerk_mps3: f64,
    /// Position in the section as the unit sees it, m.
    pub position_m: f64,
    /// Traction, N.
    pub traction_n: f64,
    /// Electric brake, N.
    pub electric_brake_n: f64,
    /// Air brake, N.
    pub air_brake_n: f64,
    /// Power of traction at the wheels, mean of the cycle, W.
    pub power_w: f64,
    /// A car slips or slides.
    pub sliding: bool,
}
