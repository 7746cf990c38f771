//! The likelihood of a check's result and measured values under the counts of one cell.
//!
//! Counts of a few runs are smoothed with `doubt` pseudo-runs, so that no result is impossible and one
//! surprise refutes no hypothesis for good. Values follow Student's t (four degrees of freedom, tolerant
//! of outliers), scaled to the range that the measurement has under all hypotheses.

use protocol::Verdict;

use super::cell::{Cell, StepOutcome, Values};
use super::observation::{ObservedStep, Sign};
use super::settings::LikelihoodSettings;

/// The range of a measurement's values under all hypotheses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    low: f64,
    high: f64,
    /// Standard deviation of healthy units.
    spread: f64,
}

impl Scale {
    /// Begins with the range of a healthy unit's values.
    pub fn of_healthy(values: &Values) -> Self {
        Self {
            low: values.low,
            high: values.high,
            spread: values.sd(),
        }
    }

    /// Widens the range to the values counted under another hypothesis.
    pub fn widen(&mut self, values: &Values) {
        if values.n > 0 {
            self.low = self.low.min(values.low);
            self.high = self.high.max(values.high);
        }
    }

    /// Smallest standard deviation of a value, at least `share` of the range. The last two terms are no
    /// parameters: they keep the density finite where all values are the same, and are far below what a
    /// bench resolves.
    fn least_sd(&self, share: f64) -> f64 {
        let range = self.high - self.low;
        let size = self.low.abs().max(self.high.abs());
        self.spread.max(share * range).max(1e-6 * size).max(1e-9)
    }
}

/// The counts expected of a check, and how many runs they represent.
#[derive(Clone, Copy, Debug)]
pub struct Expected<'a> {
    /// Counts.
    pub cell: &'a Cell,
    /// Counted runs of the hypothesis: fewer than the cell's if a healthy unit's counts stand in.
    pub runs: u32,
    /// See [`super::Settings::doubt_runs`].
    pub doubt: f64,
    /// Probabilities where nothing was counted.
    pub settings: &'a LikelihoodSettings,
}

impl Expected<'_> {
    fn runs(&self) -> f64 {
        f64::from(self.runs.min(self.cell.runs())).min(self.settings.most_runs)
    }

    fn smoothed(&self, share: f64, nothing_known: f64) -> f64 {
        let n = self.runs();
        (n * share + self.doubt * nothing_known) / (n + self.doubt)
    }

    /// Whether the check was counted at all.
    pub fn is_counted(&self) -> bool {
        self.cell.runs() > 0
    }

    /// `count` as a share of the counted runs.
    pub fn share(&self, count: u32) -> f64 {
        match self.cell.runs() {
            0 => 0.0,
            runs => f64::from(count) / f64::from(runs),
        }
    }

    /// Probability of a result.
    pub fn result(&self, result: Verdict) -> f64 {
        self.smoothed(self.counted(result), self.settings.of(result))
    }

    /// Share of the counted runs with a result.
    pub fn counted(&self, result: Verdict) -> f64 {
        self.share(self.cell.count(result))
    }

    /// Probability of a sign.
    pub fn sign(&self, sign: &Sign) -> f64 {
        self.smoothed(self.share(self.cell.count_sign(sign)), self.settings.sign)
    }

    /// Probability of an outcome: as counted, or, if never seen, the product of the probabilities of result and signs.
    pub fn signature(&self, signature: &StepOutcome) -> f64 {
        let counted = self.cell.signatures.iter().find(|(s, _)| s == signature);
        let share = self.share(counted.map_or(0, |(_, count)| *count));
        self.smoothed(share, self.of_parts(signature))
    }

    fn of_parts(&self, signature: &StepOutcome) -> f64 {
        let absent = self
            .cell
            .signatures
            .iter()
            .flat_map(|(s, _)| &s.signs)
            .filter(|sign| !signature.signs.contains(*sign));
        let absent: std::collections::BTreeSet<_> = absent.collect();
        let showing: f64 = signature.signs.iter().map(|sign| self.sign(sign)).product();
        let silent: f64 = absent.iter().map(|sign| 1.0 - self.sign(sign)).product();
        self.result(signature.result) * showing * silent
    }

    /// Probability density of a measured value relative to a uniform one, mixed with a share of uniform values. The
    /// range is extended by three times the smallest standard deviation at each end, so that it is not empty if all
    /// values are equal.
    pub fn value(&self, name: &str, value: Option<f64>, scale: &Scale) -> f64 {
        let LikelihoodSettings {
            anywhere,
            least_spread,
            ..
        } = *self.settings;
        let Some(values) = self.cell.values.get(name) else {
            return anywhere;
        };
        let seen = f64::from(values.n + values.missing);
        let missing =
            (f64::from(values.missing) + self.doubt * self.settings.missing) / (seen + self.doubt);
        let Some(value) = value.filter(|value| value.is_finite()) else {
            return missing;
        };
        if values.n == 0 {
            return (1.0 - missing) * anywhere;
        }
        let least = scale.least_sd(least_spread);
        let sd = predicted_sd(values, least);
        let range = (scale.high - scale.low) + 6.0 * least;
        let near = range * student4((value - values.mean) / sd) / sd;
        (1.0 - missing) * (anywhere + (1.0 - anywhere) * near)
    }

    /// Whether a value is more than `far` standard deviations from those counted, or is missing though none was
    /// missing. If all counted values were missing, any value is far; if the measurement was never counted, none is.
    pub fn is_far(&self, name: &str, value: Option<f64>, scale: &Scale, far: f64) -> bool {
        let Some(values) = self.cell.values.get(name) else {
            return false;
        };
        let Some(value) = value.filter(|value| value.is_finite()) else {
            return values.missing == 0;
        };
        let sd = predicted_sd(values, scale.least_sd(self.settings.least_spread));
        values.n == 0 || (value - values.mean).abs() > far * sd
    }
}

/// Standard deviation of the next value after those counted, at least `least`.
fn predicted_sd(values: &Values, least: f64) -> f64 {
    values.sd().hypot(least) * (1.0 + 1.0 / f64::from(values.n)).sqrt()
}

impl LikelihoodSettings {
    /// Probability of each verdict if nothing is known.
    pub(super) const fn of(&self, verdict: Verdict) -> f64 {
        match verdict {
            Verdict::Passed => self.passed,
            Verdict::Failed => self.failed,
            Verdict::Error => self.error,
            Verdict::Skipped | Verdict::Inconclusive | Verdict::Aborted => 0.0,
        }
    }
}

/// Density of Student's t with four degrees of freedom.
fn student4(t: f64) -> f64 {
    0.375 * (1.0 + t * t / 4.0).powf(-2.5)
}

/// Likelihood of a step's result and values under `expected` counts; `scale` gives the range of a measurement's values.
pub fn likelihood_without_signs<'s>(
    expected: Expected<'_>,
    step: &ObservedStep,
    scale: impl Fn(&str) -> Option<&'s Scale>,
) -> f64 {
    expected.result(step.result) * likelihood_of_values(expected, step, scale)
}

/// Likelihood of a step's values alone.
pub fn likelihood_of_values<'s>(
    expected: Expected<'_>,
    step: &ObservedStep,
    scale: impl Fn(&str) -> Option<&'s Scale>,
) -> f64 {
    let values = step.values.iter();
    let of_each =
        values.filter_map(|(name, value)| Some(expected.value(name, *value, scale(name)?)));
    of_each.product()
}

/// Likelihood of a step's result and values if nothing is known.
pub fn likelihood_of_anything<'s>(
    settings: &LikelihoodSettings,
    step: &ObservedStep,
    scale: impl Fn(&str) -> Option<&'s Scale>,
) -> f64 {
    let measured = step.values.iter().filter(|(name, _)| scale(name).is_some());
    let values = settings.anywhere.powi(measured.count() as i32);
    settings.of(step.result) * values
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::sync::LazyLock;

    use super::*;
    use crate::observation::CheckName;

    static SETTINGS: LazyLock<LikelihoodSettings> = LazyLock::new(LikelihoodSettings::default);

    fn step(result: Verdict, value: Option<f64>) -> ObservedStep {
        ObservedStep {
            check: CheckName {
                procedure: "p".into(),
                step: "s".into(),
            },
            result,
            time_s: 1.0,
            values: vec![("t".into(), value)],
            signs: BTreeSet::new(),
        }
    }

    fn cell(of: &[ObservedStep]) -> Cell {
        let mut cell = Cell::default();
        of.iter().for_each(|step| cell.add(step));
        cell
    }

    fn expected(cell: &Cell) -> Expected<'_> {
        Expected {
            cell,
            runs: cell.runs(),
            doubt: 0.5,
            settings: &SETTINGS,
        }
    }

    #[test]
    fn results_are_probabilities_and_nothing_is_impossible() {
        let cell = cell(&[
            step(Verdict::Passed, Some(1.0)),
            step(Verdict::Passed, Some(1.1)),
        ]);
        let sum: f64 = Verdict::ALL
            .iter()
            .map(|r| expected(&cell).result(*r))
            .sum();
        assert!((sum - 1.0).abs() < 1e-12);
        assert!(expected(&cell).result(Verdict::Failed) > 0.01);
        assert!(expected(&cell).result(Verdict::Passed) > 0.85);
    }

    /// A reaction time of 640 ms with a limit of 600 ms is weaker evidence than none at all: under a slow
    /// relay 640 ms is likely, a missing value is not.
    #[test]
    fn a_measured_value_is_stronger_evidence_than_its_verdict() {
        let healthy = cell(&[240.0, 244.0, 250.0].map(|v| step(Verdict::Passed, Some(v))));
        let slow = cell(&[636.0, 640.0, 652.0].map(|v| step(Verdict::Failed, Some(v))));
        let dead = cell(&[None, None, None].map(|v| step(Verdict::Failed, v)));
        let mut scale = Scale::of_healthy(&healthy.values["t"]);
        scale.widen(&slow.values["t"]);
        let ln = |cell: &Cell, value| {
            let step = step(Verdict::Failed, value);
            likelihood_without_signs(expected(cell), &step, |_| Some(&scale)).ln()
        };
        assert!(ln(&slow, Some(643.0)) > ln(&dead, Some(643.0)) + 3.0);
        assert!(ln(&dead, None) > ln(&slow, None) + 2.0);
        // Between both, neither is certain.
        let apart = ln(&slow, Some(440.0)) - ln(&dead, Some(440.0));
        assert!(apart.abs() < 3.0, "{apart}");
    }
}
