//! One row of a manual run's record, each 50 ms cycle.

/// MT pairs that are recorded.
pub const PAIRS: usize = 4;

/// One MT pair, demanded by TCMS and given by its equipment, N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pair {
    /// Demand on its inverters: powering above 0, electric brake below.
    pub motor_demand_n: f64,
    /// Traction of its inverters, a size.
    pub traction_n: f64,
    /// Electric brake of its inverters, a size (EFM of S3).
    pub electric_n: f64,
    /// Air demanded of its trailers.
    pub air_t_demand_n: f64,
    /// Air its trailers give.
    pub air_t_n: f64,
    /// Air demanded of its motor cars.
    pub air_m_demand_n: f64,
    /// Air its motor cars give.
    pub air_m_n: f64,
}

impl Pair {
    /// All brakes of the pair, N.
    pub fn brake_n(&self) -> f64 {
        self.electric_n + self.air_t_n + self.air_m_n
    }
}

/// One cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Time since the sequence began, s.
    pub t_s: f64,
    /// Head of the train in the section, m; true.
    pub x_m: f64,
    /// True speed, km/h, a size.
    pub speed_kmh: f64,
    /// Limit in force, km/h; not a number while it is not known.
    pub limit_kmh: f64,
    /// True acceleration, mean of 50 ms, m/s².
    pub accel_mps2: f64,
    /// Change of that in 200 ms, by time, m/s³.
    pub jerk_mps3: f64,
    /// Position of the master controller: −8 emergency, −7 .. 0 .. 4.
    pub lever: f64,
    /// Powering and braking value of TCMS, −1024..1023.
    pub value: f64,
    /// Demand on all inverters, N: powering above 0, electric brake below.
    pub motor_demand_n: f64,
    /// Braking effort wanted of the whole train, N.
    pub brake_demand_n: f64,
    /// Traction on the rails, N.
    pub traction_n: f64,
    /// Electric brake on the rails, N.
    pub electric_n: f64,
    /// Air brake on the rails, N.
    pub air_n: f64,
    /// MT pairs from the head.
    pub pairs: [Pair; PAIRS],
    /// Emergency, security or parking brake is on: more than TCMS demands.
    pub other_brakes: bool,
    /// A car slips or slides.
    pub sliding: bool,
}

impl Row {
    /// All service brakes on the rails, N.
    pub fn brake_n(&self) -> f64 {
        self.electric_n + self.air_n
    }

    /// Brake effort less what is demanded, as a share of it; none where nothing is demanded, other
    /// brakes are on, or the train stands.
    pub fn deviation(&self) -> Option<f64> {
        let counts = self.brake_demand_n > 0.0 && self.speed_kmh > 0.0 && !self.other_brakes;
        counts.then(|| self.brake_n() / self.brake_demand_n - 1.0)
    }
}
