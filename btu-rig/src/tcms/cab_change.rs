//! Change of cabs at a turn-back [S4]: the head control relay of the cab that gives the train up drops, and after a time
//! that of the other cab picks up. Between the two no cab has the train, and the emergency brake train line is open.

use protocol::{Duration, Instant};

use super::data::TcmsData;

/// Act of TCMS on a head control relay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CabOrder {
    /// The head control relay of the unit's cab drops.
    GiveUp,
    /// The head control relay of the other cab picks up.
    TakeUp,
}

/// A change of cabs, asked for by the unit.
#[derive(Clone, Debug)]
pub(super) struct CabChange {
    takes: Duration,
    asked: bool,
    taken_up_at: Option<Instant>,
}

impl CabChange {
    pub fn new(data: &TcmsData) -> Self {
        Self {
            takes: Duration::from_secs(data.cab_change_s),
            asked: false,
            taken_up_at: None,
        }
    }

    /// Ends a change that is under way; another begins when the unit asks for it again.
    pub fn leave(&mut self) {
        self.taken_up_at = None;
    }

    /// One scan; a change begins when it is asked for while the train stands.
    pub fn step(&mut self, now: Instant, asked: bool, stands: bool) -> Option<CabOrder> {
        let begins = asked && stands && !self.asked;
        self.asked = asked && (stands || self.asked);
        if begins {
            self.taken_up_at = Some(now + self.takes);
            return Some(CabOrder::GiveUp);
        }
        self.taken_up_at.take_if(|at| now >= *at)?;
        Some(CabOrder::TakeUp)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_relay_drops_and_the_other_picks_up_after_a_time_once_the_train_stands() {
        let mut change = CabChange {
            takes: Duration::from_ms(40),
            asked: false,
            taken_up_at: None,
        };
        let mut at_ms = 0;
        let mut step = |asked, stands| {
            at_ms += 20;
            change.step(Instant::from_ms(at_ms), asked, stands)
        };
        assert_eq!(step(true, false), None);
        assert_eq!(step(true, true), Some(CabOrder::GiveUp));
        assert_eq!(step(true, true), None);
        assert_eq!(step(false, true), Some(CabOrder::TakeUp));
        assert_eq!(step(false, true), None);
        assert_eq!(step(true, true), Some(CabOrder::GiveUp), "asked for again");
    }
}
