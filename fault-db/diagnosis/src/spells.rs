//! Faults that come and go: each fault's spells come less or more often than the dictionary counted.
//!
//! Spells that begin at random, at a rate, spare a check with the probability exp(-rate × exposure) (a Poisson process).
//! The exposure of a check to a fault is in its counts; so a check that passed with probability `p` passes with `p^k` where
//! the spells come `k` times as often. The rate is the fault's and holds for all checks of a run: many failures tell of a
//! fault that comes often, in those checks, too, that it spared.

use protocol::Verdict;

use super::belief::ln_sum;
use super::settings::Settings;

/// Number of rates.
pub const RATES: usize = 3;
/// Place of the rate that was counted.
pub const AS_COUNTED: usize = 0;

/// Rates of spells: as counted, less often, more often.
pub fn rates(settings: &Settings) -> [f64; RATES] {
    [1.0, 1.0 / settings.spell_rate, settings.spell_rate]
}

/// Factor on the likelihood of a result where spells come `rate` times as often as under the counts, by which the check
/// passes with probability `passes`, above 0 and below 1.
pub fn factor(result: Verdict, passes: f64, rate: f64) -> f64 {
    let at_rate = passes.powf(rate);
    match result {
        Verdict::Passed => at_rate / passes,
        _ => (1.0 - at_rate) / (1.0 - passes),
    }
}

/// Logarithm of a likelihood over all rates, of its logarithm at each.
pub fn over_rates(at_rates: [f64; RATES], settings: &Settings) -> f64 {
    let other = settings.other_spells / (RATES - 1) as f64;
    let weighted = at_rates.iter().enumerate().map(|(rate, ln)| {
        let share = match rate {
            AS_COUNTED => 1.0 - settings.other_spells,
            _ => other,
        };
        share.ln() + ln
    });
    ln_sum(weighted)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the rate, a check passes or does not.
    #[test]
    fn results_at_any_rate_are_probabilities() {
        for passes in [0.01, 0.5, 0.999] {
            for rate in [0.2, 1.0, 5.0] {
                let passed = passes * factor(Verdict::Passed, passes, rate);
                let failed = (1.0 - passes) * factor(Verdict::Failed, passes, rate);
                assert!((passed + failed - 1.0).abs() < 1e-12, "{passes} at {rate}");
            }
        }
        assert!(factor(Verdict::Failed, 0.9, 3.0) > 2.5);
    }
}
