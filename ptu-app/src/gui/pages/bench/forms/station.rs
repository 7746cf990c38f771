//! TWC station data.

use btu_rig::stimulus::{OrderData, StationData, Stimulus};
use protocol::line::{Line, Section};
use protocol::message::{DoorSide, RunningMode, TrainOrder};

use super::StimulusPath;

/// TWC station data. An ordered speed that is switched off keeps its number.
#[derive(Clone, Debug)]
pub struct StationForm {
    /// Data but for the fixed speed.
    pub data: StationData,
    pub ordered: bool,
    /// The fixed speed, km/h.
    pub fixed_speed_kmh: u8,
    /// Station at which the train's run ends, for orders beside; 0 = none.
    pub destination: u16,
}

impl StationForm {
    /// A train waiting at the start of the line's first section.
    pub fn new(line: &Line) -> Self {
        let mut form = Self {
            data: StationData {
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
            },
            ordered: false,
            fixed_speed_kmh: 60,
            destination: 0,
        };
        if let Some(section) = line.sections.first() {
            form.departing(section);
        }
        form
    }

    /// As the wayside tells a train at the start of a section; orders stay.
    pub fn departing(&mut self, section: &Section) {
        self.data.route = section.route;
        self.data.section = section.section;
        self.data.station = section.from_station;
        self.data.next_station = section.to_station;
        self.data.loop_id = section.from_loop;
    }

    /// As the wayside tells a train at the end of a section whose successor is `next`; orders stay.
    pub fn arriving(&mut self, section: &Section, next: Option<&Section>) {
        self.data.route = section.route;
        self.data.section = next.map_or(section.section, |next| next.section);
        self.data.station = section.to_station;
        self.data.next_station = next.map_or(section.to_station, |next| next.to_station);
        self.data.loop_id = section.to_loop;
        self.data.door_side = DoorSide::ALL
            .iter()
            .copied()
            .find(|side| side.label() == section.door_side)
            .unwrap_or(DoorSide::None);
    }

    pub fn station(&self) -> StationData {
        StationData {
            fixed_speed_kmh: self.ordered.then_some(self.fixed_speed_kmh),
            ..self.data
        }
    }

    /// An order beside the data, for their train and section.
    pub fn order(&self, order: TrainOrder, line: &Line) -> Stimulus {
        let section = line.section(self.data.section);
        Stimulus::Orders(Some(OrderData {
            section: section.map_or(0, |section| section.section),
            length_dm: section.map_or(0, |section| (section.length_m * 10.0).round() as u32),
            destination: self.destination,
            order,
            train_number: self.data.train_number,
        }))
    }

    /// Sent on the way chosen.
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
        let (at, section) = line
            .sections
            .iter()
            .enumerate()
            .find(|(_, section)| section.section == 61)
            .expect("section 61");
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
        let next = line.sections.get(at + 1);
        form.arriving(section, next);
        form.ordered = false;
        let sent = form.station();
        assert_eq!(
            (sent.station, sent.loop_id),
            (section.to_station, section.to_loop)
        );
        assert_eq!(sent.door_side.label(), section.door_side);
        assert_eq!(sent.fixed_speed_kmh, None);
        form.destination = 830;
        form.data.section = 61;
        let order = form.order(TrainOrder::PutAway, &line);
        let told = OrderData {
            section: 61,
            length_dm: 8500,
            destination: 830,
            order: TrainOrder::PutAway,
            train_number: 0,
        };
        assert_eq!(order, Stimulus::Orders(Some(told)));
        form.arriving(section, next);
        assert_eq!(form.send(StimulusPath::Harness), Stimulus::Station(sent));
        assert_eq!(form.send(StimulusPath::TestBoard), Stimulus::PtuTwc(sent));
    }
}
