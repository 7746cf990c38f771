//! Figures of a run, from its rows.
//!
//! All figures are of the true motion, from the first row in which the train moves to the last such row. The jerk
//! with which a braked train comes to rest cannot be avoided; it comes after the last of these rows and does not count.

use protocol::CYCLE;
use protocol::signal::Signal;

use super::Row;

/// Jerk that passengers notice [S1: 0.8 m/s³].
pub const COMFORT_JERK_MPS3: f64 = 0.8;

/// A figure of a run: its value, and its key, name, unit and decimals in every report.
#[derive(Debug)]
pub struct Figure {
    /// Key in JSON and CSV, ending in its unit.
    pub key: &'static str,
    /// Name for people.
    pub name: &'static str,
    /// Unit for people: `%` for a share.
    pub unit: &'static str,
    decimals: usize,
    /// Reads the figure's value, in the key's unit, from a run's figures.
    pub of: fn(&Metrics) -> f64,
}

impl Figure {
    /// A value of this figure for people, without unit.
    pub fn shown(&self, value: f64) -> String {
        let scale = if self.unit == "%" { 100.0 } else { 1.0 };
        format!("{:.*}", self.decimals, value * scale)
    }
}

/// Declares a struct of figures and its table, in the order in which reports have them.
macro_rules! figures {
    (
        $(#[$doc:meta])*
        pub struct $figures:ident {
            $( $(#[$of:meta])+ $key:ident: $kind:ty = $name:literal, $unit:literal, $decimals:literal; )+
        }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
        pub struct $figures { $( $(#[$of])+ pub $key: $kind, )+ }

        impl $figures {
            /// Every figure, in the order in which reports have them.
            pub const ALL: &'static [Figure] = &[$( Figure {
                key: stringify!($key),
                name: $name,
                unit: $unit,
                decimals: $decimals,
                of: |figures| figures.$key,
            } ),+];
        }
    };
}

figures! {
    /// Figures of one run.
    pub struct Metrics {
        /// From the beginning of motion to the last standstill, or to where the run was broken off, s.
        run_time_s: f64 = "Run time", "s", 1;
        /// Greatest speed, km/h.
        peak_speed_kmh: f64 = "Greatest speed", "km/h", 1;
        /// Greatest acceleration, mean of 50 ms, km/h/s.
        peak_accel_kmh_s: f64 = "Greatest acceleration", "km/h/s", 2;
        /// Greatest deceleration, as a positive number, km/h/s.
        peak_decel_kmh_s: f64 = "Greatest deceleration", "km/h/s", 2;
        /// Greatest size of jerk: change of acceleration in 200 ms, m/s³.
        peak_jerk_m_s3: f64 = "Greatest jerk", "m/s³", 2;
        /// Root mean square of jerk, m/s³.
        rms_jerk_m_s3: f64 = "Jerk, rms", "m/s³", 3;
        /// Share of the time with jerk above 0.8 m/s³ (S1).
        rough_share: f64 = "Time with jerk above 0.8 m/s³", "%", 2;
        /// Root mean square of true speed less ATO's target, km/h.
        rms_speed_error_kmh: f64 = "Speed error, rms", "km/h", 2;
        /// Work of traction at the wheels, kWh. Nothing is taken off for what braking gives back.
        energy_kwh: f64 = "Traction energy at the wheels", "kWh", 2;
    }
}

impl Metrics {
    /// Figures of a run that took `run_time_s` (`None` = the train did not stop); `None` if the train never
    /// moved.
    pub fn of(rows: &[Row], run_time_s: Option<f64>) -> Option<Self> {
        let moves = |row: &Row| row.speed_kmh != 0.0;
        let first = rows.iter().position(moves)?;
        let last = rows.iter().rposition(moves)?;
        let moving = &rows[first..=last];
        let most = |of: fn(&Row) -> f64| moving.iter().map(of).fold(0.0, f64::max);
        let jerk = |row: &Row| row.value(Signal::TrainJerk);
        let rough = |row: &&Row| jerk(row).abs() > COMFORT_JERK_MPS3;
        let work_w = moving.iter().map(|row| row.power_w).sum::<f64>();
        Some(Self {
            run_time_s: run_time_s.unwrap_or(rows[last].t_s),
            peak_accel_kmh_s: most(|row| row.value(Signal::TrainAccel) * 3.6),
            peak_decel_kmh_s: most(|row| -row.value(Signal::TrainAccel) * 3.6),
            peak_jerk_m_s3: most(|row| row.value(Signal::TrainJerk).abs()),
            rms_jerk_m_s3: rms(moving.iter().map(jerk)),
            rough_share: moving.iter().filter(rough).count() as f64 / moving.len() as f64,
            rms_speed_error_kmh: rms(moving
                .iter()
                .map(|row| row.speed_kmh - row.value(Signal::Target))),
            peak_speed_kmh: most(|row| row.speed_kmh),
            energy_kwh: work_w * CYCLE.as_secs() / 3.6e6,
        })
    }
}

/// Root mean square of the finite values.
fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let known = values.filter(|value| value.is_finite());
    let (sum, count) = known.fold((0.0, 0.0), |(sum, n), v| (sum + v * v, n + 1.0));
    if count == 0.0 {
        return 0.0;
    }
    (sum / count).sqrt()
}

#[cfg(test)]
pub(super) mod tests {
    use protocol::Instant;
    use protocol::signal::Sample;

    use super::*;
    use crate::recorder;

    /// A row of a train that rolls, with these signals.
    fn row_at(t_s: f64, speed_kmh: f64, signals: &[(Signal, f64)]) -> Row {
        let mut sample = Sample::default();
        for (signal, value) in signals {
            sample.set(*signal, *value);
        }
        Row {
            signals: recorder::Row {
                at: Instant::ZERO,
                sample,
            },
            t_s,
            x_m: 0.0,
            speed_kmh,
            power_w: 0.0,
            sliding: false,
        }
    }

    /// A train that speeds up at 1 m/s² for 10 s under a target of 36 km/h, stands after 10 s more
    /// and whose traction gives 72 kW while it speeds up.
    pub fn triangle() -> Vec<Row> {
        let row = |cycle: i32| {
            let t_s = f64::from(cycle) * 0.05;
            let up = t_s < 10.0;
            let (v, x) = if up {
                (t_s, t_s * t_s / 2.0)
            } else {
                let left = (20.0 - t_s).max(0.0);
                (left, 100.0 - left * left / 2.0)
            };
            let jerking = (10.0..10.19).contains(&t_s);
            let signals = [
                (Signal::Limit, 41.0),
                (Signal::Target, if up { 36.0 } else { v * 3.6 }),
                (Signal::TrainAccel, if t_s <= 10.0 { 1.0 } else { -1.0 }),
                (Signal::TrainJerk, if jerking { -10.0 } else { 0.0 }),
            ];
            Row {
                x_m: x,
                power_w: if up { 72_000.0 } else { 0.0 },
                ..row_at(t_s, v * 3.6, &signals)
            }
        };
        (-20..=420).map(row).map(standing).collect()
    }

    fn standing(mut row: Row) -> Row {
        if (0.0..20.0).contains(&row.t_s) {
            return row;
        }
        // The instant of standstill: 1 m/s² end within one cycle.
        row.signals.sample.set(Signal::TrainAccel, 0.0);
        row.signals.sample.set(Signal::TrainJerk, 5.0);
        Row {
            speed_kmh: 0.0,
            x_m: if row.t_s < 0.0 { 0.0 } else { 100.0 },
            power_w: 0.0,
            ..row
        }
    }

    /// 72 kW for 10 s less the first row, which stands: 0.2 kWh less 1/200. Speed error 36 − 3.6·t
    /// over half the time: rms 36/√6 = 14.7 km/h. Four of 399 rows are rough.
    #[test]
    fn a_triangle_of_speed_has_the_figures_worked_out_by_hand() {
        let figures = Metrics::of(&triangle(), Some(20.0)).unwrap();
        let near = |a: f64, b: f64, tolerance: f64| assert!((a - b).abs() < tolerance, "{a} {b}");
        near(figures.run_time_s, 20.0, 1e-9);
        near(figures.peak_accel_kmh_s, 3.6, 1e-9);
        near(figures.peak_decel_kmh_s, 3.6, 1e-9);
        near(figures.peak_jerk_m_s3, 10.0, 1e-9);
        near(figures.rough_share, 4.0 / 399.0, 1e-9);
        near(figures.peak_speed_kmh, 36.0, 1e-9);
        near(figures.energy_kwh, 0.2 * 199.0 / 200.0, 1e-9);
        near(figures.rms_speed_error_kmh, 36.0 / 6f64.sqrt(), 0.1);
    }

    #[test]
    fn a_train_that_never_moved_has_none() {
        let standing: Vec<_> = triangle().into_iter().take(15).collect();
        assert_eq!(Metrics::of(&standing, None), None);
    }
}
