//! Speed as TCMS sees it: the mean of the inverters' axles, less those that slip or slide (S3).

use crate::train::{CarSet, PerCar};

/// Mean speed, m/s, of the motor cars `of`. While powering an axle faster than the slowest by more than
/// `slip_mps` slips and is left out; while braking one slower than the fastest by as much slides. 0
/// without any car.
pub fn train_speed(axle_mps: &PerCar, of: CarSet, powering: bool, slip_mps: f64) -> f64 {
    let speeds = || of.iter().map(|car| axle_mps[car]);
    let reference = if powering {
        speeds().fold(f64::INFINITY, f64::min)
    } else {
        speeds().fold(0.0, f64::max)
    };
    let (mut sum, mut count) = (0.0, 0.0);
    for speed in speeds().filter(|speed| (speed - reference).abs() <= slip_mps) {
        sum += speed;
        count += 1.0;
    }
    if count > 0.0 { sum / count } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::MAX_CARS;

    /// The four inverters of line 6: cars 2, 3, 6 and 7.
    fn inverters() -> CarSet {
        [1, 2, 5, 6]
            .into_iter()
            .fold(CarSet::NONE, |set, car| set.with(CarSet::one(car)))
    }

    fn mean(of: [f64; 4], powering: bool) -> f64 {
        // Trailers do not count, whatever they report.
        let mut axles = [99.0; MAX_CARS];
        for (car, speed) in inverters().iter().zip(of) {
            axles[car] = speed;
        }
        train_speed(&axles, inverters(), powering, 5.0 / 3.6)
    }

    #[test]
    fn all_four_count_while_they_roll() {
        for powering in [true, false] {
            let speed = mean([10.0, 10.1, 9.9, 10.4], powering);
            assert!((speed - 10.1).abs() < 1e-12, "{speed}");
        }
    }

    /// One slips, three slip: the slowest is the train's. One slides, three slide: the fastest is.
    #[test]
    fn slip_and_slide_are_left_out() {
        assert_eq!(mean([10.0, 14.0, 10.0, 10.0], true), 10.0);
        assert_eq!(mean([14.0, 14.0, 10.0, 15.0], true), 10.0);
        assert_eq!(mean([10.0, 6.0, 10.0, 10.0], false), 10.0);
        assert_eq!(mean([0.0, 6.0, 10.0, 0.0], false), 10.0);
        // A wheel that stands while powering is what is left to trust.
        assert_eq!(mean([0.0, 10.0, 10.0, 10.0], true), 0.0);
    }

    #[test]
    fn without_inverters_there_is_no_speed() {
        assert_eq!(train_speed(&[9.0; MAX_CARS], CarSet::NONE, true, 1.0), 0.0);
        assert_eq!(train_speed(&[9.0; MAX_CARS], CarSet::NONE, false, 1.0), 0.0);
    }
}
