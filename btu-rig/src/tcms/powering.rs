//! Powering: from a share of full effort to the inverters' demands [S3 eq. 1-3].

use crate::train::{CarSet, PerCar};

use super::consist::Consist;

/// Demand on each inverter, N, for a share of full effort at a speed, m/s. Inverters `without` give nothing, and the
/// others give no more than their own share.
///
/// TE1 = TE_v·TE_s, TE2 = TE_w·TE1: load compensation for each MT pair, so that acceleration is the
/// same from empty to full.
pub fn powering(consist: &Consist, share: f64, speed_mps: f64, without: CarSet) -> PerCar {
    let share = share * pattern(consist, speed_mps);
    let mut demands = consist.power_n.map(|most_n| share * most_n);
    for car in without.iter() {
        demands[car] = 0.0;
    }
    demands
}

/// TE_v: traction available at a speed, share of the greatest.
pub fn pattern(consist: &Consist, speed_mps: f64) -> f64 {
    consist.data.traction.share_at(speed_mps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tcms::consist::line6;
    use crate::train::EffortAt;

    /// S3's TE_max, a quarter of it each, and half of it at twice the base speed; empty by the braking
    /// masses of each pair: TC1 and M1 76 269 of 116 269 kg, M2 and T1 71 934 of 111 934 kg.
    #[test]
    fn effort_goes_by_speed_and_load() {
        let full = line6(160_000.0);
        let sum = |n: &PerCar| n.iter().sum::<f64>();
        let at = |consist, kmh: f64| powering(consist, 1.0, kmh / 3.6, CarSet::NONE);
        assert!((sum(&at(&full, 40.0)) - 397_800.0).abs() < 1.0);
        assert!((sum(&at(&full, 80.0)) - 198_900.0).abs() < 1.0);
        assert!((sum(&powering(&full, 0.15, 0.0, CarSet::NONE)) - 59_670.0).abs() < 1.0);
        let empty = at(&line6(0.0), 0.0);
        assert!((empty[1] - 99_450.0 * 76_269.0 / 116_269.0).abs() < 2.0);
        assert!((empty[2] - 99_450.0 * 71_934.0 / 111_934.0).abs() < 2.0);
    }

    #[test]
    fn effort_goes_by_a_table_where_there_is_one() {
        let mut consist = line6(160_000.0);
        let efforts = [(0.0, 397_800.0), (30.0, 300_000.0), (60.0, 150_000.0)];
        let efforts = efforts.map(|(kmh, n)| EffortAt { kmh, n });
        consist.data.traction.efforts = Some(efforts.to_vec());
        for (kmh, n) in [
            (0.0, 397_800.0),
            (45.0, 225_000.0),
            (60.0, 150_000.0),
            (90.0, 100_000.0),
        ] {
            let found = 397_800.0 * pattern(&consist, kmh / 3.6);
            assert!((found - n).abs() < 1e-6, "{kmh} km/h: {found} N");
        }
    }

    #[test]
    fn inverters_that_are_out_leave_the_others_their_own() {
        let consist = line6(0.0);
        let all = powering(&consist, 0.5, 0.0, CarSet::NONE);
        let out = powering(&consist, 0.5, 0.0, CarSet::one(2));
        assert_eq!(out[2], 0.0);
        assert_eq!((out[1], out[5], out[6]), (all[1], all[5], all[6]));
    }
}
