//! Positions of markers, stop point and train on the track strip, as fractions of its length.

use btu_rig::stimulus::StationData;
use protocol::line::{Line, Section};
use protocol::signal::Signal;

use super::live_copy::BenchSnapshot;

/// Length shown before the start and after the end of the section, m.
const AROUND_M: f64 = 60.0;

/// The section on the track strip; positions are fractions of the strip, 0 to 1.
#[derive(Debug, PartialEq)]
pub struct Strip {
    pub section: u16,
    /// Stations at which the section begins and ends.
    pub stations: (u16, u16),
    pub start: f32,
    /// PSM1 to PSM4.
    pub markers: [f32; 4],
    pub stop: f32,
    /// The train, if the section lies along its way.
    pub train: Option<f32>,
    /// Position of the train according to the unit.
    pub unit: Option<f32>,
    /// True distance to the stop point, m.
    pub to_stop_m: Option<f64>,
    /// Marker that the unit detected last, 1 to 4.
    pub detected: Option<u8>,
}

impl Strip {
    /// Track strip of the section laid by hand, or else of the section that the wayside's frames tell.
    pub fn of(line: &Line, laid: Option<u16>, seen: &BenchSnapshot) -> Option<Self> {
        let by_hand = laid.and_then(|number| line.section(number));
        let section = by_hand.or_else(|| section_of_wayside(line, seen))?;
        let share = |at_m: f64| {
            let whole_m = section.length_m + 2.0 * AROUND_M;
            (((at_m + AROUND_M) / whole_m) as f32).clamp(0.0, 1.0)
        };
        let to_stop_m = seen.value(Signal::ToStop);
        let detected = seen.value(Signal::Marker).filter(|psm| *psm >= 1.0);
        Some(Self {
            section: section.section,
            stations: (section.from_station, section.to_station),
            start: share(section.start_m),
            markers: section.markers_m.map(share),
            stop: share(section.stop_m),
            train: to_stop_m.map(|left_m| share(section.stop_m - left_m)),
            unit: seen.value(Signal::Position).map(share),
            to_stop_m,
            detected: detected.map(|psm| psm as u8),
        })
    }
}

/// The section that begins or ends at the loop named in the wayside's frames.
fn section_of_wayside<'a>(line: &'a Line, seen: &BenchSnapshot) -> Option<&'a Section> {
    let number = |signal| seen.value(signal).map(|value| value as u16);
    let loop_id = number(Signal::WaysideLoop)?;
    let station = number(Signal::WaysideStation)?;
    let ends = |(at_station, at_loop)| at_station == station && at_loop == loop_id;
    let sections = &line.sections;
    let departing = sections
        .iter()
        .find(|s| ends((s.from_station, s.from_loop)));
    departing.or_else(|| sections.iter().find(|s| ends((s.to_station, s.to_loop))))
}

/// Fields of the wayside's frame that no signal shows: from the stimulus given by hand, as long as the wayside still
/// sends it, else from the line.
#[derive(Debug, Default, PartialEq)]
pub struct WaysideFrame {
    pub next_station: Option<u16>,
    /// Ordered speed; the inner none = no order.
    pub fixed_speed_kmh: Option<Option<u8>>,
    pub train_number: Option<u16>,
}

impl WaysideFrame {
    pub fn of(line: &Line, given: Option<&StationData>, seen: &BenchSnapshot) -> Self {
        let still = given.filter(|data| {
            seen.is(Signal::WaysideStation, f64::from(data.station))
                && seen.is(Signal::WaysideLoop, f64::from(data.loop_id))
                && seen.is(Signal::WaysideMode, f64::from(data.running_mode.code()))
                && seen.is(Signal::WaysideDoorSide, f64::from(data.door_side.code()))
                && seen.on(Signal::Departure) == Some(data.departure)
        });
        match still {
            Some(data) => Self {
                next_station: Some(data.next_station),
                fixed_speed_kmh: Some(data.fixed_speed_kmh),
                train_number: Some(data.train_number),
            },
            None => Self {
                next_station: section_of_wayside(line, seen).map(|section| section.to_station),
                ..Self::default()
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use protocol::message::{DoorSide, RunningMode};

    use super::*;

    const LINE8: &str = include_str!("../../../../../scripts/lines/line8.toml");

    fn seen(values: &[(Signal, f64)]) -> BenchSnapshot {
        let mut seen = BenchSnapshot::default();
        for (signal, value) in values {
            seen.sample.set(*signal, *value);
        }
        seen
    }

    #[test]
    fn the_strip_shows_the_chosen_section_and_the_train_before_its_stop_point() {
        let line = Line::from_toml(LINE8).expect("line");
        let strip = Strip::of(&line, Some(61), &seen(&[(Signal::ToStop, 546.0)])).expect("strip");
        assert_eq!(strip.section, 61);
        // PSM1 stands 546 m before the stop point of section 61 [S0].
        let train = strip.train.expect("train");
        assert!((train - strip.markers[0]).abs() < 1e-6);
        let order: Vec<_> = [strip.start]
            .into_iter()
            .chain(strip.markers)
            .chain([strip.stop, 1.0])
            .collect();
        assert!(order.is_sorted() && order[0] > 0.0, "{order:?}");
        assert_eq!((strip.unit, strip.detected), (None, None));
    }

    #[test]
    fn without_a_chosen_section_the_wayside_data_give_it() {
        let line = Line::from_toml(LINE8).expect("line");
        let section = line.section(58).expect("section 58");
        let wayside = [
            (Signal::WaysideStation, f64::from(section.from_station)),
            (Signal::WaysideLoop, f64::from(section.from_loop)),
            (Signal::Marker, 2.0),
        ];
        let strip = Strip::of(&line, None, &seen(&wayside)).expect("strip");
        assert_eq!((strip.section, strip.detected), (58, Some(2)));
        assert_eq!(Strip::of(&line, None, &BenchSnapshot::default()), None);
    }

    #[test]
    fn what_was_given_by_hand_is_shown_while_the_wayside_still_sends_it() {
        let line = Line::from_toml(LINE8).expect("line");
        let section = &line.sections[0];
        let given = StationData {
            route: section.route,
            section: section.section,
            station: section.from_station,
            next_station: 900,
            loop_id: section.from_loop,
            fixed_speed_kmh: Some(45),
            running_mode: RunningMode::Normal,
            door_side: DoorSide::None,
            departure: true,
            train_number: 8123,
        };
        let mut wayside = vec![
            (Signal::WaysideStation, f64::from(section.from_station)),
            (Signal::WaysideLoop, f64::from(section.from_loop)),
            (Signal::WaysideMode, 0.0),
            (Signal::WaysideDoorSide, 0.0),
            (Signal::Departure, 1.0),
        ];
        let sent = WaysideFrame::of(&line, Some(&given), &seen(&wayside));
        assert_eq!(sent.fixed_speed_kmh, Some(Some(45)));
        assert_eq!(sent.next_station, Some(900));
        wayside[4].1 = 0.0;
        let sent = WaysideFrame::of(&line, Some(&given), &seen(&wayside));
        assert_eq!(sent.fixed_speed_kmh, None);
        assert_eq!(sent.next_station, Some(section.to_station));
    }
}
