//! Where yard mode ends: at a code of the line, or at one that cancels yard mode.
//!
//! Then the lower one of the yard's limit and the code's limit under cab signal holds. A yard code gives the yard's
//! limit back; so does the mode switch, when it leaves its position and comes back. A yard without any code changes
//! nothing.
//! Where the code table has no codes for the yard, only a code that says stop ends it, and one that lets a train run gives
//! the limit back.

use protocol::Instant;
use protocol::config::{CodeMeaning, UnitConfig};
use protocol::event::Event;
use protocol::message::Mode;

use crate::kernel::EventLog;

#[derive(Clone, Debug)]
pub struct Yard {
    /// The code table has codes for the yard.
    has_codes: bool,
    /// The code counts, although the mode switch is at yard.
    pub ended: bool,
}

impl Yard {
    pub fn new(config: &UnitConfig) -> Self {
        let of_yard = |code: &protocol::config::SpeedCode| code.meaning != CodeMeaning::Line;
        Self {
            has_codes: config.codes.iter().any(of_yard),
            ended: false,
        }
    }

    /// One scan, with what the code in force is for, `None` = no code of the table, and whether it says stop.
    pub fn step(
        &mut self,
        now: Instant,
        mode: Mode,
        code: Option<CodeMeaning>,
        stops: bool,
        log: &mut EventLog,
    ) {
        let before = self.ended;
        self.ended = match (mode, code) {
            (Mode::Yard, _) if stops => true,
            (Mode::Yard, Some(CodeMeaning::YardCancel | CodeMeaning::Line)) => self.has_codes,
            (Mode::Yard, None) => before,
            _ => false,
        };
        if self.ended && !before {
            log.push(now, Event::YardEnded, 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::{logged, seoul34, sg100};
    use CodeMeaning::{Line, Yard as OfYard, YardCancel};

    /// The rule: 3.2 Hz is for the yard, 16.8 Hz ends it, and so does a code of the line.
    #[test]
    fn what_ends_the_yard_is_this_table() {
        let mut yard = Yard::new(&seoul34());
        let mut log = EventLog::default();
        for (mode, code, ended) in [
            (Mode::Yard, None, false),
            (Mode::Yard, Some(OfYard), false),
            (Mode::Yard, Some(YardCancel), true),
            // Not given back by silence, which a dead receiver hears, too.
            (Mode::Yard, None, true),
            (Mode::Yard, Some(OfYard), false),
            (Mode::Yard, Some(Line), true),
            (Mode::Manual, Some(Line), false),
            (Mode::Yard, None, false),
            (Mode::Manual, Some(OfYard), false),
        ] {
            yard.step(Instant::ZERO, mode, code, false, &mut log);
            assert_eq!(yard.ended, ended, "{mode:?} {code:?}");
        }
        assert_eq!(logged(&log)[0].0, 219);
    }

    #[test]
    fn where_the_table_has_no_yard_codes_only_a_stop_ends_it() {
        let mut yard = Yard::new(&sg100());
        let mut log = EventLog::default();
        for (code, stops, ended) in [
            (Some(Line), false, false),
            (None, true, true),
            (None, false, true),
            (Some(Line), false, false),
            (Some(Line), true, true),
        ] {
            yard.step(Instant::ZERO, Mode::Yard, code, stops, &mut log);
            assert_eq!(yard.ended, ended, "{code:?} {stops}");
        }
    }
}
