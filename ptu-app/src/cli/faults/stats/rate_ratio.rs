//! Ratio that says whether faults are seen more often than before.

use ptu_report::words::Words;

/// Ratio of the count in the later half of a span to the count in the earlier half.
pub(super) struct RateRatio {
    pub(super) ratio: f64,
    /// Lower end of the 95 % interval of `ratio`; `high` is the upper end.
    pub(super) low: f64,
    pub(super) high: f64,
}

impl RateRatio {
    /// Ratio of the counts in both halves of `course`, counts by day or month; the middle one of an odd number of
    /// counts belongs to neither half. `None` where both halves are empty.
    ///
    /// The logarithm of a ratio of two Poisson counts is nearly normal with variance `1/a + 1/b`; half a count is added
    /// to each count, so that nothing is divided by zero (Haldane, Anscombe).
    pub(super) fn of(course: &[u64]) -> Option<Self> {
        let half = course.len() / 2;
        let earlier: u64 = course[..half].iter().sum();
        let later: u64 = course[course.len() - half..].iter().sum();
        if earlier + later == 0 {
            return None;
        }
        let (earlier, later) = (earlier as f64 + 0.5, later as f64 + 0.5);
        let ratio = later / earlier;
        let off = (1.96 * (1.0 / earlier + 1.0 / later).sqrt()).exp();
        Some(Self {
            ratio,
            low: ratio / off,
            high: ratio * off,
        })
    }

    pub(super) fn text(&self) -> String {
        let said = match (self.low > 1.0, self.high < 1.0) {
            (true, _) => Words::shown().counts.worse,
            (_, true) => Words::shown().counts.better,
            _ => "",
        };
        format!("{:.1} ({:.1}–{:.1}){said}", self.ratio, self.low, self.high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worked out by hand: 10.5 / 4.5 = 2.33; 1.96 × √(1/4.5 + 1/10.5) = 1.104, and e to this power is 3.02.
    #[test]
    fn a_rate_ratio_has_the_interval_of_two_counts() {
        let ratio = RateRatio::of(&[1, 3, 50, 4, 6]).expect("something was seen");
        let near = |a: f64, b: f64| (a - b).abs() < 0.01;
        assert!(near(ratio.ratio, 2.33) && near(ratio.low, 0.77) && near(ratio.high, 7.05));
        assert_eq!(ratio.text(), "2.3 (0.8–7.0)");
        let worse = RateRatio::of(&[2, 40]).expect("something was seen");
        assert!(worse.text().ends_with(" worse"), "{}", worse.text());
        let better = RateRatio::of(&[40, 2]).expect("something was seen");
        assert!(better.text().ends_with(" better"), "{}", better.text());
        assert!(RateRatio::of(&[0, 0]).is_none() && RateRatio::of(&[7]).is_none());
    }
}
