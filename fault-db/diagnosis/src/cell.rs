//! The results of one check under one hypothesis, counted over the runs of a campaign.

use std::collections::{BTreeMap, BTreeSet};

use protocol::Verdict;
use serde::{Deserialize, Serialize};

use super::observation::{ObservedStep, Sign, observed};

/// The result of a step with the signs that showed: the part of an observation that is compared for equality.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct StepOutcome {
    /// The step's verdict.
    #[serde(deserialize_with = "observed")]
    pub result: Verdict,
    #[serde(default, skip_serializing_if = "BTreeSet::is_empty")]
    pub signs: BTreeSet<Sign>,
}

impl StepOutcome {
    /// The outcome of an observed step.
    pub fn of(step: &ObservedStep) -> Self {
        Self {
            result: step.result,
            signs: step.signs.clone(),
        }
    }
}

/// Statistics of the values of one measurement (Welford's sums).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Values {
    /// Number of values.
    pub n: u32,
    /// How often nothing could be measured.
    pub missing: u32,
    pub mean: f64,
    /// Sum of squared distances from the mean.
    pub squares: f64,
    /// Smallest.
    pub low: f64,
    /// Greatest.
    pub high: f64,
}

impl Values {
    fn add(&mut self, value: Option<f64>) {
        let Some(value) = value.filter(|value| value.is_finite()) else {
            self.missing += 1;
            return;
        };
        (self.low, self.high) = if self.n == 0 {
            (value, value)
        } else {
            (self.low.min(value), self.high.max(value))
        };
        self.n += 1;
        let off = value - self.mean;
        self.mean += off / f64::from(self.n);
        self.squares += off * (value - self.mean);
    }

    /// Statistics of these values as at most `runs` runs would have them, with the same mean and standard deviation.
    fn of_runs(self, runs: u32) -> Self {
        if self.n + self.missing <= runs {
            return self;
        }
        let (n, missing) = match self.n < self.missing {
            true => (0, runs),
            false => (runs, 0),
        };
        let squares = self.sd().powi(2) * f64::from(n.max(1) - 1);
        Self {
            n,
            missing,
            squares,
            ..self
        }
    }

    /// Statistics of the values of both together.
    fn with(&self, other: &Self) -> Self {
        let [here, there] = [self, other].map(|values| f64::from(values.n));
        let (of_other, apart) = (there / (here + there), other.mean - self.mean);
        let Self { missing, .. } = *other;
        let missing = self.missing + missing;
        match (self.n, other.n) {
            (_, 0) => Self { missing, ..*self },
            (0, _) => Self { missing, ..*other },
            _ => Self {
                n: self.n + other.n,
                missing,
                mean: self.mean + of_other * apart,
                squares: self.squares + other.squares + here * of_other * apart * apart,
                low: self.low.min(other.low),
                high: self.high.max(other.high),
            },
        }
    }

    /// Whether these values agree with a healthy unit's, as far as so few values can tell.
    fn is_like(&self, healthy: &Self) -> bool {
        /// Greatest distance from the healthy mean in standard deviations, of a single value and of the mean of
        /// several.
        const FAR: f64 = 3.0;
        let sd = healthy.sd() + 1e-9 * healthy.mean.abs();
        let of_mean = (FAR / f64::from(self.n.max(1)).sqrt()).max(1.0);
        self.n > 0
            && self.missing == 0
            && self.low >= healthy.low - FAR * sd
            && self.high <= healthy.high + FAR * sd
            && (self.mean - healthy.mean).abs() <= of_mean * sd + 1e-9
    }

    /// Standard deviation; 0 of fewer than two.
    pub fn sd(&self) -> f64 {
        if self.n < 2 {
            0.0
        } else {
            (self.squares / f64::from(self.n - 1)).max(0.0).sqrt()
        }
    }
}

/// The counts of one check under one hypothesis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// How often each outcome occurred.
    pub signatures: Vec<(StepOutcome, u32)>,
    /// Mean bench time, s.
    pub time_s: f64,
    /// Statistics of its measurements.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub values: BTreeMap<String, Values>,
}

impl Cell {
    /// Counts a step.
    pub fn add(&mut self, step: &ObservedStep) {
        let signature = StepOutcome::of(step);
        match self.signatures.iter_mut().find(|(s, _)| *s == signature) {
            Some((_, count)) => *count += 1,
            None => self.signatures.push((signature, 1)),
        }
        self.time_s += (step.time_s - self.time_s) / f64::from(self.runs());
        for (name, value) in &step.values {
            self.values.entry(name.clone()).or_default().add(*value);
        }
    }

    /// The counts of both cells together.
    pub fn with(&self, other: &Self) -> Self {
        let mut both = self.clone();
        let [here, there] = [self, other].map(|cell| f64::from(cell.runs()));
        both.time_s += (other.time_s - self.time_s) * there / (here + there);
        for (signature, count) in &other.signatures {
            match both.signatures.iter_mut().find(|(s, _)| s == signature) {
                Some((_, known)) => *known += count,
                None => both.signatures.push((signature.clone(), *count)),
            }
        }
        for (name, values) in &other.values {
            let known = both.values.entry(name.clone()).or_default();
            *known = known.with(values);
        }
        both
    }

    /// The most frequent outcome of these runs, as if it had been counted in `runs` runs.
    pub fn of_runs(&self, runs: u32) -> Self {
        let most = self.signatures.iter().max_by_key(|(_, count)| *count);
        Self {
            signatures: most.map(|(s, _)| (s.clone(), runs)).into_iter().collect(),
            ..self.clone()
        }
    }

    /// These counts, with the values of at most `runs` runs: values taken from a healthy unit are of many more runs.
    pub fn with_values_of(mut self, runs: u32) -> Self {
        self.values
            .values_mut()
            .for_each(|values| *values = values.of_runs(runs));
        self
    }

    /// How often the check was run.
    pub fn runs(&self) -> u32 {
        self.signatures.iter().map(|(_, count)| count).sum()
    }

    /// How often the check had this result.
    pub fn count(&self, result: Verdict) -> u32 {
        let of = self.signatures.iter().filter(|(s, _)| s.result == result);
        of.map(|(_, count)| count).sum()
    }

    /// How often the sign showed.
    pub fn count_sign(&self, sign: &Sign) -> u32 {
        let of = self
            .signatures
            .iter()
            .filter(|(s, _)| s.signs.contains(sign));
        of.map(|(_, count)| count).sum()
    }

    /// Share of runs in which the check did not pass.
    pub fn not_passed(&self) -> f64 {
        match self.runs() {
            0 => 0.0,
            runs => 1.0 - f64::from(self.count(Verdict::Passed)) / f64::from(runs),
        }
    }

    /// Whether the check did not pass in some run, or showed a sign.
    pub fn shows_a_fault(&self) -> bool {
        let mut signatures = self.signatures.iter();
        signatures.any(|(s, _)| s.result != Verdict::Passed || !s.signs.is_empty())
    }

    /// Whether the cell is like a healthy unit's: no other outcomes, and values that agree.
    pub fn is_like(&self, healthy: &Self) -> bool {
        let known = |(signature, _): &(StepOutcome, u32)| {
            let of_healthy = healthy.signatures.iter().find(|(s, _)| s == signature);
            // An outcome seen in less than half of the healthy runs is not what a healthy unit shows.
            of_healthy.is_some_and(|(_, count)| 2 * count >= healthy.runs())
        };
        let lies_there = |(name, values): (&String, &Values)| {
            let of_healthy = healthy.values.get(name);
            of_healthy.is_some_and(|of_healthy| values.is_like(of_healthy))
        };
        self.runs() > 0 && self.signatures.iter().all(known) && self.values.iter().all(lies_there)
    }

    /// Takes a healthy unit's statistics for values that agree with them: a few runs alone would give too
    /// small a deviation.
    pub fn take_values_from(&mut self, healthy: &Self) {
        for (name, values) in &mut self.values {
            if let Some(of_healthy) = healthy.values.get(name)
                && values.is_like(of_healthy)
            {
                *values = *of_healthy;
            }
        }
    }
}
