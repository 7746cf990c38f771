//! Random quantities of the rig, drawn from the generator that it was given.

use protocol::Random;

/// Normally distributed with mean 0 and standard deviation 1.
pub fn normal(random: &mut Random) -> f64 {
    let (first, second) = (random.unit(), random.unit());
    standard_normal(first, second)
}

/// Time to the next event of a Poisson process of `per_s` events a second, s.
pub fn waiting_time_s(random: &mut Random, per_s: f64) -> f64 {
    -(1.0 - random.unit()).ln() / per_s
}

/// Box and Muller: a standard normal number of two uniform ones.
pub fn standard_normal(first: f64, second: f64) -> f64 {
    (-2.0 * (1.0 - first).ln()).sqrt() * (std::f64::consts::TAU * second).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waiting_times_have_the_right_mean() {
        let mut random = Random::new(1);
        let total: f64 = (0..10_000).map(|_| waiting_time_s(&mut random, 50.0)).sum();
        assert!((total - 200.0).abs() < 8.0, "{total}");
    }
}
