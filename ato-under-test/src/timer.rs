//! A condition that counts only after it has lasted.

use protocol::{Duration, Instant};

/// Remembers since when a condition has held without a break.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lasting(Option<Instant>);

impl Lasting {
    /// Takes the condition's present value; true once it has held for `span`.
    pub fn update(&mut self, now: Instant, holds: bool, span: Duration) -> bool {
        if !holds {
            self.0 = None;
            return false;
        }
        now.since(*self.0.get_or_insert(now)) >= span
    }

    /// Forgets it.
    pub fn clear(&mut self) {
        self.0 = None;
    }
}

/// Reports a condition's change once.
#[derive(Clone, Copy, Debug, Default)]
pub struct Edge(bool);

impl Edge {
    /// True when `holds` has just become true.
    pub fn rises(&mut self, holds: bool) -> bool {
        let rises = holds && !self.0;
        self.0 = holds;
        rises
    }

    /// `Some(new value)` when it changed.
    pub fn changes(&mut self, holds: bool) -> Option<bool> {
        let changed = holds != self.0;
        self.0 = holds;
        changed.then_some(holds)
    }

    /// The last value seen.
    pub fn value(&self) -> bool {
        self.0
    }
}
