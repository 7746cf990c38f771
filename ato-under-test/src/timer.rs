//! Time as the unit's clock tells it; on-delay timer and edge detector for conditions that are evaluated every scan.

use protocol::{Duration, Instant};

/// A time that the unit configuration gives.
pub fn ms(ms: u32) -> Duration {
    Duration::from_ms(u64::from(ms))
}

/// Time that a clock shows which runs `rate` times as fast as it should.
pub fn at_rate(passed: Duration, rate: f64) -> Duration {
    if rate == 1.0 {
        return passed;
    }
    Duration::from_secs(passed.as_secs() * rate)
}

/// On-delay timer: true once its condition has held without a break for a given time.
#[derive(Clone, Copy, Debug, Default)]
pub struct OnDelay(Option<Instant>);

impl OnDelay {
    /// Takes the condition's present value; true once it has held for `span`.
    pub fn update(&mut self, now: Instant, holds: bool, span: Duration) -> bool {
        if !holds {
            self.0 = None;
            return false;
        }
        now.since(*self.0.get_or_insert(now)) >= span
    }

    /// Starts again, as if the condition had never held.
    pub fn clear(&mut self) {
        self.0 = None;
    }
}

/// Counts occurrences in one span of time after the other, and tells once in a span that there were many.
#[derive(Clone, Debug, Default)]
pub struct Burst {
    count: u32,
    since: Instant,
    told: bool,
}

impl Burst {
    /// One scan; true in the one that brings the `many`th occurrence of the span.
    pub fn tells_many(&mut self, now: Instant, occurs: bool, many: u32, span: Duration) -> bool {
        if now.since(self.since) > span {
            (self.count, self.since, self.told) = (0, now, false);
        }
        self.count += u32::from(occurs);
        let tells = self.count >= many && !self.told;
        self.told |= tells;
        tells
    }

    /// There were many in this span.
    pub fn told(&self) -> bool {
        self.told
    }
}

/// Edge detector: reports each change of a condition once.
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

    /// The value of the last scan.
    pub fn value(&self) -> bool {
        self.0
    }
}
