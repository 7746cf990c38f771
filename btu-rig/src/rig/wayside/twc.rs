//! TWC wayside: sends station data through the loop and counts the train's answers.

use protocol::line::Section;
use protocol::link::Link;
use protocol::message::{Message, TwcWayside};
use protocol::{Duration, Instant, Random};

use crate::stimulus::{StationData, WaysideCondition};

use super::order_sender::OrderSender;

/// Period of the wayside's frames.
pub const PERIOD: Duration = Duration::from_ms(250);
/// Most bits flipped in a corrupt frame: so few that the check sequence finds each of them.
const MAX_FLIPS: usize = 3;
/// Value on the wire for no fixed speed.
const NO_FIXED_SPEED: u8 = 255;

/// The wayside equipment of one loop.
#[derive(Debug)]
pub struct Wayside {
    pub condition: WaysideCondition,
    pub data: StationData,
    pub orders: OrderSender,
    next_due: Instant,
    random: Random,
    frame: Vec<u8>,
    answers: u32,
}

impl Wayside {
    /// A wayside in good condition at a section's departure station.
    pub fn new(section: &Section, random: Random) -> Self {
        Self {
            condition: WaysideCondition::Good,
            data: StationData::at_departure(section),
            orders: OrderSender::default(),
            next_due: Instant::ZERO,
            random,
            frame: Vec::new(),
            answers: 0,
        }
    }

    /// Puts the wayside back into good condition at a section's departure station, without orders; due times and counts
    /// go on.
    pub fn reset(&mut self, section: &Section) {
        self.condition = WaysideCondition::Good;
        self.data = StationData::at_departure(section);
        self.orders.set(None);
    }

    /// Sends the frames that are due, if any, to the train of this number.
    pub fn step(&mut self, now: Instant, train: u16, link: &mut Link, out: &mut Vec<u8>) {
        if now < self.next_due {
            return;
        }
        self.next_due = now + PERIOD;
        if self.condition == WaysideCondition::Silent {
            return;
        }
        self.send(now, &wire_data(&self.data, train).into(), link, out);
        if let Some(orders) = self.orders.due(train) {
            self.send(now, &orders.into(), link, out);
        }
    }

    fn send(&mut self, now: Instant, message: &Message, link: &mut Link, out: &mut Vec<u8>) {
        if self.condition == WaysideCondition::Corrupt {
            self.frame.clear();
            link.send(now, message, &mut self.frame);
            self.corrupt();
            out.extend_from_slice(&self.frame);
        } else {
            link.send(now, message, out);
        }
    }

    /// Flips bits between the frame's two flags, so that its neighbours stay whole.
    fn corrupt(&mut self) {
        let inside = self.frame.len().saturating_sub(2);
        // Distinct bytes: two flips of the same bit would restore the frame.
        let flips = 1 + self.random.below(MAX_FLIPS);
        let first = self.random.below(inside);
        for i in 0..flips.min(inside) {
            let at = 1 + (first + i * (inside / MAX_FLIPS).max(1)) % inside;
            self.frame[at] ^= 1 << self.random.below(8);
        }
    }

    /// Counts one answer of the train; its content goes into the sample.
    pub fn on_answer(&mut self) {
        self.answers = self.answers.wrapping_add(1);
    }

    /// Answers received since the rig was made, as the catalogue counts them.
    pub fn answers(&self) -> u16 {
        self.answers as u16
    }
}

/// Station data as the wire carries them; `train` is the number of the train.
pub fn wire_data(data: &StationData, train: u16) -> TwcWayside {
    TwcWayside {
        route: data.route,
        section: data.section,
        station: data.station,
        next_station: data.next_station,
        loop_id: data.loop_id,
        fixed_speed_kmh: data.fixed_speed_kmh.unwrap_or(NO_FIXED_SPEED),
        running_mode: data.running_mode,
        door_side: data.door_side,
        departure: u8::from(data.departure),
        train_number: match data.train_number {
            0 => train,
            other => other,
        },
    }
}

#[cfg(test)]
mod tests {
    use protocol::line::Line;
    use protocol::link::End;
    use protocol::message::{Channel, KeepAlive};

    use super::*;

    /// Ten thousand corrupt frames between sound ones of another channel: none of the first gets
    /// through, none of the second is hurt.
    #[test]
    fn corrupt_frames_are_refused_and_spare_their_neighbours() {
        let line = Line::from_toml(include_str!("../../../../scripts/lines/line8.toml")).unwrap();
        let mut wayside = Wayside::new(&line.sections[0], Random::new(3));
        wayside.condition = WaysideCondition::Corrupt;
        let (mut bench, mut unit) = (Link::new(End::Bench), Link::new(End::Unit));
        let mut now = Instant::ZERO;
        for _ in 0..10_000 {
            let mut out = Vec::new();
            bench.send(now, &KeepAlive::default().into(), &mut out);
            wayside.step(now, 8001, &mut bench, &mut out);
            bench.send(now, &KeepAlive::default().into(), &mut out);
            unit.push(&out);
            while unit.poll(now).is_some() {}
            now += PERIOD;
        }
        assert_eq!(unit.counters().accepted(Channel::Twc), 0);
        assert_eq!(unit.counters().accepted(Channel::Ptu), 20_000);
        assert!(unit.counters().rejected_total() >= 10_000);
    }
}
