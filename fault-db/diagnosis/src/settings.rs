//! Parameters of the diagnosis (priors, thresholds, costs), read from `scripts/diagnosis.toml`.

use serde::{Deserialize, Serialize};

/// Priors and thresholds of the diagnosis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Prior probability that a unit brought to the bench has no fault.
    pub no_fault: f64,
    /// An adaptive run ends when a part has this probability by Bayes' rule.
    pub found_at: f64,
    /// A unit counts as healthy at this probability of no fault.
    pub healthy_at: f64,
    /// Checks with less expected information, bits, are not recommended.
    pub least_gain_bits: f64,
    /// Least information, bits, of the pass or fail of a check that a person is told to make next where a part is
    /// named.
    pub told_gain_bits: f64,
    /// Assumed runs, added to the counted ones for smoothing: no result is then impossible.
    pub doubt_runs: f64,
    /// Share of checks on which a mode acts otherwise than counted: like another mode of its part, or in any way.
    pub otherwise: f64,
    /// `otherwise` of an intermittent mode, and of a mode that is not in the dictionary: it acts like a mode of the
    /// dictionary, but on this share of checks otherwise.
    pub otherwise_unseen: f64,
    /// Share of those deviating checks that may show any result at all, instead of that of another mode of the part.
    pub anything: f64,
    /// Share of a part's faults that act in a way which is not in the dictionary.
    pub unseen_mode: f64,
    /// Least likeness of two different parts, where a part and itself have 1: a mode that was not seen yet may act like
    /// a mode of any part.
    pub other_part: f64,
    /// Weight of the steps so far in the forecast of other steps, under a fault that is not in the dictionary.
    pub foresight: f64,
    /// Weight of the parts that failed checks suspect: all failed checks together weigh like this number of independent
    /// ones.
    pub suspect: f64,
    /// Weight of a step's evidence, below 1 because steps of one run are not independent.
    pub weight_of_step: f64,
    /// Weight of a trace's first deviation from a sound unit, below 1 because traces of one run are not independent.
    pub weight_of_residual: f64,
    /// Set-up time before a procedure, s, as part of the cost of a check.
    pub bring_up_s: f64,
    /// Factor on a part's prior for each earlier run in which a fault named it.
    pub recurrence_factor: f64,
    /// Factor on a part's prior when it was replaced and the same fault came back.
    pub replaced_in_vain_factor: f64,
    /// Factor on the prior of each part that the symptom the unit was brought with may come from.
    pub symptom_factor: f64,
    /// A repair is proven when a unit that still has the fault would pass the runs since with at most this probability.
    pub hidden_fault: f64,
    /// How far back a unit's history counts, days.
    pub history_days: u32,
    /// Number of confirmed repairs (of all units) that weighs as much as the dictionary's own weights of the parts.
    pub repairs_like_prior: f64,
    /// Probabilities where nothing was counted. A file may leave out this table and each of the five below: defaults
    /// count.
    #[serde(default)]
    pub likelihood: LikelihoodSettings,
    /// Weights of signs: of the faults that show in a run.
    #[serde(default)]
    pub signs: SignSettings,
    /// Weights of the signs in a unit's own log.
    #[serde(default)]
    pub log: LogSettings,
    /// Weights that tell whether the fault of a run is one that the dictionary has counted.
    #[serde(default)]
    pub counted: CountedSettings,
    /// Weights of the evidence for a part whose fault the dictionary has not counted.
    #[serde(default)]
    pub pool: PoolSettings,
    /// What a conclusion says and shows.
    #[serde(default)]
    pub conclusion: ConclusionSettings,
}

/// Weights that tell whether the fault of a run is one that the dictionary has counted: each speaks against that.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct CountedSettings {
    /// Log odds that the fault was counted, if the run fits the counts under the likeliest fault in everything.
    pub as_counted: f64,
    /// Weight of n steps with a verdict that was seldom counted; ln(n + 1) is weighed.
    pub results: f64,
    /// Weight of n measured values far from those counted; ln(n + 1) is weighed.
    pub values: f64,
    /// Weight of the share of traces whose first deviation is at a signal that was seldom the first.
    pub first: f64,
    /// Weight of n signs that never showed in a counted run; ln(n + 1) is weighed.
    pub signs: f64,
    /// A verdict of a step is seldom if a lesser share of the counted runs had it.
    pub seldom: f64,
    /// A signal is seldom the first to deviate if a lesser share of the counted traces deviated there first.
    pub seldom_first: f64,
    /// A measured value is far from those counted at more than this number of standard deviations.
    pub far: f64,
}

/// Weights of what speaks for a part whose fault the dictionary has not counted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PoolSettings {
    /// Weight of the logarithm of the part's posterior.
    pub posterior: f64,
    /// The logarithm of the posterior, 0 at certainty, counts as no lower than minus this.
    pub limit: f64,
    /// Weight of the share of traces that deviate first at a signal which the part makes.
    pub deviates: f64,
    /// Weight of the share of signs that name the part.
    pub signs: f64,
    /// Weight of the share of failed checks that suspect the part.
    pub suspects: f64,
    /// Weight of being the likeliest part by Bayes' rule, or in one group with the likeliest.
    pub near: f64,
    /// Where faults of two parts explain a run better than one by this, what both share may be the cause: ln of the
    /// likelihood ratio.
    pub common: f64,
    /// Such a shared cause counts as less likely than the likeliest part by at most this: ln of the ratio.
    pub below_first: f64,
}

/// Probabilities where nothing was counted, and how far counts and measured values are trusted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LikelihoodSettings {
    /// Probability that a check passes if nothing is known. `passed`, `failed` and `error` add up to 1, as a check that
    /// was skipped or aborted is no evidence.
    pub passed: f64,
    /// Probability that a check fails if nothing is known.
    pub failed: f64,
    /// Probability that a check ends in an error if nothing is known.
    pub error: f64,
    /// Probability of a sign if nothing is known.
    pub sign: f64,
    /// Probability that a measured value is missing if nothing is known.
    pub missing: f64,
    /// Share of measured values that are uniformly distributed over the measurement's range.
    pub anywhere: f64,
    /// Smallest standard deviation of a measured value, as a share of the measurement's range.
    pub least_spread: f64,
    /// Greatest number of counted runs that weighs: more would pretend that all benches are alike.
    pub most_runs: f64,
}

/// Weights of the faults that show in a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SignSettings {
    /// Probability of a sign that names the failed part, under a fault that is not in the dictionary.
    pub of_part: f64,
    /// Probability of a sign that names another part or none, under a fault that is not in the dictionary.
    pub of_other_part: f64,
    /// Probability of a sign unrelated to the fault.
    pub stray: f64,
    /// Probability that the tester itself measures a fault (a wrong clock) that the unit does not have.
    pub measured: f64,
    /// Probability that a sign which a mode always showed does not show.
    pub silent: f64,
}

/// Weights of the signs in a unit's own log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LogSettings {
    /// Weight of a sign that did not show, beside 1 of a sign that did.
    pub silence: f64,
    /// Probability of a sign unrelated to the fault, as a log also holds the acts of testers; equal under all
    /// hypotheses, however many runs were counted.
    pub stray: f64,
}

/// What a conclusion says and shows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ConclusionSettings {
    /// Parts from this probability on are named when it cannot be told which has failed.
    pub named_at: f64,
    /// Candidates less likely than this are not shown, except for the first candidate.
    pub least_shown: f64,
    /// Greatest number of candidates shown.
    pub most_shown: usize,
    /// A sign or failed check is a consequence of a fault that showed it in at least this share of the counted runs.
    pub explained_at: f64,
    /// Least probability of a part in the set of parts of which one has failed for certain.
    pub least_of_set: f64,
    /// Least probability of all parts of that set together; below it no set is named.
    pub least_in_all: f64,
    /// Greatest number of parts in that set, one more if a part of it may be the cause at the others; else no set is
    /// named.
    pub most_of_set: usize,
    /// A run is called unlike any known fault if the dictionary has counted its fault with less than this probability.
    pub unlike_any: f64,
}

impl Settings {
    /// Checks that each setting is in its range; reports the first that is not.
    ///
    /// # Errors
    /// The key, its value and its range.
    pub fn check(&self) -> Result<(), String> {
        let (likelihood, signs) = (&self.likelihood, &self.signs);
        let (log, counted) = (&self.log, &self.counted);
        let (pool, conclusion) = (&self.pool, &self.conclusion);
        let shares = [
            ("no_fault", self.no_fault),
            ("found_at", self.found_at),
            ("healthy_at", self.healthy_at),
            ("hidden_fault", self.hidden_fault),
            ("foresight", self.foresight),
            ("otherwise", self.otherwise),
            ("otherwise_unseen", self.otherwise_unseen),
            ("anything", self.anything),
            ("unseen_mode", self.unseen_mode),
            ("other_part", self.other_part),
            ("weight_of_step", self.weight_of_step),
            ("weight_of_residual", self.weight_of_residual),
            ("likelihood.passed", likelihood.passed),
            ("likelihood.failed", likelihood.failed),
            ("likelihood.error", likelihood.error),
            ("likelihood.sign", likelihood.sign),
            ("likelihood.missing", likelihood.missing),
            ("likelihood.anywhere", likelihood.anywhere),
            ("likelihood.least_spread", likelihood.least_spread),
            ("log.silence", log.silence),
            ("log.stray", log.stray),
            ("signs.of_part", signs.of_part),
            ("signs.of_other_part", signs.of_other_part),
            ("signs.stray", signs.stray),
            ("signs.measured", signs.measured),
            ("signs.silent", signs.silent),
            ("conclusion.named_at", conclusion.named_at),
            ("conclusion.least_shown", conclusion.least_shown),
            ("conclusion.explained_at", conclusion.explained_at),
            ("conclusion.least_of_set", conclusion.least_of_set),
            ("conclusion.least_in_all", conclusion.least_in_all),
            ("conclusion.unlike_any", conclusion.unlike_any),
            ("counted.seldom", counted.seldom),
            ("counted.seldom_first", counted.seldom_first),
        ];
        for (key, value) in shares {
            if !(value > 0.0 && value < 1.0) {
                return Err(format!("{key} = {value} is not between 0 and 1"));
            }
        }
        if (likelihood.passed + likelihood.failed + likelihood.error - 1.0).abs() > 1e-9 {
            return Err("passed, failed and error of likelihood do not make 1".into());
        }
        let positive = [
            ("likelihood.most_runs", likelihood.most_runs),
            ("conclusion.most_shown", conclusion.most_shown as f64),
            ("conclusion.most_of_set", conclusion.most_of_set as f64),
            ("counted.as_counted", counted.as_counted),
            ("counted.results", counted.results),
            ("counted.values", counted.values),
            ("counted.first", counted.first),
            ("counted.signs", counted.signs),
            ("counted.far", counted.far),
            ("pool.posterior", pool.posterior),
            ("pool.limit", pool.limit),
            ("pool.deviates", pool.deviates),
            ("pool.signs", pool.signs),
            ("pool.suspects", pool.suspects),
            ("pool.near", pool.near),
            ("pool.common", pool.common),
            ("pool.below_first", pool.below_first),
            ("least_gain_bits", self.least_gain_bits),
            ("told_gain_bits", self.told_gain_bits),
            ("doubt_runs", self.doubt_runs),
            ("suspect", self.suspect),
            ("bring_up_s", self.bring_up_s),
            ("recurrence_factor", self.recurrence_factor),
            ("replaced_in_vain_factor", self.replaced_in_vain_factor),
            ("symptom_factor", self.symptom_factor),
            ("repairs_like_prior", self.repairs_like_prior),
        ];
        for (key, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(format!("{key} = {value} is not a positive number"));
            }
        }
        Ok(())
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            no_fault: 0.5,
            found_at: 0.95,
            healthy_at: 0.99,
            hidden_fault: 0.05,
            least_gain_bits: 0.05,
            told_gain_bits: 0.1,
            doubt_runs: 1.0,
            otherwise: 0.0001,
            otherwise_unseen: 0.1,
            anything: 0.1,
            unseen_mode: 0.045,
            other_part: 0.02,
            foresight: 0.15,
            suspect: 2.0,
            weight_of_step: 0.6,
            weight_of_residual: 0.3,
            bring_up_s: 3.0,
            recurrence_factor: 1.5,
            replaced_in_vain_factor: 0.5,
            symptom_factor: 3.0,
            history_days: 90,
            repairs_like_prior: 50.0,
            likelihood: LikelihoodSettings::default(),
            signs: SignSettings::default(),
            log: LogSettings::default(),
            counted: CountedSettings::default(),
            pool: PoolSettings::default(),
            conclusion: ConclusionSettings::default(),
        }
    }
}

impl Default for LikelihoodSettings {
    fn default() -> Self {
        Self {
            passed: 0.50,
            failed: 0.35,
            error: 0.15,
            sign: 0.05,
            missing: 0.1,
            anywhere: 0.1,
            least_spread: 0.01,
            most_runs: 50.0,
        }
    }
}

impl Default for SignSettings {
    fn default() -> Self {
        Self {
            of_part: 0.7,
            of_other_part: 0.015,
            stray: 0.003,
            measured: 1e-6,
            silent: 0.02,
        }
    }
}

impl Default for LogSettings {
    fn default() -> Self {
        Self {
            silence: 0.2,
            stray: 0.02,
        }
    }
}

impl Default for CountedSettings {
    fn default() -> Self {
        Self {
            as_counted: 1.95,
            results: 2.04,
            values: 0.48,
            first: 2.14,
            signs: 2.1,
            seldom: 0.25,
            seldom_first: 0.1,
            far: 5.0,
        }
    }
}

impl Default for PoolSettings {
    fn default() -> Self {
        Self {
            posterior: 0.29,
            limit: 4.0,
            deviates: 1.89,
            signs: 1.84,
            suspects: 1.72,
            near: 2.22,
            common: 2.0,
            below_first: 1.0,
        }
    }
}

impl Default for ConclusionSettings {
    fn default() -> Self {
        Self {
            named_at: 0.05,
            least_shown: 0.005,
            most_shown: 10,
            explained_at: 0.1,
            least_of_set: 0.01,
            least_in_all: 0.85,
            most_of_set: 5,
            unlike_any: 0.05,
        }
    }
}
