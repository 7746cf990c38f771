//! How the brake follows its demand: the transient after each step, and the deviation outside of it.

use protocol::signal::Signal;

use super::StepDone;
use crate::drive::Row;

/// Deviation of the brake from its demand that counts as none [2 %: required of blending].
pub const WITHIN: f64 = 0.02;
/// A step that disturbs the brake does so within this time, s.
const DISTURBS_WITHIN_S: f64 = 1.0;
/// Undisturbed for so long, the transient is over, s.
const QUIET_S: f64 = 0.5;
/// What belongs to a transient once the demand stands again, s.
pub const TRANSIENT_S: f64 = 1.0;
/// Change of the demand in a cycle that counts as one, share of the demand.
const MOVES: f64 = 1e-4;

/// How a step disturbed the brake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settled {
    /// Until the brake was within 2 % of its demand again, s; 0 = it never left.
    pub after_s: f64,
    /// Greatest deviation on the way, share of the demand, signed.
    pub worst: f64,
}

/// How the brake settled after a step at `t_s`, before the one at `until_s`; none when no brake was
/// demanded in that time, or it never settled.
pub fn settled(rows: &[Row], t_s: f64, until_s: f64) -> Option<Settled> {
    let first = rows.partition_point(|row| row.t_s <= t_s);
    let rows = &rows[first..rows.partition_point(|row| row.t_s < until_s)];
    let off = |row: &Row| row.deviation().unwrap_or(0.0);
    let braked = |row: &Row| row.t_s <= t_s + DISTURBS_WITHIN_S && row.deviation().is_some();
    if !rows.iter().any(braked) {
        return None;
    }
    let begins = rows
        .iter()
        .position(|row| row.t_s <= t_s + DISTURBS_WITHIN_S && off(row).abs() > WITHIN);
    let Some(begins) = begins else {
        return Some(Settled {
            after_s: 0.0,
            worst: 0.0,
        });
    };
    let end_s = rows.last().map_or(t_s, |row| row.t_s);
    for (at, row) in rows.iter().enumerate().skip(begins) {
        let quiet_s = row.t_s + QUIET_S;
        let mut next = rows[at..].iter().take_while(|later| later.t_s <= quiet_s);
        if quiet_s <= end_s && next.all(|later| off(later).abs() <= WITHIN) {
            let transient = rows[begins..at].iter().map(off);
            let worst = transient.fold(
                0.0,
                |worst: f64, off| if off.abs() > worst.abs() { off } else { worst },
            );
            return Some(Settled {
                after_s: row.t_s - t_s,
                worst,
            });
        }
    }
    None
}

/// Greatest deviation of the brake from its demand outside transients, and when: more than a second
/// after the last step and after the demand last moved, at speeds above `above_kmh`. None without such
/// a time.
pub fn steady_deviation(rows: &[Row], done: &[StepDone], above_kmh: f64) -> Option<(f64, f64)> {
    let mut moved_s = f64::NEG_INFINITY;
    let mut steps = done.iter().map(|done| done.t_s).peekable();
    let mut worst: Option<(f64, f64)> = None;
    let mut before_n = 0.0;
    for row in rows {
        while let Some(step_s) = steps.next_if(|step_s| *step_s <= row.t_s) {
            moved_s = step_s;
        }
        let demand_n = row.value(Signal::BrakeDemand);
        if (demand_n - before_n).abs() > MOVES * demand_n {
            moved_s = row.t_s;
        }
        before_n = demand_n;
        let steady = row.t_s > moved_s + TRANSIENT_S && row.speed_kmh > above_kmh;
        if let Some(off) = row.deviation().filter(|_| steady)
            && worst.is_none_or(|(most, _)| off.abs() > most.abs())
        {
            worst = Some((off, row.t_s));
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::row::tests::row_at;

    /// 10 s of braking with 100 kN demanded: the electric brake is lost from 2 s on and air is back
    /// at 2.6 s; from 8 s on 5 % are missing.
    fn braking() -> Vec<Row> {
        let row = |cycle: i32| {
            let t_s = f64::from(cycle) * 0.05;
            let air_n = match t_s {
                t if t < 2.0 => 40e3,
                t if t < 2.6 => 70e3,
                t if t < 8.0 => 101e3,
                _ => 95e3,
            };
            let signals = [
                (Signal::BrakeDemand, 100e3),
                (Signal::ElectricBrake, if t_s < 2.0 { 60e3 } else { 0.0 }),
                (Signal::AirBrake, air_n),
            ];
            row_at(t_s, 40.0, &signals)
        };
        (0..=200).map(row).collect()
    }

    #[test]
    fn a_transient_lasts_until_the_brake_is_back() {
        let rows = braking();
        let found = settled(&rows, 1.9, f64::INFINITY).unwrap();
        assert!((found.after_s - 0.7).abs() < 0.051, "{found:?}");
        assert!((found.worst + 0.3).abs() < 1e-9, "{found:?}");
        let calm = settled(&rows, 4.0, f64::INFINITY).unwrap();
        assert_eq!(calm.after_s, 0.0, "what comes 4 s later is none of it");
        assert_eq!(settled(&rows, 7.9, f64::INFINITY), None, "it stays off");
    }

    #[test]
    fn nothing_settles_where_nothing_brakes() {
        let mut rows = braking();
        for row in &mut rows {
            row.signals.sample.set(Signal::BrakeDemand, 0.0);
        }
        assert_eq!(settled(&rows, 1.9, f64::INFINITY), None);
        assert_eq!(steady_deviation(&rows, &[], 0.0), None);
    }

    /// The first second belongs to the demand's own appearance, the one from 1.9 s to the step.
    #[test]
    fn deviation_is_told_outside_of_transients() {
        let step = StepDone {
            line: 1,
            t_s: 1.9,
            x_m: 0.0,
            speed_kmh: 40.0,
            actions: Vec::new(),
        };
        let (off, at_s) = steady_deviation(&braking(), &[step], 0.0).unwrap();
        assert!((off + 0.05).abs() < 1e-9 && (at_s - 8.0).abs() < 0.051);
        let (off, _) = steady_deviation(&braking(), &[], 0.0).unwrap();
        assert!(
            (off + 0.3).abs() < 1e-9,
            "without the step it is a deviation: {off}"
        );
    }
}
