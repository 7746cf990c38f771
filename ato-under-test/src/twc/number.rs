//! The unit's own train number: that of the configuration until another is keyed in at the cab. The wayside confirms
//! the number by sending data for it.

use protocol::Instant;
use protocol::event::Event;
use protocol::message::NumberState;

use super::TrainNumber;
use crate::kernel::EventLog;
use crate::keyed::Keyed;

#[derive(Clone, Debug)]
pub struct OwnNumber {
    configured: TrainNumber,
    keyed: Option<TrainNumber>,
    confirmed: bool,
    entry: Keyed,
}

impl OwnNumber {
    pub fn new(configured: TrainNumber) -> Self {
        Self {
            configured,
            keyed: None,
            confirmed: false,
            entry: Keyed::default(),
        }
    }

    /// The number in force; 0 = none.
    pub fn own(&self) -> TrainNumber {
        self.keyed.unwrap_or(self.configured)
    }

    pub fn state(&self) -> NumberState {
        match (self.keyed, self.confirmed) {
            (None, _) => NumberState::Configured,
            (Some(_), false) => NumberState::Keyed,
            (Some(_), true) => NumberState::Confirmed,
        }
    }

    /// Takes a frame of the cab: the number counts once `frames` in a row have said it, and while it `may_change`.
    pub fn key_in(
        &mut self,
        now: Instant,
        number: TrainNumber,
        frames: u8,
        may_change: bool,
        log: &mut EventLog,
    ) {
        let keyed = (number != 0 && number != self.configured).then_some(number);
        if !self.entry.hear(now, number, frames) || keyed == self.keyed {
            return;
        }
        if !may_change {
            log.push(now, Event::TrainNumberRefused, i32::from(number));
            return;
        }
        self.keyed = keyed;
        self.confirmed = false;
        log.push(now, Event::TrainNumberSet, i32::from(self.own()));
    }

    /// The wayside has sent data for this number.
    pub fn hear(&mut self, number: TrainNumber) {
        self.confirmed |= number == self.own();
    }
}

#[cfg(test)]
mod tests {
    use protocol::Duration;

    use super::*;
    use crate::for_tests::parameters;
    use crate::keyed::ENTRY_OVER;

    const FRAMES: u8 = 3;

    struct Cab {
        number: OwnNumber,
        log: EventLog,
        now: Instant,
    }

    impl Cab {
        fn new() -> Self {
            Self {
                number: OwnNumber::new(8001),
                log: EventLog::default(),
                now: Instant::ZERO,
            }
        }

        fn key_in(&mut self, entries: &[u16], may_change: bool) -> (u16, NumberState) {
            for entry in entries {
                self.now += Duration::from_ms(50);
                self.number
                    .key_in(self.now, *entry, FRAMES, may_change, &mut self.log);
            }
            (self.number.own(), self.number.state())
        }

        fn logged(&self, event: Event) -> usize {
            parameters(&self.log, event).len()
        }
    }

    #[test]
    fn one_bad_frame_does_not_rename_a_train() {
        let configured = (8001, NumberState::Configured);
        let mut cab = Cab::new();
        assert_eq!(
            cab.key_in(&[8002, 8002, 8003, 8002, 8002], true),
            configured
        );
        cab.now += ENTRY_OVER;
        assert_eq!(cab.key_in(&[8002, 8002], true), configured, "another entry");
        assert_eq!(cab.key_in(&[8002], true), (8002, NumberState::Keyed));
        assert_eq!(cab.key_in(&[8002; 9], true), (8002, NumberState::Keyed));
        assert_eq!(cab.logged(Event::TrainNumberSet), 1);
    }

    #[test]
    fn the_wayside_confirms_a_number_by_using_it() {
        let mut cab = Cab::new();
        cab.key_in(&[8002; 3], true);
        cab.number.hear(8001);
        assert_eq!(cab.number.state(), NumberState::Keyed);
        cab.number.hear(8002);
        assert_eq!(cab.number.state(), NumberState::Confirmed);
        assert_eq!(
            cab.key_in(&[0; 3], true),
            (8001, NumberState::Configured),
            "0 = as configured"
        );
    }

    #[test]
    fn a_number_keyed_in_under_way_is_refused_once() {
        let mut cab = Cab::new();
        let (own, _) = cab.key_in(&[8002; 10], false);
        assert_eq!((own, cab.logged(Event::TrainNumberRefused)), (8001, 1));
    }
}
