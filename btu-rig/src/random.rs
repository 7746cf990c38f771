//! The rig's only random generator, seeded once and handed down.

/// SplitMix64 (Steele, Lea and Flood 2014): small, and good enough to scatter pulses and bit errors.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// A generator whose whole sequence follows from `seed`.
    pub const fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// A generator for one part, independent of how often other parts draw.
    pub fn fork(&mut self) -> Self {
        Self::new(self.next_u64())
    }

    /// The next 64 bits.
    pub fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in 0.0 .. 1.0, never 1.
    pub fn unit(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in 0 .. `end`; 0 when `end` is 0.
    pub fn below(&mut self, end: usize) -> usize {
        // The product's high half is uniform enough for ends far below 2^64.
        ((u128::from(self.next_u64()) * end as u128) >> 64) as usize
    }

    /// Normally distributed with mean 0 and standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        let (first, second) = (self.unit(), self.unit());
        standard_normal(first, second)
    }

    /// Time to the next event of a Poisson process of `per_s` events a second, s.
    pub fn waiting_time_s(&mut self, per_s: f64) -> f64 {
        -(1.0 - self.unit()).ln() / per_s
    }
}

/// Box and Muller: a standard normal number of two uniform ones.
pub fn standard_normal(first: f64, second: f64) -> f64 {
    (-2.0 * (1.0 - first).ln()).sqrt() * (std::f64::consts::TAU * second).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reference values of SplitMix64 for seed 1234567, as published with the algorithm.
    #[test]
    fn sequence_is_that_of_splitmix64() {
        let mut random = Random::new(1_234_567);
        let expected = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
        ];
        assert_eq!(expected.map(|_| random.next_u64()), expected);
    }

    #[test]
    fn waiting_times_have_the_right_mean() {
        let mut random = Random::new(1);
        let total: f64 = (0..10_000).map(|_| random.waiting_time_s(50.0)).sum();
        assert!((total - 200.0).abs() < 8.0, "{total}");
    }
}
