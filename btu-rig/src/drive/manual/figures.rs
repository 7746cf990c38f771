//! Figures of a run by hand, from its rows.

use protocol::CYCLE;
use protocol::signal::Signal;

use super::settle::steady_deviation;
use super::{Plan, StepDone};
use crate::drive::Row;
use crate::drive::figure::figures;

/// Full power and full brake as values of TCMS.
const FULL_POWER: f64 = 1023.0;
const FULL_BRAKE: f64 = -1024.0;
/// Speeds the mean acceleration is taken between, km/h [S1: 3.0 km/h/s to 35 km/h], and where the
/// start's own jerk is over.
const ACCEL_TO_KMH: f64 = 35.0;
const ACCEL_FROM_KMH: f64 = 5.0;
/// Speeds the mean deceleration is taken between, km/h: the electric brake is there all the way.
const DECEL_FROM_KMH: f64 = 60.0;
const DECEL_TO_KMH: f64 = 20.0;

figures! {
    /// Figures of one run. What the run does not show is none.
    pub struct Figures {
        /// Mean acceleration at full power from rest to 35 km/h, km/h/s: with the jerk-limited start.
        accel_0_35_kmh_s: Option<f64> = "Acceleration at P4, 0 to 35 km/h", "km/h/s", 3;
        /// The same from 5 to 35 km/h.
        accel_5_35_kmh_s: Option<f64> = "Acceleration at P4, 5 to 35 km/h", "km/h/s", 3;
        /// Mean deceleration in full service from 60 to 20 km/h, km/h/s.
        decel_60_20_kmh_s: Option<f64> = "Deceleration at B7, 60 to 20 km/h", "km/h/s", 3;
        /// The same by the brakes alone, without running resistance and gradient.
        brake_60_20_kmh_s: Option<f64> = "Of it by the brakes alone", "km/h/s", 3;
        /// Greatest speed, km/h.
        peak_speed_kmh: f64 = "Greatest speed", "km/h", 1;
        /// Greatest size of jerk while the train moves, m/s³.
        peak_jerk_m_s3: f64 = "Greatest jerk", "m/s³", 2;
        /// Greatest traction of the train, N.
        max_te_n: f64 = "Greatest TE, train", "kN", 2;
        /// Of MT pair 1.
        max_te_pair1_n: f64 = "Greatest TE, MT pair 1", "kN", 2;
        /// Full service of the train as loaded, N (S3 table 1).
        full_service_n: f64 = "Full service of the car table", "kN", 2;
        /// Greatest braking effort demanded, N.
        max_brake_demand_n: f64 = "Greatest brake demand", "kN", 2;
        /// Greatest electric brake of MT pair 1, N.
        max_electric_pair1_n: f64 = "Greatest electric brake, MT pair 1", "kN", 2;
        /// Greatest air brake of the trailers of MT pair 1, N.
        max_air_t_pair1_n: f64 = "Greatest air on T cars, MT pair 1", "kN", 2;
        /// Greatest air brake of the motor cars of MT pair 1, N.
        max_air_m_pair1_n: f64 = "Greatest air on M cars, MT pair 1", "kN", 2;
        /// Electric brake's share of the work of the brakes.
        electric_share: Option<f64> = "Brake work by the electric brake", "%", 2;
        /// Air brake's.
        air_share: Option<f64> = "Brake work by air", "%", 2;
        /// Greatest deviation of the brakes from their demand outside transients, share of it, signed.
        max_deviation_share: Option<f64> = "Brake off its demand, outside transients", "%", 2;
        /// The same where the electric brake is whole. Below, a full train's cars brake by air as much as
        /// each can in service, so that nothing is left to make up for a brake that is cut out.
        max_deviation_electric_share: Option<f64> = "The same before the electric brake fades", "%", 2;
        /// When the deviation was greatest, s.
        max_deviation_t_s: Option<f64> = "Greatest of it at", "s", 2;
    }
}

impl Figures {
    /// Of a run.
    pub fn of(rows: &[Row], done: &[StepDone], plan: &Plan) -> Self {
        let most = |of: fn(&Row) -> f64| rows.iter().map(of).fold(0.0, f64::max);
        let moving = rows.iter().filter(|row| row.speed_kmh > 0.0);
        let work =
            |of: fn(&Row) -> f64| rows.iter().map(|row| of(row) * row.speed_kmh).sum::<f64>();
        let electric = work(|row| row.value(Signal::ElectricBrake));
        let air = work(|row| row.value(Signal::AirBrake));
        let share = |part: f64| (electric + air > 0.0).then(|| part / (electric + air));
        let deviation = steady_deviation(rows, done, 0.0);
        let fades_kmh = plan.train.electric_brake.fade_from_kmh;
        let electric_range = steady_deviation(rows, done, fades_kmh);
        let decel = band(rows, FULL_BRAKE, DECEL_FROM_KMH, DECEL_TO_KMH);
        Self {
            accel_0_35_kmh_s: from_rest(rows),
            accel_5_35_kmh_s: band(rows, FULL_POWER, ACCEL_FROM_KMH, ACCEL_TO_KMH)
                .map(|band| band.change_kmh_s),
            decel_60_20_kmh_s: decel.map(|band| band.change_kmh_s),
            brake_60_20_kmh_s: decel.map(|band| band.brake_n / plan.inertia_kg() * 3.6),
            peak_speed_kmh: most(|row| row.speed_kmh),
            peak_jerk_m_s3: moving
                .map(|row| row.value(Signal::TrainJerk).abs())
                .fold(0.0, f64::max),
            max_te_n: most(|row| row.value(Signal::Traction)),
            max_te_pair1_n: most(|row| row.pairs[0].traction_n),
            full_service_n: plan.full_service_n(),
            max_brake_demand_n: most(|row| row.value(Signal::BrakeDemand)),
            max_electric_pair1_n: most(|row| row.pairs[0].electric_n),
            max_air_t_pair1_n: most(|row| row.pairs[0].air_trailers_n),
            max_air_m_pair1_n: most(|row| row.pairs[0].air_motors_n),
            electric_share: share(electric),
            air_share: share(air),
            max_deviation_share: deviation.map(|(off, _)| off),
            max_deviation_electric_share: electric_range.map(|(off, _)| off),
            max_deviation_t_s: deviation.map(|(_, at_s)| at_s),
        }
    }
}

/// What TCMS orders.
fn order(row: &Row) -> f64 {
    row.value(Signal::TcmsValue)
}

/// Stretches in which TCMS orders the same.
fn stretches(rows: &[Row]) -> impl Iterator<Item = &[Row]> {
    rows.chunk_by(|a, b| order(a) == order(b))
}

/// Between two speeds.
#[derive(Clone, Copy, Debug)]
struct Band {
    /// Size of the mean change of speed, km/h/s.
    change_kmh_s: f64,
    /// Mean brake effort, N.
    brake_n: f64,
}

/// The first stretch in which TCMS orders `value` without a break and the train goes from one speed to
/// the other.
fn band(rows: &[Row], value: f64, from_kmh: f64, to_kmh: f64) -> Option<Band> {
    let up = from_kmh < to_kmh;
    let beyond = |row: &Row, kmh: f64| {
        if up {
            row.speed_kmh >= kmh
        } else {
            row.speed_kmh <= kmh
        }
    };
    for stretch in stretches(rows) {
        let ordered = order(&stretch[0]) == value;
        if !ordered || beyond(&stretch[0], from_kmh) {
            continue;
        }
        let begin = stretch.iter().position(|row| beyond(row, from_kmh));
        let end = stretch.iter().position(|row| beyond(row, to_kmh));
        if let (Some(begin), Some(end)) = (begin, end)
            && end > begin
        {
            let between = &stretch[begin..=end];
            let (first, last) = (&stretch[begin], &stretch[end]);
            let seconds = last.t_s - first.t_s;
            let effort_n: f64 = between.iter().map(Row::brake_n).sum();
            return Some(Band {
                change_kmh_s: (last.speed_kmh - first.speed_kmh).abs() / seconds,
                brake_n: effort_n / between.len() as f64,
            });
        }
    }
    None
}

/// Mean acceleration of a start at full power, from the last row at rest.
fn from_rest(rows: &[Row]) -> Option<f64> {
    let mut starts = stretches(rows).filter(|stretch| order(&stretch[0]) == FULL_POWER);
    starts.find_map(|stretch| {
        let rest = stretch.iter().rposition(|row| row.speed_kmh == 0.0)?;
        let there = stretch[rest..]
            .iter()
            .find(|row| row.speed_kmh >= ACCEL_TO_KMH)?;
        // On average the train leaves half a cycle after the last row that stands.
        let seconds = there.t_s - stretch[rest].t_s - 0.5 * CYCLE.as_secs();
        Some(there.speed_kmh / seconds)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::row::tests::row_at;

    /// 3 km/h/s for 25 s from 1 s on, 2 s of coasting, 3.5 km/h/s to standstill.
    fn trapezium() -> Vec<Row> {
        let row = |cycle: i32| {
            let t = f64::from(cycle) * 0.05;
            let (kmh, value) = match t {
                t if t < 1.0 => (0.0, FULL_POWER),
                t if t < 26.0 => (3.0 * (t - 1.0), FULL_POWER),
                t if t < 28.0 => (75.0, 0.0),
                t => ((75.0 - 3.5 * (t - 28.0)).max(0.0), FULL_BRAKE),
            };
            let (electric_n, air_n) = if value == FULL_BRAKE {
                (300e3, 100e3)
            } else {
                (0.0, 0.0)
            };
            let signals = [
                (Signal::TcmsValue, value),
                (Signal::ElectricBrake, electric_n),
                (Signal::AirBrake, air_n),
            ];
            row_at(t, kmh, &signals)
        };
        (0..1100).map(row).collect()
    }

    #[test]
    fn means_between_speeds_are_those_worked_out_by_hand() {
        let rows = trapezium();
        let near = |a: Option<f64>, b: f64| assert!((a.unwrap() - b).abs() < 0.02, "{a:?} {b}");
        near(from_rest(&rows), 3.0);
        near(
            band(&rows, FULL_POWER, 5.0, 35.0).map(|b| b.change_kmh_s),
            3.0,
        );
        let braking = band(&rows, FULL_BRAKE, 60.0, 20.0).unwrap();
        near(Some(braking.change_kmh_s), 3.5);
        assert!((braking.brake_n - 400e3).abs() < 1.0);
    }

    /// A notch in between ends the stretch, and a brake from 50 km/h has no 60.
    #[test]
    fn figures_that_a_run_does_not_show_are_none() {
        let mut rows = trapezium();
        rows[150].signals.sample.set(Signal::TcmsValue, 500.0);
        assert_eq!(from_rest(&rows), None);
        assert!(band(&rows, FULL_POWER, 5.0, 35.0).is_none());
        rows.retain(|row| order(row) == FULL_BRAKE && row.speed_kmh < 50.0);
        assert!(band(&rows, FULL_BRAKE, 60.0, 20.0).is_none());
        assert_eq!(from_rest(&[]), None);
    }
}
