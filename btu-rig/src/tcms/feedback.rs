//! Speed, motor current and effort of the train, from the equipment's reports.

use crate::train::{Equipment, PerCar};

use super::controller::{FULL_BRAKE, FULL_POWER};
use super::data::TcmsData;
use super::effort::Effort;
use super::inputs::TcmsInputs;
use super::speed::train_speed;

/// Speed, m/s, never negative: mean of the inverters' axles (S3), or of the generators' wheels. Not-a-number counts as
/// standstill, and so does a train whose inverters are all silent: a brake that lasts then becomes the holding brake,
/// at whatever speed, which is the safe side.
pub(super) fn speed_mps(
    inputs: &TcmsInputs<'_>,
    effort: Option<&Effort>,
    powering: bool,
    data: &TcmsData,
) -> f64 {
    let speed_mps = match (inputs.equipment, effort) {
        (Some(equipment), Some(effort)) => train_speed(
            &equipment.axle_mps,
            effort.consist.motors.without(equipment.inverters_silent),
            powering,
            data.slip_kmh / 3.6,
        ),
        (Some(equipment), None) => equipment.axle_mps[0],
        (None, _) => inputs.speed_mps,
    };
    if speed_mps.is_finite() {
        speed_mps.max(0.0)
    } else {
        0.0
    }
}

/// Greatest traction of any motor car, share of the greatest it can give: what S4 takes from the
/// motors' current. Without reports the order counts as followed; a report that is not a number counts as no traction,
/// and releases no holding brake.
pub(super) fn traction(
    equipment: Option<&Equipment>,
    effort: Option<&Effort>,
    ordered: i16,
) -> f64 {
    match (equipment, effort) {
        (Some(equipment), Some(effort)) => {
            let most_n = equipment
                .traction_n
                .iter()
                .filter(|n| n.is_finite())
                .fold(0.0, |most: f64, of| most.max(*of));
            most_n / effort.consist.traction_n()
        }
        _ => f64::from(ordered) / f64::from(FULL_POWER),
    }
}

/// Effort that the train gives, as reported to the unit, −1024..1023, of the effort available at this speed and load.
pub(super) fn given(
    equipment: Option<&Equipment>,
    effort: Option<&Effort>,
    speed_mps: f64,
    ordered: f64,
) -> i16 {
    let (Some(equipment), Some(effort)) = (equipment, effort) else {
        return value(ordered);
    };
    let brake_n = sum(&equipment.electric_n) + sum(&equipment.air_n);
    let mut share = -brake_n / sum(&effort.consist.full_service_n);
    let traction_n = sum(&equipment.traction_n);
    // Mostly a train either powers or brakes, and the traction that it could give takes time to compute.
    if traction_n > 0.0 {
        share += traction_n / effort.power_n(speed_mps);
    }
    value(share)
}

/// Sum over the cars. In four lanes, which do not wait for each other: this runs every scan.
fn sum(of: &PerCar) -> f64 {
    let mut lanes = [0.0; 4];
    for four in of.chunks_exact(4) {
        for (lane, n) in lanes.iter_mut().zip(four) {
            *lane += n;
        }
    }
    lanes.iter().sum()
}

fn value(share: f64) -> i16 {
    let (low, high) = (f64::from(FULL_BRAKE), f64::from(FULL_POWER));
    let scale = if share < 0.0 { -low } else { high };
    (share * scale).round().clamp(low, high) as i16
}

#[cfg(test)]
mod tests {
    use super::super::consist::Consist;
    use super::*;
    use crate::train::{CarsData, MAX_CARS};

    #[test]
    fn traction_that_is_no_number_pulls_nothing() {
        let data = CarsData::line6();
        let effort = Effort::new(Consist::new(&data));
        let mut equipment = Equipment::default();
        for report_n in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            equipment.traction_n = [report_n; MAX_CARS];
            assert_eq!(traction(Some(&equipment), Some(&effort), 0), 0.0);
        }
        equipment.traction_n[2] = effort.consist.traction_n();
        assert_eq!(traction(Some(&equipment), Some(&effort), 0), 1.0);
    }

    #[test]
    fn a_sum_leaves_no_car_out() {
        let each: PerCar = std::array::from_fn(|car| f64::from(1 << car));
        assert_eq!(sum(&each), f64::from((1 << MAX_CARS) - 1));
    }

    #[test]
    fn effort_is_told_on_the_wires_scale() {
        for (share, told) in [
            (1.0, 1023),
            (0.5, 512),
            (0.0, 0),
            (-0.5, -512),
            (-1.0, -1024),
            (-1.3, -1024),
            (7.0, 1023),
            (f64::NAN, 0),
        ] {
            assert_eq!(value(share), told, "{share}");
        }
    }
}
