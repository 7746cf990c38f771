//! Station data against the unit's track database [S2 §3.1].
//!
//! Data that contradict it are refused whole: one wrong number says that the rest cannot be trusted either.

use protocol::event::Event;
use protocol::line::{Line, Section};
use protocol::message::{DoorSide, TwcWayside};

use crate::guards::Guards;

/// Event, with its parameter, for data that contradict the track database.
pub fn contradiction(data: &TwcWayside, line: &Line, guards: Guards) -> Option<(Event, i32)> {
    let unknown = (Event::TwcStationInvalid, i32::from(data.station));
    let Some(section) = line.section(data.section) else {
        return Some(unknown);
    };
    let compared = guards.station;
    let checks = [
        (compared && !stands_in(data, section), unknown),
        (
            compared && !goes_to(data, line, section),
            (Event::TwcWrongNext, i32::from(data.next_station)),
        ),
        (
            guards.side && !has_platform(data, line, section),
            (Event::TwcWrongSide, i32::from(data.door_side.code())),
        ),
        (
            !data.running_mode.is_known(),
            (Event::TwcWrongMode, i32::from(data.running_mode.code())),
        ),
    ];
    let found = checks.iter().find(|(contradicts, _)| *contradicts);
    found.map(|(_, event)| *event)
}

/// Route, station and loop are those of the section's departure or arrival.
fn stands_in(data: &TwcWayside, section: &Section) -> bool {
    data.route == section.route && (departs(data, section) || arrives(data, section))
}

/// Station and loop are those of the section's departure.
pub fn departs(data: &TwcWayside, section: &Section) -> bool {
    data.station == section.from_station && data.loop_id == section.from_loop
}

fn arrives(data: &TwcWayside, section: &Section) -> bool {
    data.station == section.to_station && data.loop_id == section.to_loop
}

/// The next station is the section's end or, in data of the arrival there, the end of the section that follows. Behind
/// the line's last section the track database knows nothing.
fn goes_to(data: &TwcWayside, line: &Line, section: &Section) -> bool {
    if departs(data, section) {
        return data.next_station == section.to_station;
    }
    let after = line.after(section);
    after.is_none_or(|after| data.next_station == after.to_station)
}

/// Doors may open only where a platform is: that of the section's end, and at its departure also that of the station
/// the train stands in.
fn has_platform(data: &TwcWayside, line: &Line, section: &Section) -> bool {
    let platform = |section: &Section| DoorSide::from_label(&section.door_side);
    let arrived = departs(data, section)
        .then(|| line.before(section))
        .flatten()
        .and_then(platform);
    [platform(section), arrived]
        .into_iter()
        .flatten()
        .any(|platform| lies_within(data.door_side, platform))
}

fn lies_within(side: DoorSide, platform: DoorSide) -> bool {
    side == DoorSide::None || side == platform || side.is_known() && platform == DoorSide::Both
}

#[cfg(test)]
pub mod tests {
    use alloc::vec::Vec;

    use protocol::message::RunningMode;

    use super::*;
    use crate::for_tests::{line8, with};

    fn arrival(line: &Line, at: usize) -> TwcWayside {
        let section = &line.sections[at];
        let onward = line.sections.get(at + 1);
        TwcWayside {
            route: section.route,
            section: section.section,
            station: section.to_station,
            next_station: onward.map_or(section.to_station, |onward| onward.to_station),
            loop_id: section.to_loop,
            fixed_speed_kmh: u8::MAX,
            door_side: DoorSide::from_label(&section.door_side).unwrap(),
            ..TwcWayside::default()
        }
    }

    /// Data of the departure into a section, by its place in the line.
    pub fn departure(line: &Line, at: usize) -> TwcWayside {
        let section = &line.sections[at];
        TwcWayside {
            station: section.from_station,
            next_station: section.to_station,
            loop_id: section.from_loop,
            door_side: DoorSide::None,
            ..arrival(line, at)
        }
    }

    fn found(data: TwcWayside, line: &Line) -> Option<Event> {
        contradiction(&data, line, Guards::ALL).map(|(event, _)| event)
    }

    #[test]
    fn every_station_of_the_line_agrees_with_it() {
        let line = line8();
        for at in 0..line.sections.len() {
            assert_eq!(found(departure(line, at), line), None, "{at}");
            assert_eq!(found(arrival(line, at), line), None, "{at}");
        }
    }

    #[test]
    fn each_wrong_number_has_its_event() {
        let line = line8();
        let good = arrival(line, 0);
        for (data, event) in [
            (with(good, |it| it.station = 999), Event::TwcStationInvalid),
            (with(good, |it| it.section = 999), Event::TwcStationInvalid),
            (TwcWayside { route: 5, ..good }, Event::TwcStationInvalid),
            (
                with(good, |it| it.loop_id = good.loop_id + 1),
                Event::TwcStationInvalid,
            ),
            (with(good, |it| it.next_station = 999), Event::TwcWrongNext),
            (
                TwcWayside {
                    next_station: 999,
                    ..departure(line, 3)
                },
                Event::TwcWrongNext,
            ),
            (
                with(good, |it| it.running_mode = RunningMode::Unknown(3)),
                Event::TwcWrongMode,
            ),
        ] {
            assert_eq!(found(data, line), Some(event), "{data:?}");
        }
    }

    /// At a platform on one side no other side agrees; where a platform lies on both, each does.
    #[test]
    fn doors_may_open_where_a_platform_is() {
        let mut line = line8().clone();
        for (platform, allowed) in [
            ("left", [true, true, false, false, false]),
            ("right", [true, false, true, false, false]),
            ("both", [true, true, true, true, false]),
        ] {
            line.sections[0].door_side = platform.into();
            let agrees: Vec<_> = (0..5)
                .map(|side| {
                    let door_side = DoorSide::from_code(side);
                    let data = TwcWayside {
                        door_side,
                        ..arrival(&line, 0)
                    };
                    found(data, &line) != Some(Event::TwcWrongSide)
                })
                .collect();
            assert_eq!(agrees, allowed, "{platform}");
        }
    }
}
