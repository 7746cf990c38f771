//! Output of ATO's effort to TCMS, where injected faults bound, stop or delay it.

use alloc::collections::VecDeque;

use protocol::injection::Effect;
use protocol::{CYCLE, Duration};

/// Longest time an effort can be held back, cycles: 5 s.
const LATEST_CYCLES: usize = 100;

/// Output of ATO's processor to TCMS.
#[derive(Clone, Debug, Default)]
pub struct EffortOutput {
    held_back: VecDeque<i16>,
}

impl EffortOutput {
    /// Effort that comes out this cycle, -1024 .. 1023.
    pub fn give(&mut self, effort: i16, effect: Option<Effect>) -> i16 {
        match effect {
            Some(Effect::StuckOn) => 1023,
            Some(Effect::Offset { by }) => bounded(f64::from(effort) + by),
            Some(Effect::Limit { to }) => bounded(f64::from(effort).clamp(-to.abs(), to.abs())),
            Some(Effect::Delay { ms }) => self.late(effort, ms),
            _ => effort,
        }
    }

    fn late(&mut self, effort: i16, ms: u32) -> i16 {
        let cycles = Duration::from_ms(u64::from(ms)).as_us() / CYCLE.as_us();
        self.held_back.push_back(effort);
        let keeps = (cycles as usize).min(LATEST_CYCLES);
        if self.held_back.len() > keeps {
            return self.held_back.pop_front().unwrap_or(effort);
        }
        0
    }
}

fn bounded(effort: f64) -> i16 {
    effort.clamp(-1024.0, 1023.0) as i16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effects_bound_move_and_delay_the_effort() {
        let mut output = EffortOutput::default();
        let limit = Some(Effect::Limit { to: 300.0 });
        let offset = Some(Effect::Offset { by: -2000.0 });
        assert_eq!(output.give(700, None), 700);
        assert_eq!(output.give(700, limit), 300);
        assert_eq!(output.give(-700, limit), -300);
        assert_eq!(output.give(700, offset), -1024);
        let late = Some(Effect::Delay { ms: 150 });
        let given: alloc::vec::Vec<_> = (1..=6).map(|e| output.give(e, late)).collect();
        assert_eq!(given, [0, 0, 0, 1, 2, 3]);
    }
}
