//! How long something has lasted.

use protocol::{Duration, Instant};

/// Since when a condition holds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lasting {
    since: Option<Instant>,
}

impl Lasting {
    /// Whether it has held for a time.
    pub fn update(&mut self, now: Instant, holds: bool, at_least: Duration) -> bool {
        if !holds {
            self.since = None;
            return false;
        }
        let since = *self.since.get_or_insert(now);
        now.since(since) >= at_least
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lasts_without_a_gap() {
        let mut lasting = Lasting::default();
        let held = |lasting: &mut Lasting, ms: u64, holds: bool| {
            lasting.update(Instant::from_ms(ms), holds, Duration::from_ms(50))
        };
        assert!(!held(&mut lasting, 0, true));
        assert!(!held(&mut lasting, 40, true));
        assert!(held(&mut lasting, 50, true));
        assert!(!held(&mut lasting, 60, false));
        assert!(!held(&mut lasting, 70, true));
        assert!(!held(&mut lasting, 110, true));
    }
}
