//! Acts of the wayside: station data, departures, orders, or nothing.

use btu_rig::stimulus::{OrderData, StationData, Stimulus, WaysideCondition};
use protocol::message::{DoorSide, RunningMode, TrainOrder};

use super::plan::Draw;

impl Draw<'_> {
    /// Station data of this section or of any other of the track database.
    pub(super) fn station(&mut self, at_ms: u32) {
        let line = &self.setup.line.content;
        let other = self.chance(0.5);
        let section = match other {
            true => &line.sections[self.random.below(line.sections.len())],
            false => &line.sections[self.section],
        };
        let mut station = match self.random.chance(0.5) {
            true => StationData::at_departure(section),
            false => StationData::at_arrival(section, line.station_after(section)),
        };
        station.departure = self.chance(0.6);
        if self.chance(0.2) {
            station.door_side = self.one_of(&[
                DoorSide::None,
                DoorSide::Left,
                DoorSide::Right,
                DoorSide::Both,
            ]);
        }
        if self.chance(0.2) {
            station.running_mode = self.one_of(&[RunningMode::Slow, RunningMode::Recovery]);
        }
        self.station = station;
        self.at(at_ms, Stimulus::Station(station));
    }

    /// Given, withheld, or given twice.
    pub(super) fn departure(&mut self, at_ms: u32) {
        for (step, departure) in [(0, true), (1, false), (2, true)] {
            if self.chance(0.6) {
                let station = StationData {
                    departure,
                    ..self.station
                };
                self.at(at_ms + step * 900, Stimulus::Station(station));
            }
        }
    }

    pub(super) fn wayside(&mut self, at_ms: u32) {
        let condition = self.one_of(&[WaysideCondition::Silent, WaysideCondition::Corrupt]);
        self.at(at_ms, Stimulus::Wayside(condition));
        self.back(at_ms, Stimulus::Wayside(WaysideCondition::Good));
    }

    /// The wayside puts the train away, wakes it, turns it back, or orders nothing.
    pub(super) fn orders(&mut self, at_ms: u32) {
        let order = self.one_of(&[
            TrainOrder::PutAway,
            TrainOrder::WakeUp,
            TrainOrder::TurnBack,
            TrainOrder::None,
        ]);
        let orders = OrderData::of_section(order, None, 0.0);
        self.at(at_ms, Stimulus::Orders(Some(orders)));
    }
}
