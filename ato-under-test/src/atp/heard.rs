//! Time for which each speed code was heard within the hold time, gaps and other codes between left
//! out.

use alloc::collections::VecDeque;

use protocol::{Duration, Instant, SCAN};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Code {
    /// Nothing valid: the most restrictive limit holds.
    #[default]
    None,
    /// Carrier without modulation: absolute stop.
    AbsoluteStop,
    /// A code of the table, by index.
    Known(u8),
}

/// Codes of the last scans, one entry for each time that one was heard without a break.
#[derive(Clone, Debug, Default)]
pub struct Heard {
    spells: VecDeque<Spell>,
}

#[derive(Clone, Copy, Debug)]
struct Spell {
    code: Code,
    from: Instant,
    to: Instant,
}

impl Heard {
    /// Takes the code of this scan and forgets what is older than `within`.
    pub fn note(&mut self, now: Instant, code: Code, within: Duration) {
        match self.spells.back_mut() {
            Some(spell) if spell.code == code => spell.to = now,
            _ => self.spells.push_back(Spell {
                code,
                from: now,
                to: now,
            }),
        }
        let begin = now.back(within);
        while self.spells.front().is_some_and(|spell| spell.to < begin) {
            self.spells.pop_front();
        }
        if let Some(first) = self.spells.front_mut() {
            first.from = first.from.max(begin);
        }
    }

    /// Number of times a code came within the span.
    pub fn times(&self, code: Code) -> usize {
        let spells = self.spells.iter().filter(|spell| spell.code == code);
        spells.count()
    }

    /// Whether a code is heard again after one silence, and no other code was heard within the span.
    pub fn came_back(&self, code: Code) -> bool {
        let other = |spell: &Spell| spell.code != code && spell.code != Code::None;
        self.times(code) == 1 && !self.spells.iter().any(other)
    }

    /// Time for which a code was heard; a scan counts whole.
    pub fn time(&self, code: Code) -> Duration {
        let spells = self.spells.iter().filter(|spell| spell.code == code);
        spells.fold(Duration::ZERO, |sum, spell| {
            sum + spell.to.since(spell.from) + SCAN
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_of_a_code_is_the_sum_of_its_spells_within_the_span() {
        let mut heard = Heard::default();
        let span = Duration::from_ms(1000);
        let of = |ms: u64| match ms / 100 % 2 {
            0 => Code::Known(1),
            _ => Code::None,
        };
        for scan in 0..200 {
            heard.note(Instant::from_ms(10 * scan), of(10 * scan), span);
        }
        // From 990 ms to 1 990 ms: five whole spells of the code, and one scan more without it.
        assert_eq!(heard.time(Code::Known(1)).as_ms(), 500);
        assert_eq!(heard.time(Code::None).as_ms(), 510);
        assert_eq!(heard.times(Code::Known(1)), 5);
        assert_eq!(heard.time(Code::Known(2)), Duration::ZERO);
    }
}
