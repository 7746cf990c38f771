//! What goes into a speed controller and what comes out of it.

/// Inputs of a controller in each 50 ms cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControllerInput {
    /// Speed to run at: the most restrictive of limit and order, m/s.
    pub cruise_mps: f64,
    /// Speed at which the coming effort will meet the train, m/s.
    pub speed_mps: f64,
    /// Acceleration when the coming effort meets the train, m/s².
    pub accel_mps2: f64,
    /// Distance to the stop point when the coming effort meets the train, m; `None` = not known.
    pub to_stop_m: Option<f64>,
    /// Distance from each marker to the stop point, m.
    pub markers_to_stop_m: [f64; 4],
    /// Mass to be accelerated, kg.
    pub mass_kg: f64,
    /// Deceleration the full brake has on the steepest descent of the approach, m/s².
    pub brake_mps2: f64,
    /// Force granted for the last demand, N, feed-forward taken off again.
    pub granted_n: f64,
}

/// Demand of a controller.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Demand {
    /// Target speed now, m/s.
    pub target_mps: f64,
    /// Force on the train, powering positive, N.
    pub force_n: f64,
}
