//! TWC: station and train data through the loop [S2 §2.1]. Data for another train are not acted on, data that
//! contradict the track database are refused (`check`). Orders of the wayside are checked alike (`orders`).

mod check;
mod number;
mod orders;

use protocol::event::Event;
use protocol::line::Line;
use protocol::message::{TrainOrder, TwcOrders, TwcTrain, TwcTrainBits, TwcWayside};
use protocol::{Duration, Instant};

use crate::guards::Guards;
use crate::kernel::EventLog;
use check::contradiction;

pub use check::departs;
pub use number::OwnNumber;

/// Data that came through the TWC antenna.
#[derive(Clone, Copy, Debug)]
pub enum FromWayside {
    Station(StationSender, TwcWayside),
    /// Orders, with the sequence number of their frame.
    Orders(u16, TwcOrders),
}

/// Sender of station data into the TWC antenna, which hears the answer, with the sequence number of its
/// frame.
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

/// The last orders that were not refused.
#[derive(Clone, Copy, Debug)]
struct Ordered {
    destination: u16,
    order: TrainOrder,
    heard: Instant,
}

/// The number of the unit's own train; 0 = none: data for any train are for this one.
pub type TrainNumber = u16;

#[derive(Clone, Debug, Default)]
pub struct Twc {
    timeout: Duration,
    heard: Option<Instant>,
    pub up: bool,
    /// The last data that were not refused.
    pub data: Option<TwcWayside>,
    /// The last frame was not refused.
    pub valid: bool,
    refusal_reported: Option<(Event, i32)>,
    ordered: Option<Ordered>,
    /// Event of the last refused orders, with its parameter.
    orders_refusal: Option<(Event, i32)>,
    /// Train that data were for last, and when.
    other_train: Option<(u16, Instant)>,
    /// Frames for this train since power-up, wrapping.
    pub received: u16,
    others: u16,
    refused: u16,
    /// Answers made to the loop since power-up, wrapping.
    pub answers: u16,
}

impl Twc {
    /// Communication counts as lost after `timeout` of silence.
    pub fn new(timeout: Duration) -> Self {
        Self {
            timeout,
            ..Self::default()
        }
    }

    /// Takes station data unless they are for another train, and checks them against the track database.
    pub fn take(
        &mut self,
        now: Instant,
        data: TwcWayside,
        own: TrainNumber,
        line: &Line,
        guards: Guards,
        log: &mut EventLog,
    ) {
        if self.passes_over(now, data.train_number, own, guards, log) {
            return;
        }
        self.received = self.received.wrapping_add(1);
        if !self.up && self.heard.is_some() {
            log.push(now, Event::TwcRestored, 0);
        }
        self.heard = Some(now);
        self.up = true;
        let refusal = contradiction(&data, line, guards);
        self.valid = refusal.is_none();
        match refusal {
            None => {
                self.data = Some(data);
            }
            Some((event, parameter)) => {
                self.refused = self.refused.wrapping_add(1);
                if self.refusal_reported != refusal {
                    log.push(now, event, parameter);
                }
            }
        }
        self.refusal_reported = refusal;
    }

    /// Whether a frame is for another train. Such frames are counted, and logged once for as long as
    /// they come.
    fn passes_over(
        &mut self,
        now: Instant,
        number: u16,
        own: TrainNumber,
        guards: Guards,
        log: &mut EventLog,
    ) -> bool {
        if own == 0 || number == own || !guards.train_number {
            return false;
        }
        self.others = self.others.wrapping_add(1);
        let goes_on = self
            .other_train
            .is_some_and(|(before, at)| before == number && now.since(at) < self.timeout);
        self.other_train = Some((number, now));
        if !goes_on {
            log.push(now, Event::TwcOtherTrain, i32::from(number));
        }
        true
    }

    /// One cycle. Between loops nothing can be heard: station data last, and silence counts from the next loop on.
    pub fn step(&mut self, now: Instant, between_loops: bool, log: &mut EventLog) {
        if between_loops && self.up && self.valid {
            self.heard = self.heard.map(|_| now);
        }
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

    /// The modem is used for a test: what was received counts no more, and the silence after it is no loss.
    pub fn forget(&mut self) {
        self.heard = None;
        self.up = false;
        self.valid = false;
        self.data = None;
    }

    /// The answer to a frame of `sender`, with the unit's own train number and the state of the train.
    pub fn answer(
        &mut self,
        sender: StationSender,
        data: &TwcWayside,
        own: TrainNumber,
        train: TwcTrain,
    ) -> TwcTrain {
        if !sender.is_test() {
            self.answers = self.answers.wrapping_add(1);
        }
        let mut bits = train.bits;
        bits.set(TwcTrainBits::STATION_VALID, self.valid);
        TwcTrain {
            answered_seq: sender.seq(),
            station: data.station,
            train_number: if own == 0 { data.train_number } else { own },
            mode: train.mode,
            bits,
            speed_cms: train.speed_cms,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::{line8, parameters};

    const OWN: TrainNumber = 8001;

    struct Bench {
        twc: Twc,
        log: EventLog,
        now: Instant,
    }

    impl Bench {
        fn new() -> Self {
            Self {
                twc: Twc::new(Duration::from_ms(1000)),
                log: EventLog::default(),
                now: Instant::ZERO,
            }
        }

        /// Data of the first section's departure, for a train of this number.
        fn data(&self, train_number: u16) -> TwcWayside {
            TwcWayside {
                train_number,
                ..check::tests::departure(line8(), 0)
            }
        }

        fn take(&mut self, data: TwcWayside, own: TrainNumber) {
            self.twc
                .take(self.now, data, own, line8(), Guards::ALL, &mut self.log);
            self.now += Duration::from_ms(250);
            self.twc.step(self.now, false, &mut self.log);
        }

        fn logged(&self, event: Event) -> usize {
            parameters(&self.log, event).len()
        }
    }

    #[test]
    fn data_for_another_train_change_nothing_and_keep_no_communication_up() {
        let mut bench = Bench::new();
        bench.take(bench.data(OWN), OWN);
        assert!(bench.twc.valid);
        for _ in 0..8 {
            bench.take(bench.data(9999), OWN);
        }
        assert!(!bench.twc.up && bench.twc.data.as_ref().is_none());
        assert_eq!(
            bench.logged(Event::TwcOtherTrain),
            1,
            "once while they come"
        );
        assert_eq!(bench.logged(Event::TwcLost), 1);
        assert_eq!((bench.twc.received, bench.twc.others), (1, 8));
    }

    #[test]
    fn the_answer_carries_the_units_own_number() {
        let mut bench = Bench::new();
        let data = bench.data(9999);
        let mut number = |own| {
            let sender = StationSender::Loop(3);
            let answer = bench.twc.answer(sender, &data, own, TwcTrain::default());
            answer.train_number
        };
        assert_eq!(number(OWN), OWN);
        assert_eq!(number(0), 9999, "a unit without a number");
    }

    #[test]
    fn a_unit_without_a_number_takes_data_for_any_train() {
        let mut bench = Bench::new();
        bench.take(bench.data(9999), 0);
        assert!(bench.twc.valid);
    }

    /// A refusal is logged once, and what was taken before stays in force.
    #[test]
    fn refused_data_do_not_take_the_place_of_good_ones() {
        let mut bench = Bench::new();
        bench.take(bench.data(OWN), OWN);
        let wrong = TwcWayside {
            next_station: 999,
            fixed_speed_kmh: 80,
            departure: 1,
            ..bench.data(OWN)
        };
        (0..4).for_each(|_| bench.take(wrong, OWN));
        assert!(bench.twc.up && !bench.twc.valid);
        assert_eq!(bench.twc.data.as_ref(), Some(&bench.data(OWN)));
        assert_eq!(bench.logged(Event::TwcWrongNext), 1);
        assert_eq!(bench.twc.refused, 4);
    }
}
