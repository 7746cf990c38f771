//! State and answers of a unit while damaged frames come: the state must not change, and each answer must have
//! been asked for.

use std::fmt::Debug;
use std::time::{Duration, Instant};

use protocol::event::Event;
use protocol::message::{
    Answer, AtcToTcms, IoOutput, LogEntry, Message, Outputs, Status, StatusBits, StimulusAnswer,
    TrainState, TwcTrain,
};

/// Most faults that are told of a connection.
const MOST_FAULTS: usize = 10;

/// Answers that are due.
#[derive(Debug, Default)]
pub struct Due {
    pub identities: usize,
    pub log_ends: usize,
    /// Sequence numbers of requests to the TEST board, and of station data.
    pub stimuli: Vec<u16>,
    pub stations: Vec<u16>,
}

impl Due {
    pub fn is_empty(&self) -> bool {
        let counted = self.identities + self.log_ends;
        counted == 0 && self.stimuli.is_empty() && self.stations.is_empty()
    }
}

/// Last of each message in which the unit shows its state, without counters.
#[derive(Default)]
struct Shown {
    output: IoOutput,
    status: Status,
    train: TrainState,
    to_tcms: AtcToTcms,
    answer: TwcTrain,
}

/// Hears all that the unit says.
pub struct Watch {
    pub due: Due,
    shown: Shown,
    /// The state must stay as it is, of a unit that is armed or not.
    held: Option<bool>,
    pub faults: Vec<String>,
    /// Frames that the unit refused since its state is held.
    pub refused: u64,
    told: u16,
    /// Events that the unit has logged.
    pub events: u32,
    /// First event that was not read.
    pub next_index: u32,
    /// When it was asked who it is, and the longest time to an answer.
    pub asked_at: Instant,
    pub slowest: Duration,
    /// Requests that were answered as they must be.
    pub answered: u64,
}

impl Watch {
    pub fn new() -> Self {
        Self {
            due: Due::default(),
            shown: Shown::default(),
            held: None,
            faults: Vec::new(),
            refused: 0,
            told: 0,
            events: 0,
            next_index: 0,
            asked_at: Instant::now(),
            slowest: Duration::ZERO,
            answered: 0,
        }
    }

    pub fn is(&self, bits: StatusBits) -> bool {
        self.shown.status.bits.contains(bits)
    }

    pub fn brake_released(&self) -> bool {
        self.shown.output.outputs.contains(Outputs::EB_RELAY)
    }

    /// From now on the state must stay as it is; nothing was counted before.
    pub fn hold(&mut self) {
        self.held = Some(self.is(StatusBits::ARMED));
        self.faults.clear();
        self.next_index = self.events;
        (self.refused, self.answered, self.slowest) = (0, 0, Duration::ZERO);
    }

    pub fn holds(&self) -> bool {
        self.held.is_some()
    }

    /// Takes note of a message.
    pub fn take(&mut self, message: &Message) {
        let (held, shown, faults) = (self.holds(), &mut self.shown, &mut self.faults);
        match *message {
            Message::IoOutput(output) => keep(&mut shown.output, output, held, faults),
            Message::AtcToTcms(to_tcms) => keep(&mut shown.to_tcms, to_tcms, held, faults),
            Message::TrainState(train) => {
                let train = TrainState {
                    held: 0,
                    twc_answers: 0,
                    ..train
                };
                keep(&mut shown.train, train, held, faults);
            }
            Message::Status(status) => {
                let told = status.rejected_frames;
                self.refused += u64::from(told.wrapping_sub(self.told));
                (self.told, self.events) = (told, status.events);
                let status = Status {
                    rejected_frames: 0,
                    events: 0,
                    twc_received: 0,
                    ..status
                };
                keep(&mut shown.status, status, held, faults);
            }
            Message::LogEntry(entry) => self.check_event(&entry),
            Message::TwcTrain(train) => {
                let answer = TwcTrain {
                    answered_seq: 0,
                    ..train
                };
                keep(&mut shown.answer, answer, held, faults);
                self.take_answer(message);
            }
            _ => self.take_answer(message),
        }
    }

    fn take_answer(&mut self, message: &Message) {
        let due = &mut self.due;
        let was_due = match *message {
            Message::Identity(_) => {
                self.slowest = self.slowest.max(self.asked_at.elapsed());
                take_one(&mut due.identities)
            }
            Message::LogEnd(end) => {
                self.next_index = end.next_index;
                take_one(&mut due.log_ends)
            }
            Message::StimulusAnswer(said) => {
                self.held.is_none_or(|armed| is_right(armed, said))
                    && remove(&mut due.stimuli, said.request_seq)
            }
            Message::TwcTrain(train) => remove(&mut due.stations, train.answered_seq),
            _ => false,
        };
        self.answered += u64::from(was_due);
        if !was_due {
            self.fault(format!("not asked for: {message:?}"));
        }
    }

    /// The unit logs that frames were refused, and nothing else.
    fn check_event(&mut self, entry: &LogEntry) {
        if Event::from_code(entry.code) != Some(Event::FramesRejected) {
            self.fault(format!("logged: {entry:?}"));
        }
    }

    fn fault(&mut self, what: String) {
        if self.holds() && self.faults.len() < MOST_FAULTS {
            self.faults.push(what);
        }
    }
}

fn is_right(armed: bool, said: StimulusAnswer) -> bool {
    match armed {
        true => said.answer == Answer::Accepted,
        false => said.answer == Answer::NotArmed,
    }
}

/// Keeps what is shown now; a fault if it had to stay as it was.
fn keep<T: PartialEq + Debug>(shown: &mut T, now: T, held: bool, faults: &mut Vec<String>) {
    if held && *shown != now && faults.len() < MOST_FAULTS {
        faults.push(format!("{shown:?} became {now:?}"));
    }
    *shown = now;
}

fn take_one(due: &mut usize) -> bool {
    let was_due = *due > 0;
    *due -= usize::from(was_due);
    was_due
}

fn remove(due: &mut Vec<u16>, seq: u16) -> bool {
    let place = due.iter().position(|&asked| asked == seq);
    place.map(|place| due.swap_remove(place)).is_some()
}
