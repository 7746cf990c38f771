//! Watchdog of ATO's processor: reports when its cycle counter stops.

/// Cycles without progress after which the processor counts as stopped [default].
const CYCLES: u8 = 3;

/// State of the counter as KRN has seen it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Watchdog {
    seen: Option<u8>,
    silent: u8,
}

impl Watchdog {
    /// One cycle; true while the processor counts as stopped.
    pub fn step(&mut self, counter: u8) -> bool {
        let moves = self.seen != Some(counter);
        self.seen = Some(counter);
        self.silent = if moves {
            0
        } else {
            (self.silent + 1).min(CYCLES)
        };
        self.silent == CYCLES
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_counter_that_stands_for_three_cycles_bites_until_it_moves() {
        let mut watchdog = Watchdog::default();
        let stopped = [254, 255, 0, 0, 0, 1, 1, 1, 1, 1, 2].map(|count| watchdog.step(count));
        let expected = [
            false, false, false, false, false, false, false, false, true, true, false,
        ];
        assert_eq!(stopped, expected);
    }
}
