//! Parameters of the diagnosis (priors, thresholds, costs), read from `scripts/diagnosis.toml`.

use serde::{Deserialize, Serialize};

/// Priors, and when enough is enough.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Probability that nothing is wrong with a unit that is brought to the bench.
    pub no_fault: f64,
    /// Probability that what is wrong stands in no dictionary.
    pub unknown_fault: f64,
    /// Probability of a second fault beside a first, over that of the second alone.
    pub second_fault: f64,
    /// A part is found when its probability is this.
    pub found_at: f64,
    /// A unit counts as healthy, for the diagnosis, when the probability of no fault is this.
    pub healthy_at: f64,
    /// A check that is expected to tell less than this, bits, is not worth its time.
    pub least_gain_bits: f64,
    /// Runs that nobody made, beside those that were counted, and that may come out otherwise: smoothing.
    pub doubt_runs: f64,
    /// The same of a mode that comes and goes.
    pub doubt_runs_intermittent: f64,
    /// Share of those runs in which a check does what another mode of the same part makes it do.
    pub doubt_same_part: f64,
    /// Share of those runs in which it does anything; in the rest, what it does on a healthy unit.
    pub doubt_anything: f64,
    /// Share of checks that a mode was never seen to change, and hits all the same.
    pub new_hits: f64,
    /// The same of a mode that comes and goes.
    pub new_hits_intermittent: f64,
    /// Weight of a step's evidence: steps of one run are not independent of each other, so that it is less
    /// than 1.
    pub weight_of_step: f64,
    /// Share of checks that a fault which stands in no dictionary hits.
    pub unknown_hits: f64,
    /// Time to bring a unit up before a procedure, s, for the cost of a check.
    pub bring_up_s: f64,
    /// Factor on a part's prior for each earlier run in which a fault named it.
    pub recurrence_factor: f64,
    /// Factor on a part's prior when it was replaced and the same fault came back.
    pub replaced_in_vain_factor: f64,
    /// How far back a unit's history counts, days.
    pub history_days: u32,
}

impl Settings {
    /// What is wrong with them, if anything.
    ///
    /// # Errors
    /// The key, its value and its range.
    pub fn check(&self) -> std::result::Result<(), String> {
        let shares = [
            ("no_fault", self.no_fault),
            ("unknown_fault", self.unknown_fault),
            ("second_fault", self.second_fault),
            ("found_at", self.found_at),
            ("healthy_at", self.healthy_at),
            ("doubt_same_part", self.doubt_same_part),
            ("doubt_anything", self.doubt_anything),
            ("new_hits", self.new_hits),
            ("new_hits_intermittent", self.new_hits_intermittent),
            ("unknown_hits", self.unknown_hits),
            ("weight_of_step", self.weight_of_step),
        ];
        for (key, value) in shares {
            if !(value > 0.0 && value < 1.0) {
                return Err(format!("{key} = {value} is not between 0 and 1"));
            }
        }
        if self.no_fault + self.unknown_fault >= 1.0 {
            return Err("no_fault and unknown_fault leave nothing for known faults".into());
        }
        if self.doubt_same_part + self.doubt_anything >= 1.0 {
            return Err(
                "doubt_same_part and doubt_anything leave nothing for a healthy check".into(),
            );
        }
        let positive = [
            ("least_gain_bits", self.least_gain_bits),
            ("doubt_runs", self.doubt_runs),
            ("doubt_runs_intermittent", self.doubt_runs_intermittent),
            ("bring_up_s", self.bring_up_s),
            ("recurrence_factor", self.recurrence_factor),
            ("replaced_in_vain_factor", self.replaced_in_vain_factor),
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
            unknown_fault: 0.02,
            second_fault: 1e-5,
            found_at: 0.95,
            healthy_at: 0.99,
            least_gain_bits: 0.01,
            doubt_runs: 0.5,
            doubt_runs_intermittent: 3.0,
            doubt_same_part: 0.3,
            doubt_anything: 0.1,
            new_hits: 0.002,
            new_hits_intermittent: 0.03,
            weight_of_step: 0.7,
            unknown_hits: 0.03,
            bring_up_s: 3.0,
            recurrence_factor: 1.5,
            replaced_in_vain_factor: 0.5,
            history_days: 90,
        }
    }
}
