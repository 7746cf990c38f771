//! Wheel calibration: distance by pulses between two believed markers against the track database.
//!
//! One number is estimated, by how much the configured wheel is too small, with its variance: a span
//! tells the more the longer it is, because markers lie some centimetres off their places.

/// Share of the distance by which creep and short slips falsify any span, however long [default].
pub(super) const CREEP: f64 = 5e-4;
/// Share by which a wheel may change from one span to the next [default].
const WEAR: f64 = 1e-4;
/// Shortest span that tells anything, m [default].
const SHORTEST_M: f64 = 50.0;

/// Span by the track over span by the wheel, less 1; `None` for one so short that it tells nothing.
pub(super) fn share(track_m: f64, wheel_m: f64) -> Option<f64> {
    let tells = track_m >= SHORTEST_M && wheel_m >= SHORTEST_M / 2.0;
    tells.then(|| track_m / wheel_m - 1.0)
}

/// The estimate; kept until power goes.
#[derive(Clone, Copy, Debug)]
pub struct WheelCalibration {
    share: f64,
    variance: f64,
    scatter_m: f64,
    bound: f64,
}

impl WheelCalibration {
    /// A calibration that knows only that the wheel is within `spread` (1σ share) of the configured
    /// one; markers scatter by `scatter_m` (1σ) and the correction is kept within ±`bound`.
    pub fn new(spread: f64, scatter_m: f64, bound: f64) -> Self {
        Self {
            share: 0.0,
            variance: spread * spread,
            scatter_m,
            bound,
        }
    }

    /// The calibration of other wheels, of which nothing is known.
    pub fn of_other_wheels(&self, spread: f64) -> Self {
        Self::new(spread, self.scatter_m, self.bound)
    }

    /// Takes a span of `track_m` between two markers that the wheel measured as `wheel_m`.
    pub fn learn(&mut self, track_m: f64, wheel_m: f64) {
        let Some(measured) = share(track_m, wheel_m) else {
            return;
        };
        let places = core::f64::consts::SQRT_2 * self.scatter_m / track_m;
        let variance = places * places + CREEP * CREEP;
        self.variance += WEAR * WEAR;
        let gain = self.variance / (self.variance + variance);
        self.share += gain * (measured - self.share);
        self.variance *= 1.0 - gain;
    }

    /// Correction of the distance that the wheel tells, as a share; bounded.
    pub fn correction(&self) -> f64 {
        self.share.clamp(-self.bound, self.bound)
    }

    /// The difference found, when it is more than any wheel in service can have.
    pub fn impossible(&self) -> Option<f64> {
        (libm::fabs(self.share) > self.bound).then_some(self.share)
    }

    /// Share of the corrected distance by which it may still be wrong (2σ, and what the bound keeps back).
    pub fn uncertainty(&self) -> f64 {
        let kept_back = libm::fabs(self.share - self.correction());
        2.0 * (libm::sqrt(self.variance + CREEP * CREEP) + kept_back)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fresh() -> WheelCalibration {
        WheelCalibration::new(0.015, 0.05, 0.03)
    }

    #[test]
    fn one_long_span_tells_a_worn_wheel_and_a_short_one_hardly_moves_it() {
        let mut wheel = fresh();
        assert_eq!(wheel.correction(), 0.0);
        wheel.learn(437.5, 437.5 / 0.98);
        assert!((wheel.correction() + 0.02).abs() < 1e-4);
        assert!(wheel.uncertainty() < 0.002);
        // A marker 30 cm off its place at the end of the short span.
        wheel.learn(87.5, 87.8 / 0.98);
        assert!((wheel.correction() + 0.02).abs() < 1e-3);
        wheel.learn(17.5, 30.0);
        assert!((wheel.correction() + 0.02).abs() < 1e-3);
    }

    #[test]
    fn an_impossible_wheel_is_reported_and_corrected_to_the_bound_only() {
        let mut wheel = fresh();
        wheel.learn(437.5, 437.5 * 1.04);
        assert_eq!(wheel.correction(), -0.03);
        assert!(wheel.impossible().is_some_and(|share| share < -0.035));
    }
}
