//! Where yard mode ends: a code of the line, or one that cancels yard mode, takes its limit away.
//!
//! Then the code counts as under cab signal, and no more than the yard's limit is permitted. A yard code gives the limit
//! back; so does the mode switch, when it leaves its position and comes back. A yard without any code changes nothing, nor
//! does a unit whose code table has no codes for the yard.

use protocol::Instant;
use protocol::config::{CodeMeaning, UnitConfig};
use protocol::event::Event;
use protocol::message::Mode;

use crate::kernel::EventLog;

#[derive(Clone, Debug)]
pub struct Yard {
    /// The code table has codes for the yard.
    has_codes: bool,
    ended: bool,
}

impl Yard {
    pub fn new(config: &UnitConfig) -> Self {
        let of_yard = |code: &protocol::config::SpeedCode| code.meaning != CodeMeaning::Line;
        Self {
            has_codes: config.codes.iter().any(of_yard),
            ended: false,
        }
    }

    /// One scan, with what the code in force is for; `None` = no code of the table.
    pub fn step(
        &mut self,
        now: Instant,
        mode: Mode,
        code: Option<CodeMeaning>,
        log: &mut EventLog,
    ) {
        let before = self.ended;
        self.ended = match (mode, code) {
            (Mode::Yard, Some(CodeMeaning::YardCancel | CodeMeaning::Line)) => self.has_codes,
            (Mode::Yard, None) => before,
            _ => false,
        };
        if self.ended && !before {
            log.push(now, Event::YardEnded, 0);
        }
    }

    /// The code counts, although the mode switch is at yard.
    pub fn ended(&self) -> bool {
        self.ended
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use CodeMeaning::{Line, Yard as OfYard, YardCancel};

    /// The rule: 3.2 Hz is for the yard, 16.8 Hz ends it, and so does a code of the line.
    #[test]
    fn what_ends_the_yard_is_this_table() {
        let text = include_str!("../../../scripts/units/seoul34.toml");
        let mut yard = Yard::new(&UnitConfig::from_toml(text).expect("shipped"));
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
            yard.step(Instant::ZERO, mode, code, &mut log);
            assert_eq!(yard.ended(), ended, "{mode:?} {code:?}");
        }
        assert_eq!(
            log.entries().at_or_after(0).map(|entry| entry.code),
            Some(219)
        );
    }

    #[test]
    fn a_table_without_yard_codes_ends_no_yard() {
        let text = include_str!("../../../scripts/units/sg100.toml");
        let mut yard = Yard::new(&UnitConfig::from_toml(text).expect("shipped"));
        yard.step(
            Instant::ZERO,
            Mode::Yard,
            Some(Line),
            &mut EventLog::default(),
        );
        assert!(!yard.ended());
    }
}
