//! Figures of a run, from its rows.

use protocol::CYCLE;

use super::Row;

/// Jerk that passengers notice [S1: 0.8 m/s³].
pub const COMFORT_JERK_MPS3: f64 = 0.8;
/// Cycles whose jerk the end of the motion touches: 200 ms of change and the 50 ms of the mean.
const STOP_CYCLES: usize = 5;

/// Figures of one run, all of the true motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metrics {
    /// Head of the train at rest less stop point, m; above 0 = past it.
    pub stop_error_m: f64,
    /// From the beginning of motion to the last standstill, s.
    pub run_time_s: f64,
    /// Greatest acceleration, mean of 50 ms, km/h/s.
    pub peak_accel_kmh_s: f64,
    /// Greatest deceleration, as a positive number, km/h/s. The last cycle, in which the train
    /// comes to rest, is left out.
    pub peak_decel_kmh_s: f64,
    /// Greatest size of jerk: change of acceleration over 200 ms, m/s³. What the end of a brake at
    /// standstill gives cannot be avoided and is left out.
    pub peak_jerk_m_s3: f64,
    /// Root mean square of jerk, m/s³, the same left out.
    pub rms_jerk_m_s3: f64,
    /// Share of the run time with jerk above 0.8 m/s³ [S1], the same left out.
    pub rough_share: f64,
    /// Root mean square of true speed less ATO's target while moving, km/h.
    pub rms_speed_error_kmh: f64,
    /// Greatest speed, km/h.
    pub peak_speed_kmh: f64,
    /// Work of traction, kWh.
    pub energy_kwh: f64,
}

impl Metrics {
    /// Figures of a run whose stop point lies at `stop_m`; `None` if the train never moved.
    pub fn of(rows: &[Row], stop_m: f64) -> Option<Self> {
        let first = rows.iter().position(|row| row.speed_kmh > 0.0)?;
        let last = rows.iter().rposition(|row| row.speed_kmh > 0.0)?;
        let moving = &rows[first..=last];
        // A train that never stood again has no end to leave out.
        let stood = last + 1 < rows.len();
        let smooth = if stood {
            &moving[..moving.len().saturating_sub(STOP_CYCLES)]
        } else {
            moving
        };
        let accel = |row: &Row| row.accel_mps2 * 3.6;
        let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let rough = smooth
            .iter()
            .filter(|row| row.jerk_mps3.abs() > COMFORT_JERK_MPS3)
            .count();
        let end = rows.get(last + 1).unwrap_or(&rows[last]);
        Some(Self {
            stop_error_m: end.x_m - stop_m,
            run_time_s: end.t_s.max(0.0),
            peak_accel_kmh_s: most(&mut moving.iter().map(accel)),
            peak_decel_kmh_s: most(&mut moving.iter().map(|row| -accel(row))),
            peak_jerk_m_s3: most(&mut smooth.iter().map(|row| row.jerk_mps3.abs())),
            rms_jerk_m_s3: rms(smooth.iter().map(|row| row.jerk_mps3)),
            rough_share: rough as f64 / moving.len() as f64,
            rms_speed_error_kmh: rms(moving
                .iter()
                .map(|row| row.speed_kmh - row.target_kmh)
                .filter(|e| e.is_finite())),
            peak_speed_kmh: most(&mut moving.iter().map(|row| row.speed_kmh)),
            energy_kwh: moving.iter().map(|row| row.power_w.max(0.0)).sum::<f64>()
                * CYCLE.as_secs()
                / 3.6e6,
        })
    }
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0usize), |(sum, n), v| (sum + v * v, n + 1));
    if count == 0 {
        0.0
    } else {
        (sum / count as f64).sqrt()
    }
}
