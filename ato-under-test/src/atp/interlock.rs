//! Interlocks that follow a brake: power only after the lever was at neutral, and the service brake where the
//! emergency brake does not act.

use protocol::event::Event;
use protocol::{Duration, Instant};

use crate::kernel::EventLog;
use crate::timer::{Edge, OnDelay};

/// Time in which the train's brake line follows the relay, and TCMS tells of it [default].
const FOLLOWS: Duration = Duration::from_ms(1_000);
/// Time in which the wheels slow, where TCMS tells nothing [default].
const SLOWS: Duration = Duration::from_ms(2_500);

/// Time in which the line alone follows the relay when it is released [default].
const LINE_FOLLOWS: Duration = Duration::from_ms(300);

/// Interlock of power: power demanded while something held the train is not given afterwards. A person has to ask
/// again.
#[derive(Clone, Copy, Debug, Default)]
pub struct Interlock {
    open: OnDelay,
    held: bool,
    cuts: bool,
}

impl Interlock {
    /// One scan. `held`: something holds the train; `open`: its brake line is open; `controller`: its notch. For 300 ms
    /// after the brake is released the line may still be open: that alone does not latch the interlock.
    pub fn step(&mut self, now: Instant, held: bool, open: bool, controller: i8) {
        let stays_open = self.open.update(now, open && !held, LINE_FOLLOWS);
        self.held = held || open;
        self.cuts = controller > 0 && (self.cuts || held || stays_open);
    }

    /// Powering is cut.
    pub fn cuts(&self) -> bool {
        self.held || self.cuts
    }
}

/// Whether the emergency brake acts when it is asked for.
#[derive(Clone, Debug, Default)]
pub struct BrakePath {
    stays: OnDelay,
    denied: OnDelay,
    rolls: OnDelay,
    failed: Edge,
}

impl BrakePath {
    /// One scan. `asked` = the brake is demanded; `line_stays` = its line is energised all the same; `tcms` = the
    /// brake as TCMS tells it; `unslowed` = the train moves and does not slow.
    pub fn step(
        &mut self,
        now: Instant,
        asked: bool,
        line_stays: bool,
        tcms: Option<bool>,
        unslowed: bool,
        log: &mut EventLog,
    ) {
        let stays = self.stays.update(now, asked && line_stays, FOLLOWS);
        let denied = asked && tcms == Some(false);
        let denied = self.denied.update(now, denied, FOLLOWS);
        let rolls = asked && tcms.is_none() && unslowed;
        let rolls = self.rolls.update(now, rolls, SLOWS);
        let failed = stays || denied || rolls || asked && self.failed.value();
        if self.failed.rises(failed) {
            log.push(now, Event::EbIneffective, i32::from(!stays));
        }
    }

    /// Whether the path of the brake has failed: the next brake has to act.
    pub fn failed(&self) -> bool {
        self.failed.value()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn power_comes_back_only_after_neutral() {
        let mut interlock = Interlock::default();
        for (second, (held, open, controller, cuts)) in (0..).zip([
            (false, false, 4, false),
            (true, false, 4, true),
            (false, false, 4, true),
            (false, false, 1, true),
            (false, false, 0, false),
            (false, true, 4, true),
            (false, false, 4, false),
            (false, true, 4, true),
            (false, true, 4, true),
            (false, false, 4, true),
            (true, false, 0, true),
            (false, false, 0, false),
        ]) {
            interlock.step(Instant::from_ms(second * 1_000), held, open, controller);
            assert_eq!(interlock.cuts(), cuts, "{second} s");
        }
    }

    #[test]
    fn a_brake_that_does_not_act_is_told_once_and_until_it_is_released() {
        let (mut path, mut log) = (BrakePath::default(), EventLog::default());
        let mut at = |ms: u64, asked, stays, tcms: Option<bool>| {
            // The train rolls on all the while.
            path.step(Instant::from_ms(ms), asked, stays, tcms, true, &mut log);
            path.failed()
        };
        assert!(!at(0, true, true, Some(true)));
        assert!(!at(900, true, true, Some(true)));
        assert!(at(1_000, true, true, Some(true)));
        assert!(at(1_100, true, false, Some(true)));
        assert!(!at(1_200, false, false, Some(false)));
        assert!(!at(1_300, true, false, Some(false)));
        assert!(at(2_300, true, false, Some(false)));
        assert!(!at(2_400, false, false, None));
        assert!(!at(2_500, true, false, None));
        assert!(!at(4_900, true, false, None));
        assert!(at(5_000, true, false, None), "by the wheels alone");
        assert_eq!(log.next_index(), 3);
    }
}
