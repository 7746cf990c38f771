//! TWC: station and train data through the loop [S2 §2.1].

use protocol::event::Event;
use protocol::line::{Line, Section};
use protocol::message::{Mode, TwcTrain, TwcTrainBits, TwcWayside};
use protocol::{Duration, Instant, Speed};

use crate::kernel::EventLog;

#[derive(Clone, Copy, Debug, Default)]
pub struct TrainState {
    pub mode: Mode,
    pub doors_closed: bool,
    pub aligned: bool,
    pub standstill: bool,
    pub speed: Speed,
}

/// Who sent station data into the TWC antenna and hears the answer, with the sequence number of its frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StationSender {
    Loop(u16),
    TestModem(u16),
}

impl StationSender {
    fn seq(self) -> u16 {
        match self {
            Self::Loop(seq) | Self::TestModem(seq) => seq,
        }
    }

    pub fn is_test(self) -> bool {
        matches!(self, Self::TestModem(_))
    }
}

#[derive(Clone, Debug)]
pub struct Twc {
    timeout: Duration,
    heard: Option<Instant>,
    up: bool,
    data: Option<TwcWayside>,
    valid: bool,
    invalid_reported: Option<u16>,
    received: u16,
    answers: u16,
}

impl Twc {
    /// Communication counts as lost after `timeout` of silence.
    pub fn new(timeout: Duration) -> Self {
        Self {
            timeout,
            heard: None,
            up: false,
            data: None,
            valid: false,
            invalid_reported: None,
            received: 0,
            answers: 0,
        }
    }

    /// Takes station data and checks them against the track database.
    pub fn take(&mut self, now: Instant, data: TwcWayside, line: &Line, log: &mut EventLog) {
        self.received = self.received.wrapping_add(1);
        if !self.up && self.heard.is_some() {
            log.push(now, Event::TwcRestored, 0);
        }
        self.heard = Some(now);
        self.up = true;
        self.valid = line
            .section(data.section)
            .is_some_and(|section| agrees(&data, section));
        if self.valid {
            self.invalid_reported = None;
        } else if self.invalid_reported != Some(data.station) {
            self.invalid_reported = Some(data.station);
            log.push(now, Event::TwcStationInvalid, i32::from(data.station));
        }
        self.data = Some(data);
    }

    pub fn step(&mut self, now: Instant, log: &mut EventLog) {
        if self.up
            && self
                .heard
                .is_some_and(|heard| now.since(heard) >= self.timeout)
        {
            self.up = false;
            self.valid = false;
            self.data = None;
            log.push(now, Event::TwcLost, 0);
        }
    }

    /// The modem is used for a test: what was received counts no more, and its end is no loss.
    pub fn forget(&mut self) {
        self.heard = None;
        self.up = false;
        self.valid = false;
        self.data = None;
    }

    /// The answer to a frame of `sender`.
    pub fn answer(
        &mut self,
        sender: StationSender,
        data: &TwcWayside,
        train: TrainState,
    ) -> TwcTrain {
        if !sender.is_test() {
            self.answers = self.answers.wrapping_add(1);
        }
        let mut bits = TwcTrainBits::empty();
        bits.set(TwcTrainBits::DOORS_CLOSED, train.doors_closed);
        bits.set(TwcTrainBits::ALIGNED, train.aligned);
        bits.set(TwcTrainBits::STATION_VALID, self.valid);
        bits.set(TwcTrainBits::STANDSTILL, train.standstill);
        TwcTrain {
            answered_seq: sender.seq(),
            station: data.station,
            train_number: data.train_number,
            mode: train.mode,
            bits,
            speed_cms: train.speed.to_cms(),
        }
    }

    pub fn up(&self) -> bool {
        self.up
    }

    /// The station data match the track database.
    pub fn valid(&self) -> bool {
        self.valid
    }

    pub fn data(&self) -> Option<&TwcWayside> {
        self.data.as_ref()
    }

    /// Answers made to the loop since power-up, wrapping.
    pub fn answers(&self) -> u16 {
        self.answers
    }

    /// Frames accepted since power-up, wrapping.
    pub fn received(&self) -> u16 {
        self.received
    }
}

/// Station, loop and route are those of the section's departure or arrival.
fn agrees(data: &TwcWayside, section: &Section) -> bool {
    let departure = data.station == section.from_station && data.loop_id == section.from_loop;
    let arrival = data.station == section.to_station && data.loop_id == section.to_loop;
    let onward = arrival || data.next_station == section.to_station;
    data.route == section.route && (departure || arrival) && onward
}
