//! Which marker is believed.
//!
//! A marker is believed within a window around its place: some metres, and what wheels can be wrong by
//! since the last fix: a share of the way run, small once markers have calibrated them, and what
//! they are thought to have slid. A pulse outside its window
//! corrects nothing. Two such pulses in order, as far apart as their places, are believed
//! together: then not the markers were wrong but the position.

use protocol::config::MarkerConfig;
use protocol::line::Section;

/// A place at which the train is known to have been.
#[derive(Clone, Copy, Debug)]
pub struct Fix {
    /// Where, m from the section's start.
    pub place_m: f64,
    /// Way the odometer told there, m.
    pub way_m: f64,
    /// Marker that told it, 0 = the section's start.
    pub marker: u8,
}

/// A marker pulse and the way the odometer told when it came.
#[derive(Clone, Copy, Debug)]
pub struct Sighting {
    /// 1 to 4.
    pub marker: u8,
    /// m.
    pub way_m: f64,
}

/// How the way told is related to the way run since the last fix.
#[derive(Clone, Copy, Debug)]
pub struct Wheels {
    /// Way run for a way told.
    pub scale: f64,
    /// Share of the way run by which that may be wrong.
    pub doubt: f64,
    /// Way run on sliding wheels, m.
    pub slid_m: f64,
}

impl Wheels {
    /// Way run for a way told, m.
    pub fn run_m(&self, told_m: f64) -> f64 {
        told_m * self.scale + self.slid_m
    }
}

/// What is made of a sighting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Judgement {
    /// Its place is the train's position.
    Believed,
    /// Not its turn: one that has been passed, or one at another's place.
    OutOfOrder,
    /// Away from its place by this, m, position ahead positive.
    Away(f64),
}

/// How far from its place a marker is believed after `run_m` from a fix, m.
pub fn window_m(fix: &Fix, run_m: f64, wheels: &Wheels, config: &MarkerConfig) -> f64 {
    let least = if fix.marker == 0 {
        config.start_window_m
    } else {
        config.window_m
    };
    let share = config.window_share.min(wheels.doubt);
    least + share * libm::fabs(run_m) + wheels.slid_m
}

/// Judges a sighting; `doubtful` is the last sighting that was away from its place.
pub fn judge(
    section: &Section,
    fix: &Fix,
    sighting: Sighting,
    doubtful: Option<Sighting>,
    wheels: &Wheels,
    config: &MarkerConfig,
) -> Judgement {
    let Some(place_m) = place_m(section, sighting.marker) else {
        return Judgement::OutOfOrder;
    };
    let run_m = wheels.run_m(sighting.way_m - fix.way_m);
    let at_m = fix.place_m + run_m;
    let window_m = window_m(fix, run_m, wheels, config);
    let near = |place_m: f64| libm::fabs(at_m - place_m) <= window_m;
    if near(place_m) {
        return if sighting.marker > fix.marker {
            Judgement::Believed
        } else {
            Judgement::OutOfOrder
        };
    }
    if doubtful.is_some_and(|first| agree(section, first, sighting, wheels.scale, config)) {
        return Judgement::Believed;
    }
    if self::place_m(section, fix.marker + 1).is_some_and(near) {
        return Judgement::OutOfOrder;
    }
    Judgement::Away(at_m - place_m)
}

/// Two sightings in order and as far apart as their places.
fn agree(
    section: &Section,
    first: Sighting,
    second: Sighting,
    scale: f64,
    config: &MarkerConfig,
) -> bool {
    let places = place_m(section, first.marker).zip(place_m(section, second.marker));
    first.marker < second.marker
        && places.is_some_and(|(from_m, to_m)| {
            let apart_m = to_m - from_m;
            let run_m = (second.way_m - first.way_m) * scale;
            libm::fabs(run_m - apart_m) <= config.window_m + config.window_share * apart_m
        })
}

/// Where the track database has marker 1 to 4, m.
pub fn place_m(section: &Section, marker: u8) -> Option<f64> {
    let index = usize::from(marker).checked_sub(1)?;
    section.markers_m.get(index).copied()
}

#[cfg(test)]
mod tests {
    use protocol::config::UnitConfig;
    use protocol::line::Line;

    use super::*;

    /// After PSM2 of section 61 (741.53 m): marker, position by the wheel, what is made of it.
    #[test]
    fn a_marker_is_believed_near_its_place_and_in_its_turn() {
        let text = include_str!("../../../scripts/units/sg100.toml");
        let config = UnitConfig::from_toml(text).unwrap().marker;
        let line = include_str!("../../../scripts/lines/line8.toml");
        let line = Line::from_toml(line).unwrap();
        let section = line.section(61).unwrap();
        let [_, second, third, fourth] = section.markers_m;
        let fix = Fix {
            place_m: second,
            way_m: 0.0,
            marker: 2,
        };
        let at = |marker, position_m: f64| Sighting {
            marker,
            way_m: position_m - second,
        };
        let judged_with = |wheels, sighting| judge(section, &fix, sighting, None, &wheels, &config);
        let wheels = Wheels {
            scale: 1.0,
            doubt: 0.004,
            slid_m: 0.0,
        };
        let judged =
            |sighting, doubtful| judge(section, &fix, sighting, doubtful, &wheels, &config);
        assert_eq!(judged(at(3, third + 0.8), None), Judgement::Believed);
        // Wheels that nothing has calibrated can be wrong by more, and so can those that slid.
        let late = at(3, third + 2.0);
        assert_eq!(judged(late, None), Judgement::Away(2.0));
        let worn = Wheels {
            doubt: 0.03,
            ..wheels
        };
        assert_eq!(judged_with(worn, late), Judgement::Believed);
        let slid = Wheels {
            slid_m: 2.0,
            ..wheels
        };
        assert_eq!(judged_with(slid, at(3, third - 2.9)), Judgement::Believed);
        assert_eq!(judged(at(4, fourth - 0.8), None), Judgement::Believed);
        assert_eq!(judged(at(2, second + 0.5), None), Judgement::OutOfOrder);
        assert_eq!(judged(at(1, third), None), Judgement::OutOfOrder);
        let early = judged(at(4, fourth - 10.0), None);
        assert!(matches!(early, Judgement::Away(m) if (m + 10.0).abs() < 1e-9));
        // A train that slid 12 m: both markers seem early, by the same way.
        let slid = at(3, third - 12.0);
        assert!(matches!(judged(slid, None), Judgement::Away(_)));
        let next = at(4, fourth - 12.2);
        assert_eq!(judged(next, Some(slid)), Judgement::Believed);
    }
}
