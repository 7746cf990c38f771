//! TWC station data.

use btu_rig::stimulus::{OrderData, StationData, Stimulus};
use protocol::line::{Line, Section};
use protocol::message::{DoorSide, RunningMode, TrainOrder};

use super::StimulusPath;

/// TWC station data. The fixed speed keeps its number while it is switched off.
#[derive(Clone, Debug)]
pub struct StationForm {
    /// Data without the fixed speed.
    pub data: StationData,
    pub ordered: bool,
    /// The fixed speed, km/h.
    pub fixed_speed_kmh: u8,
    /// Destination station in train orders; 0 = none.
    pub destination: u16,
}

impl StationForm {
    /// Data for a train that waits at the start of the line's first section.
    pub fn new(line: &Line) -> Self {
        let none = StationData {
            route: 0,
            section: 0,
            station: 0,
            next_station: 0,
            loop_id: 0,
            fixed_speed_kmh: None,
            running_mode: RunningMode::Normal,
            door_side: DoorSide::None,
            departure: false,
            train_number: 0,
        };
        let first = line.sections.first();
        Self {
            data: first.map_or(none, StationData::at_departure),
            ordered: false,
            fixed_speed_kmh: 60,
            destination: 0,
        }
    }

    /// Fills in the data sent at the start of a section; orders and the door side stay.
    pub fn departing(&mut self, section: &Section) {
        let door_side = self.data.door_side;
        self.told(StationData {
            door_side,
            ..StationData::at_departure(section)
        });
    }

    /// Fills in the data sent at the end of a section; orders stay.
    pub fn arriving(&mut self, section: &Section, line: &Line) {
        let next = line.station_after(section);
        self.told(StationData::at_arrival(section, next));
    }

    fn told(&mut self, told: StationData) {
        self.data = StationData {
            running_mode: self.data.running_mode,
            departure: self.data.departure,
            train_number: self.data.train_number,
            ..told
        };
    }

    pub fn station(&self) -> StationData {
        StationData {
            fixed_speed_kmh: self.ordered.then_some(self.fixed_speed_kmh),
            ..self.data
        }
    }

    /// A train order beside the station data, for the same train and section.
    pub fn order(&self, order: TrainOrder, line: &Line) -> Stimulus {
        let section = line.section(self.data.section);
        let length_m = section.map_or(0.0, |section| section.length_m);
        Stimulus::Orders(Some(OrderData {
            destination: self.destination,
            train_number: self.data.train_number,
            ..OrderData::of_section(order, section, length_m)
        }))
    }

    /// Stimulus that sends the data, over the harness or the TEST board.
    pub fn send(&self, way: StimulusPath) -> Stimulus {
        match way {
            StimulusPath::Harness => Stimulus::Station(self.station()),
            StimulusPath::TestBoard => Stimulus::PtuTwc(self.station()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE8: &str = include_str!("../../../../../../scripts/lines/line8.toml");

    #[test]
    fn a_section_fills_in_its_departure_or_arrival_and_orders_stay() {
        let line = Line::from_toml(LINE8).expect("line");
        let section = line.section(61).expect("section 61");
        let mut form = StationForm::new(&line);
        form.data.departure = true;
        form.ordered = true;
        form.fixed_speed_kmh = 45;
        form.departing(section);
        let sent = form.station();
        assert_eq!(
            (sent.station, sent.next_station, sent.loop_id),
            (section.from_station, section.to_station, section.from_loop)
        );
        assert_eq!((sent.fixed_speed_kmh, sent.departure), (Some(45), true));
        form.arriving(section, &line);
        form.ordered = false;
        let sent = form.station();
        assert_eq!(
            (sent.station, sent.loop_id),
            (section.to_station, section.to_loop)
        );
        assert_eq!(sent.door_side.label(), section.door_side);
        assert_eq!(sent.fixed_speed_kmh, None);
        assert_eq!(form.send(StimulusPath::Harness), Stimulus::Station(sent));
        assert_eq!(form.send(StimulusPath::TestBoard), Stimulus::PtuTwc(sent));
    }

    #[test]
    fn an_order_is_for_the_section_and_train_of_the_data() {
        let line = Line::from_toml(LINE8).expect("line");
        let mut form = StationForm::new(&line);
        form.destination = 830;
        form.data.section = 61;
        form.data.train_number = 8002;
        let told = OrderData {
            section: 61,
            length_dm: 8500,
            destination: 830,
            order: TrainOrder::PutAway,
            train_number: 8002,
        };
        let order = form.order(TrainOrder::PutAway, &line);
        assert_eq!(order, Stimulus::Orders(Some(told)));
    }
}
