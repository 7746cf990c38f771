//! Limits of the track database ahead: ATO slows for a lower speed code before its place, so that ATP, which hears
//! it there, finds nothing to brake (S2 §3.3: 55 to 45 km/h at 235 m, in a run that ATO drives).
//!
//! ATP's limit is that of the antenna alone, which is at the train's head: it cannot know where the tail is. What the
//! database has lowers the speed that ATO runs at, and only where the wayside sends what the database has: a lower limit
//! holds until the last car is past it.

use protocol::Speed;
use protocol::config::{SpeedCode, find_code};
use protocol::line::Section;

/// Where the train is, and what it hears there.
#[derive(Clone, Copy, Debug)]
pub struct TrainPosition<'a> {
    /// Section of the track database.
    pub section: Option<&'a Section>,
    /// Position in the section, m.
    pub position_m: f64,
    /// Way behind a code's place within which the code before may still be in force, m.
    pub heard_within_m: f64,
    /// Length of the train, m.
    pub length_m: f64,
    /// Limit in force.
    pub limit: Speed,
}

/// Limit that ATO runs by. `slowing_m` gives the way in which the train slows from the limit in force to another limit.
pub fn limit_ahead(
    place: TrainPosition<'_>,
    codes: &[SpeedCode],
    slowing_m: impl Fn(Speed) -> f64,
) -> Speed {
    let Some(section) = place.section else {
        return place.limit;
    };
    let limit_of = |name: &str| {
        let at = find_code(codes, name)?;
        Some(Speed::from_kmh(codes[at].line_kmh()))
    };
    let sent = || section.speed_codes.iter();
    let limit_at = |at_m: f64| {
        let last = sent().rev().find(|code| code.at_m <= at_m);
        limit_of(&last.or(sent().next())?.code)
    };
    let behind_m = place.position_m - place.heard_within_m;
    let as_sent = [place.position_m, behind_m].map(limit_at);
    if !as_sent.contains(&Some(place.limit)) {
        return place.limit;
    }
    let ahead = sent().filter_map(|code| {
        let lower = limit_of(&code.code).filter(|&limit| limit > Speed::ZERO)?;
        let to_m = code.at_m - place.position_m;
        let counts = lower < place.limit && to_m > 0.0 && to_m <= slowing_m(lower);
        counts.then_some(lower)
    });
    let here = limit_at(place.position_m).filter(|&limit| limit > Speed::ZERO);
    let tail_m = place.position_m - place.length_m;
    let under = sent().zip(sent().skip(1)).filter_map(|(code, next)| {
        let limit = limit_of(&code.code).filter(|&limit| limit > Speed::ZERO)?;
        (code.at_m <= place.position_m && next.at_m > tail_m).then_some(limit)
    });
    ahead.chain(here).chain(under).fold(place.limit, Speed::min)
}

#[cfg(test)]
mod tests {
    use protocol::line::Line;

    use super::*;
    use crate::for_tests::{line8, sg100};

    /// Limit, km/h, at a place of S2's section under a limit in force, km/h, by a train that slows within 60 m.
    fn at(position_m: f64, limit_kmh: f64) -> f64 {
        let line6 = Line::from_toml(include_str!("../../../scripts/lines/line6.toml"));
        of(&line6.unwrap(), 22, position_m, limit_kmh)
    }

    fn of(line: &Line, section: u16, position_m: f64, limit_kmh: f64) -> f64 {
        let place = TrainPosition {
            section: line.section(section),
            length_m: 160.0,
            position_m,
            heard_within_m: 15.0,
            limit: Speed::from_kmh(limit_kmh),
        };
        limit_ahead(place, &sg100().codes, |_| 60.0).kmh()
    }

    /// 55 km/h up to 235 m and 45 from there, as printed [S2 §3.3].
    #[test]
    fn the_lower_limit_counts_from_where_slowing_begins() {
        for (position_m, expected_kmh) in [(0.0, 55.0), (174.0, 55.0), (176.0, 45.0), (234.0, 45.0)]
        {
            assert!(
                (at(position_m, 55.0) - expected_kmh).abs() < 1e-9,
                "{position_m}"
            );
        }
    }

    /// A lower code counts behind its place until the receiver must have heard it: 15 m. A wayside
    /// that still sends 55 there has its reason.
    #[test]
    fn behind_its_place_it_counts_until_the_code_must_have_been_heard() {
        assert!((at(245.0, 55.0) - 45.0).abs() < 1e-9);
        assert!((at(251.0, 55.0) - 55.0).abs() < 1e-9);
    }

    /// 55 km/h up to 500 m and 65 from there, on section 56 of line 8, for a train of 160 m.
    #[test]
    fn a_higher_limit_counts_when_the_last_car_is_past_the_lower_one() {
        for (position_m, expected_kmh) in [(510.0, 55.0), (659.0, 55.0), (661.0, 65.0)] {
            let limit_kmh = of(line8(), 56, position_m, 65.0);
            assert!((limit_kmh - expected_kmh).abs() < 1e-9, "{position_m}");
        }
    }

    #[test]
    fn the_limit_in_force_stays_where_the_wayside_sends_another_one() {
        for limit_kmh in [65.0, 35.0, 25.0, 0.0] {
            assert!(
                (at(200.0, limit_kmh) - limit_kmh).abs() < 1e-9,
                "{limit_kmh}"
            );
        }
        assert!((at(f64::NAN, 55.0) - 55.0).abs() < 1e-9);
    }
}
