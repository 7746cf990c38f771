//! The share of frames received over the last seconds, so that a failing cable shows at once.

use std::collections::VecDeque;

use protocol::link::Counters;
use protocol::message::Channel;
use protocol::{Duration, Instant};

/// Time over which the quality of the link is judged.
const SPAN: Duration = Duration::from_ms(10_000);
/// Interval at which counts are kept.
const EVERY: Duration = Duration::from_ms(500);

/// Counts of the last seconds.
#[derive(Debug, Default)]
pub struct LinkQuality {
    /// When, frames taken and frames lost or refused, oldest first.
    counts: VecDeque<(Instant, u64, u64)>,
}

impl LinkQuality {
    /// Takes the present counts; counts of a new bench begin at 0.
    pub fn note(&mut self, now: Instant, counters: &Counters) {
        let taken = Channel::ALL
            .iter()
            .map(|channel| counters.accepted(*channel))
            .sum();
        let lost = Channel::ALL
            .iter()
            .map(|channel| counters.gaps(*channel) + counters.rejected_on(*channel))
            .sum();
        self.take(now, taken, lost);
    }

    fn take(&mut self, now: Instant, taken: u64, lost: u64) {
        if let Some((at, before, _)) = self.counts.back() {
            if now < *at || taken < *before {
                self.counts.clear();
            } else if now.since(*at) < EVERY {
                return;
            }
        }
        self.counts.push_back((now, taken, lost));
        while self
            .counts
            .front()
            .is_some_and(|(at, ..)| now.since(*at) > SPAN)
        {
            self.counts.pop_front();
        }
    }

    /// Share of the frames that came through, 0 to 1; none before any came.
    pub fn share(&self) -> Option<f64> {
        let ((_, taken, lost), (_, taken_now, lost_now)) =
            (self.counts.front()?, self.counts.back()?);
        let (taken, lost) = (taken_now - taken, lost_now.saturating_sub(*lost));
        (taken + lost > 0).then(|| taken as f64 / (taken + lost) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(hours: u64) -> LinkQuality {
        let mut link = LinkQuality::default();
        for second in 0..hours * 3600 {
            link.take(Instant::from_ms(second * 1000), second * 100, 0);
        }
        link
    }

    #[test]
    fn a_cable_that_fails_after_an_hour_shows_within_seconds() {
        let mut link = after(1);
        assert_eq!(link.share(), Some(1.0));
        for second in 3600..3605_u64 {
            link.take(
                Instant::from_ms(second * 1000),
                360_000,
                (second - 3599) * 100,
            );
        }
        assert!(link.share() < Some(0.7), "{:?}", link.share());
    }

    #[test]
    fn counts_of_another_bench_start_from_zero() {
        let mut link = after(1);
        link.take(Instant::from_ms(50), 3, 0);
        assert_eq!(link.share(), None);
    }
}
