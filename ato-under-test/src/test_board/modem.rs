//! TEST modem of the TWC: sends station data into the test coil of the TWC antenna every 250 ms, and hears
//! there what the unit's own transmitter answers.

use protocol::message::{TwcTrain, TwcWayside};
use protocol::{Duration, Instant};

/// Period in which station data are repeated.
const PERIOD: Duration = Duration::from_ms(250);

/// The modem, and what it heard since power-up.
#[derive(Debug, Default)]
pub struct TestModem {
    sending: Option<Sending>,
    next_seq: u16,
    /// Answers heard since power-up, wrapping.
    pub answers: u16,
    last: TwcTrain,
}

#[derive(Debug)]
struct Sending {
    data: TwcWayside,
    due: Instant,
    first_seq: u16,
}

impl TestModem {
    /// Repeats these data from `now` on; answers to earlier data count no more.
    pub fn send(&mut self, now: Instant, data: TwcWayside) {
        self.sending = Some(Sending {
            data,
            due: now,
            first_seq: self.next_seq,
        });
    }

    pub fn stop(&mut self) {
        self.sending = None;
    }

    pub fn sends(&self) -> bool {
        self.sending.is_some()
    }

    /// The frame that is due, with its sequence number.
    pub fn take(&mut self, now: Instant) -> Option<(u16, TwcWayside)> {
        let sending = self.sending.as_mut().filter(|sending| now >= sending.due)?;
        sending.due = now + PERIOD;
        let seq = self.next_seq;
        self.next_seq = seq.wrapping_add(1);
        Some((seq, sending.data))
    }

    /// An answer came through the antenna; it counts if it is one to the data being sent.
    pub fn hear(&mut self, answer: TwcTrain) {
        let Some(sending) = &self.sending else { return };
        let sent = self.next_seq.wrapping_sub(sending.first_seq);
        if answer.answered_seq.wrapping_sub(sending.first_seq) < sent {
            self.answers = self.answers.wrapping_add(1);
            self.last = answer;
        }
    }

    /// The last answer heard; all 0 before the first.
    pub fn last_answer(&self) -> &TwcTrain {
        &self.last
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(answered_seq: u16) -> TwcTrain {
        TwcTrain {
            answered_seq,
            ..TwcTrain::default()
        }
    }

    #[test]
    fn only_answers_to_the_data_being_sent_count() {
        let mut modem = TestModem::default();
        modem.hear(answer(0));
        assert_eq!(modem.answers, 0, "nothing was sent");
        let data = TwcWayside::default();
        modem.send(Instant::ZERO, data);
        assert_eq!(modem.take(Instant::ZERO), Some((0, data)));
        assert_eq!(modem.take(Instant::from_ms(240)), None);
        assert_eq!(modem.take(Instant::from_ms(250)), Some((1, data)));
        for seq in [0, 1, 2] {
            modem.hear(answer(seq));
        }
        assert_eq!(modem.answers, 2, "2 has not been sent");
        modem.send(Instant::from_ms(300), data);
        modem.hear(answer(1));
        assert_eq!(modem.answers, 2, "that was to other data");
        modem.stop();
        modem.hear(answer(1));
        assert_eq!(modem.answers, 2);
    }
}
