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
