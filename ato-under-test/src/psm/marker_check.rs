//! Plausibility of a marker: accepted within a window around its place, whose width is some metres and what
//! the wheels may have measured wrong since the last fix. A pulse outside its window corrects nothing. Two
//! such pulses in order, as far apart as their places, are accepted together: then the position was wrong and
//! not the markers. If one pulse alone comes early, by no more than
//! uncalibrated wheels of a wrong diameter explain, the train may be that much further ([`further_m`]).

use protocol::config::MarkerConfig;
use protocol::line::Section;

/// Share of the distance by which wheels may differ from the configured size for two detections still to agree
/// [default]: a wheel changed without telling the unit, with something to spare.
const WRONG_WHEEL: f64 = 0.15;
/// Distance for which a detection away from its place is remembered, m [default].
const REMEMBERED_M: f64 = 600.0;

/// A place at which the train is known to have been.
#[derive(Clone, Copy, Debug, Default)]
pub struct PositionFix {
    /// Where, m from the section's start.
    pub place_m: f64,
    /// Distance the odometer had there, m.
    pub distance_m: f64,
    /// Marker that gave it, 0 = the section's start.
    pub marker: u8,
}

/// A marker pulse and the odometer's distance at that moment.
#[derive(Clone, Copy, Debug)]
pub struct MarkerDetection {
    /// Number of the PSM, 1 to 4.
    pub marker: u8,
    /// Odometer's distance, m.
    pub distance_m: f64,
    /// Distance run on sliding wheels from the fix until then, m.
    pub slid_m: f64,
}

/// Relation between the odometer's distance and the distance run since the last fix.
#[derive(Clone, Copy, Debug)]
pub struct Wheels {
    /// Distance run over the odometer's.
    pub scale: f64,
    /// Share of the distance run by which `scale` may be wrong.
    pub uncertainty: f64,
    /// Distance run on sliding wheels, m.
    pub slid_m: f64,
}

impl Wheels {
    /// Distance run for a distance of the odometer, m.
    pub fn run_m(&self, odometer_m: f64) -> f64 {
        odometer_m * self.scale + self.slid_m
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MarkerCheck {
    /// The marker's place is the train's position.
    Accepted,
    /// The marker is out of turn: it has been passed, or lies at another marker's place.
    OutOfOrder,
    /// Distance of the marker from its place by the odometer, m; positive when it came late.
    Away(f64),
}

/// Distance from its place at which a marker is believed after `run_m` from a fix, m.
pub fn window_m(fix: &PositionFix, run_m: f64, wheels: &Wheels, config: &MarkerConfig) -> f64 {
    let least = if fix.marker == 0 {
        config.start_window_m
    } else {
        config.window_m
    };
    let share = config.window_share.min(wheels.uncertainty);
    least + share * libm::fabs(run_m) + wheels.slid_m
}

/// The detection that was away from its place before this one.
#[derive(Clone, Copy, Debug, Default)]
pub struct PendingDetection {
    /// `None`: since the fix no detection was away from its place.
    pub detection: Option<MarkerDetection>,
    /// A marker is overdue: even the fix may have been wrong.
    pub unsure: bool,
}

pub fn judge(
    section: &Section,
    fix: &PositionFix,
    detection: MarkerDetection,
    pending: PendingDetection,
    wheels: &Wheels,
    config: &MarkerConfig,
) -> MarkerCheck {
    let Some(place_m) = place_m(section, detection.marker) else {
        return MarkerCheck::OutOfOrder;
    };
    let run_m = wheels.run_m(detection.distance_m - fix.distance_m);
    let at_m = fix.place_m + run_m;
    let window_m = window_m(fix, run_m, wheels, config);
    let near = |place_m: f64| libm::fabs(at_m - place_m) <= window_m;
    if near(place_m) {
        return if detection.marker > fix.marker {
            MarkerCheck::Accepted
        } else {
            MarkerCheck::OutOfOrder
        };
    }
    let onward = detection.marker > fix.marker || pending.unsure;
    let agrees = |first| agree(section, first, detection, wheels, config);
    if onward && pending.detection.is_some_and(agrees) {
        return MarkerCheck::Accepted;
    }
    if self::place_m(section, fix.marker + 1).is_some_and(near) {
        return MarkerCheck::OutOfOrder;
    }
    MarkerCheck::Away(at_m - place_m)
}

/// Distance by which the train may be farther on than it seems after a detection `error_m` from its
/// place, m: wheels greater than configured hear every marker early. Calibrated wheels do not, and only
/// the next marker shows it.
pub fn further_m(
    fix: &PositionFix,
    detection: MarkerDetection,
    error_m: f64,
    wheels: &Wheels,
    config: &MarkerConfig,
) -> f64 {
    let run_m = wheels.run_m(detection.distance_m - fix.distance_m);
    let calibrated = wheels.uncertainty < config.window_share;
    let possible = detection.marker == fix.marker + 1 && -error_m <= WRONG_WHEEL * run_m;
    if possible && !calibrated {
        (-error_m).max(0.0)
    } else {
        0.0
    }
}

/// Whether two detections are in order and as far apart as their places.
fn agree(
    section: &Section,
    first: MarkerDetection,
    second: MarkerDetection,
    wheels: &Wheels,
    config: &MarkerConfig,
) -> bool {
    let places = place_m(section, first.marker).zip(place_m(section, second.marker));
    let odometer_m = second.distance_m - first.distance_m;
    let slid_m = second.slid_m - first.slid_m;
    first.marker < second.marker
        && libm::fabs(odometer_m) <= REMEMBERED_M
        && places.is_some_and(|(from_m, to_m)| {
            let apart_m = to_m - from_m;
            let run_m = odometer_m * wheels.scale + slid_m;
            libm::fabs(run_m - apart_m) <= config.window_m + WRONG_WHEEL * apart_m + slid_m
        })
}

/// Where the track database has marker 1 to 4, m.
pub fn place_m(section: &Section, marker: u8) -> Option<f64> {
    let index = usize::from(marker).checked_sub(1)?;
    section.markers_m.get(index).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::{line8, sg100, with};

    const WHEELS: Wheels = Wheels {
        scale: 1.0,
        uncertainty: 0.004,
        slid_m: 0.0,
    };

    /// Judgement of a marker after another was believed at a place, from which the way is counted.
    fn judged(
        section: &Section,
        (place_m, marker): (f64, u8),
        detection: MarkerDetection,
        pending: PendingDetection,
        wheels: Wheels,
    ) -> MarkerCheck {
        let fix = PositionFix {
            place_m,
            distance_m: 0.0,
            marker,
        };
        judge(section, &fix, detection, pending, &wheels, &sg100().marker)
    }

    fn heard(marker: u8, distance_m: f64) -> MarkerDetection {
        MarkerDetection {
            marker,
            distance_m,
            slid_m: 0.0,
        }
    }

    /// After PSM2 of section 61 (741.53 m): marker, position by the wheel, and how the marker is judged.
    #[test]
    fn a_marker_is_believed_near_its_place_and_in_its_turn() {
        let section = line8().section(61).unwrap();
        let [_, second, third, fourth] = section.markers_m;
        let at = |marker, position_m: f64| heard(marker, position_m - second);
        let judged_with = |wheels, detection| {
            let pending = PendingDetection::default();
            judged(section, (second, 2), detection, pending, wheels)
        };
        let judged = |detection, pending| {
            let pending = PendingDetection {
                detection: pending,
                unsure: false,
            };
            judged(section, (second, 2), detection, pending, WHEELS)
        };
        assert_eq!(judged(at(3, third + 0.8), None), MarkerCheck::Accepted);
        // Wheels that nothing has calibrated can be wrong by more, and so can those that slid.
        let late = at(3, third + 2.0);
        assert_eq!(judged(late, None), MarkerCheck::Away(2.0));
        let worn = with(WHEELS, |it| it.uncertainty = 0.03);
        assert_eq!(judged_with(worn, late), MarkerCheck::Accepted);
        let slid = with(WHEELS, |it| it.slid_m = 2.0);
        assert_eq!(judged_with(slid, at(3, third - 2.9)), MarkerCheck::Accepted);
        assert_eq!(judged(at(4, fourth - 0.8), None), MarkerCheck::Accepted);
        assert_eq!(judged(at(2, second + 0.5), None), MarkerCheck::OutOfOrder);
        assert_eq!(judged(at(1, third), None), MarkerCheck::OutOfOrder);
        let early = judged(at(4, fourth - 10.0), None);
        assert!(matches!(early, MarkerCheck::Away(m) if (m + 10.0).abs() < 1e-9));
        // A train that slid 12 m: both markers seem early, by the same distance.
        let slid = at(3, third - 12.0);
        assert!(matches!(judged(slid, None), MarkerCheck::Away(_)));
        let next = at(4, fourth - 12.2);
        assert_eq!(judged(next, Some(slid)), MarkerCheck::Accepted);
        // What slid between the two was run, too.
        let tells_less = MarkerDetection {
            slid_m: 8.0,
            ..at(4, fourth - 20.2)
        };
        assert_eq!(judged(tells_less, Some(slid)), MarkerCheck::Accepted);
        assert!(matches!(
            judged(at(4, fourth - 20.2), Some(slid)),
            MarkerCheck::Away(_)
        ));
    }

    /// PSM1 and PSM2 heard in order after PSM3 was believed, and PSM2 more than 600 m after PSM1.
    #[test]
    fn a_pair_takes_no_fix_back_and_is_not_remembered_for_ever() {
        let section = line8().section(61).unwrap();
        let judged = |section: &Section, believed: u8, unsure| {
            let [first, second, third, _] = section.markers_m;
            let pending = PendingDetection {
                detection: Some(heard(1, 40.0)),
                unsure,
            };
            let pair = heard(2, 40.0 + second - first);
            judged(section, (third, believed), pair, pending, WHEELS)
        };
        assert!(matches!(judged(section, 3, false), MarkerCheck::Away(_)));
        assert_eq!(judged(section, 3, true), MarkerCheck::Accepted);
        assert_eq!(judged(section, 1, false), MarkerCheck::Accepted);
        let mut long = section.clone();
        long.markers_m[0] -= 200.0;
        assert!(matches!(judged(&long, 1, false), MarkerCheck::Away(_)));
    }
}
