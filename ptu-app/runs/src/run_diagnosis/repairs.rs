//! How often each part fails, learnt from the repairs of all units in a database.

use std::collections::BTreeMap;

use diagnosis::{Dictionary, Known, Settings};
use fault_db::ConfirmedRepairs;
use protocol::LruId;

use super::history::OwnHistory;

impl OwnHistory {
    /// Weighs the confirmed repairs, counted by part. The dictionary's weights count as `repairs_like_prior` repairs
    /// beside them, so that a few repairs change little and many decide: the mean of a Dirichlet distribution.
    pub(super) fn take_repairs(
        &mut self,
        repairs: &BTreeMap<String, ConfirmedRepairs>,
        dictionary: &Dictionary,
        settings: &Settings,
    ) {
        let parts = dictionary.lrus();
        let count = |part: &LruId| {
            repairs
                .get(part.as_str())
                .map_or(0.0, |of| f64::from(of.repairs))
        };
        // Repairs of what is no part of the unit say nothing of its parts.
        let all: f64 = parts.iter().map(|part| count(part)).sum();
        if all == 0.0 {
            return;
        }
        let mut weights: BTreeMap<&LruId, f64> = BTreeMap::new();
        for mode in &dictionary.modes {
            *weights.entry(&mode.name.lru).or_default() += mode.name.weight;
        }
        let of_all: f64 = weights.values().sum();
        let unweighted = 1.0 / parts.len() as f64;
        for part in parts {
            let expected = match weights.get(part) {
                Some(weight) => weight / of_all,
                None => unweighted,
            };
            let like = settings.repairs_like_prior;
            let share = (count(part) + like * expected) / (all + like);
            *self.factors.entry(part.clone()).or_insert(1.0) *= share / expected;
            if count(part) > 0.0 {
                let [of_part, all] = [count(part), all].map(|repairs| repairs as u32);
                self.add_for(part, Known::OftenRepaired { of_part, all });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use diagnosis::{Basis, ModeName, Observation};

    use super::*;

    fn dictionary() -> Dictionary {
        let mut dictionary = Dictionary::new(Basis::default(), Vec::new(), Vec::new());
        for (part, weight) in [("eb_relay", 1.0), ("io_board", 3.0)] {
            let mode = ModeName {
                id: format!("{part}.dead"),
                lru: LruId::from_static(part),
                text: String::new(),
                kind: "permanent".into(),
                unsafe_: false,
                weight,
            };
            dictionary.add(&mode, String::new(), &[Observation::default()]);
        }
        dictionary
    }

    fn factors(repairs: &[(&str, u32)]) -> BTreeMap<LruId, f64> {
        let confirmed = |repairs| ConfirmedRepairs {
            repairs,
            ..ConfirmedRepairs::default()
        };
        let repairs = repairs
            .iter()
            .map(|(part, n)| ((*part).to_owned(), confirmed(*n)));
        let mut history = OwnHistory::default();
        history.take_repairs(&repairs.collect(), &dictionary(), &Settings::default());
        history.factors
    }

    #[test]
    fn repairs_as_the_weights_expect_them_change_nothing() {
        for (_, factor) in factors(&[("eb_relay", 10), ("io_board", 30)]) {
            assert!((factor - 1.0).abs() < 1e-12, "{factor}");
        }
        assert!(factors(&[("door rubber", 500)]).is_empty());
    }

    #[test]
    fn a_few_repairs_change_little_and_many_decide() {
        let of_relay = |n| factors(&[("eb_relay", n)])["eb_relay"];
        assert!((1.0..1.1).contains(&of_relay(1)), "{}", of_relay(1));
        // With all repairs its own, its share of a quarter becomes nearly the whole.
        assert!((3.8..4.0).contains(&of_relay(2000)), "{}", of_relay(2000));
        let of_board = factors(&[("eb_relay", 2000)])["io_board"];
        assert!((0.02..0.03).contains(&of_board), "{of_board}");
    }
}
