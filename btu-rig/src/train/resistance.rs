//! Resistance to motion: starting, rolling, air, tunnel and curves.

use super::data::Resistance;
use super::{KGF_PER_T, PerCar};

/// Newtons of a kilogram-force.
const N_PER_KGF: f64 = 9.80665;

/// Running resistance of a train, and whether it is still starting.
#[derive(Clone, Debug)]
pub(super) struct RunningResistance {
    data: Resistance,
    constant_n: f64,
    linear_n_s_per_m: f64,
    square_n_s2_per_m2: f64,
    starting_n: f64,
    curve_n_m: f64,
    tunnel_n: f64,
    /// Bearings at rest take more to turn, until they have turned fast enough once.
    starting: bool,
}

impl RunningResistance {
    pub fn new(data: &Resistance) -> Self {
        Self {
            data: data.clone(),
            constant_n: 0.0,
            linear_n_s_per_m: 0.0,
            square_n_s2_per_m2: match &data.davis {
                Some(davis) => davis.c_n_per_kmh2 * 3.6 * 3.6,
                None => data.air_kgf_per_kmh2 * N_PER_KGF * 3.6 * 3.6,
            },
            starting_n: 0.0,
            curve_n_m: 0.0,
            tunnel_n: 0.0,
            starting: true,
        }
    }

    /// Takes the train's weight.
    pub fn weigh(&mut self, weight_kg: &PerCar) {
        let n_per_kgf_t = weight_kg.iter().sum::<f64>() * KGF_PER_T;
        let d = &self.data;
        self.tunnel_n = d.tunnel_kgf_t * n_per_kgf_t;
        (self.constant_n, self.linear_n_s_per_m) = match &d.davis {
            Some(davis) => (davis.a_n + self.tunnel_n, davis.b_n_per_kmh * 3.6),
            None => (
                (d.rolling_kgf_t + d.tunnel_kgf_t) * n_per_kgf_t,
                d.rolling_kgf_t_per_kmh * 3.6 * n_per_kgf_t,
            ),
        };
        self.starting_n = d.starting_kgf_t * n_per_kgf_t;
        self.curve_n_m = d.curve_kgf_m_t * n_per_kgf_t;
    }

    /// Resistance, N, at a speed (both never negative) of a train of which a share is in the open air.
    pub fn at(&mut self, speed_mps: f64, curvature_per_m: f64, open_air: f64) -> f64 {
        if speed_mps == 0.0 {
            self.starting = true;
        } else if speed_mps * 3.6 >= self.data.starting_kmh {
            self.starting = false;
        }
        let running_n = self.constant_n - self.tunnel_n * open_air
            + (self.linear_n_s_per_m + self.square_n_s2_per_m2 * speed_mps) * speed_mps;
        let least_n = if self.starting { self.starting_n } else { 0.0 };
        running_n.max(least_n) + self.curve_n_m * curvature_per_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::{CarsData, Davis, MAX_CARS};

    /// Worked by hand for 428.807 t at 40 km/h in the tunnel: (1.32 + 0.0164·40 + 2)·428.807 kgf
    /// and 0.0904·40² kgf are 1704.9 + 144.6 kgf = 18.14 kN; S3 has 19.024 kN.
    #[test]
    fn line_6_at_40_kmh_resists_nearly_as_printed() {
        let train = CarsData::line6();
        let mut resistance = RunningResistance::new(&train.resistance);
        let mut weights = [0.0; MAX_CARS];
        weights[0] = 428_807.0;
        resistance.weigh(&weights);
        let running = resistance.at(40.0 / 3.6, 0.0, 0.0);
        assert!((running - 18_137.0).abs() < 10.0, "{running}");
        // A curve of 350 m takes 2 kgf/t.
        let curve = resistance.at(40.0 / 3.6, 1.0 / 350.0, 0.0) - running;
        assert!((curve - 2.0 * 428_807.0 * KGF_PER_T).abs() < 0.1, "{curve}");
    }

    /// Worked by hand: Davis' formula at 50 km/h is 4000 + 20·50 + 2·50² N, whatever the train weighs; half of it in a tunnel
    /// of 2 kgf/t adds 2 · 9.80665 N for each of 50 t.
    #[test]
    fn davis_formula_is_taken_as_it_is_and_a_tunnel_counts_where_it_is() {
        let mut data = CarsData::line6().resistance;
        data.davis = Some(Davis {
            a_n: 4000.0,
            b_n_per_kmh: 20.0,
            c_n_per_kmh2: 2.0,
        });
        let mut resistance = RunningResistance::new(&data);
        let mut weights = [0.0; MAX_CARS];
        weights[0] = 100_000.0;
        resistance.weigh(&weights);
        let open_n = resistance.at(50.0 / 3.6, 0.0, 1.0);
        assert!((open_n - 10_000.0).abs() < 1e-6, "{open_n}");
        let half_n = resistance.at(50.0 / 3.6, 0.0, 0.5) - open_n;
        assert!((half_n - 2.0 * N_PER_KGF * 50.0).abs() < 1e-6, "{half_n}");
    }

    #[test]
    fn starting_takes_more_until_it_rolls_and_stopping_does_not() {
        let train = CarsData::line6();
        let mut resistance = RunningResistance::new(&train.resistance);
        resistance.weigh(&[1000.0; MAX_CARS]);
        let [rest, creeping, rolling, stopping] =
            [0.0, 0.5, 1.0, 0.5].map(|speed| resistance.at(speed, 0.0, 0.0));
        assert_eq!(rest, creeping);
        assert!(rolling < creeping && stopping < rolling);
    }
}
