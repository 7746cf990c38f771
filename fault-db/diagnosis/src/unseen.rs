//! What a fault mode that nobody has seen yet may act like.
//!
//! The modes of a part act on the checks that its signals pass. A new mode of it acts like one of them, or like a mode
//! of a part on the same way: that is the likelier, the more alike the checks are which the modes of both act on. Much
//! of what a suite does passes many parts: likeness counts squared.

use std::collections::BTreeMap;

use protocol::LruId;

use super::dictionary::{Dictionary, Mode};

/// How often the modes of a part act on each check.
type Profile = BTreeMap<usize, f64>;

/// For each of the parts, logarithms of the probability that an unseen mode of it acts like each effect of the
/// dictionary, a level of a mode, in order. `other_part` is the least likeness of two parts, 0 to 1.
pub fn resemblance(dictionary: &Dictionary, parts: &[&LruId], other_part: f64) -> Vec<Vec<f64>> {
    let modes_of = |part: &LruId| -> Vec<&Mode> {
        let modes = dictionary.modes.iter();
        modes.filter(|mode| mode.name.lru == *part).collect()
    };
    let profiles: Vec<Profile> = parts.iter().map(|part| profile(&modes_of(part))).collect();
    let place_of = |mode: &Mode| parts.iter().position(|part| **part == mode.name.lru);
    let of_part = |part: usize| -> Vec<f64> {
        let weights = dictionary.modes.iter().flat_map(|mode| {
            let other = place_of(mode).unwrap_or(part);
            let alike = match other == part {
                true => 1.0,
                false => other_part + likeness(&profiles[part], &profiles[other]).powi(2),
            };
            let of_part: f64 = modes_of(parts[other])
                .iter()
                .map(|mode| mode.name.weight)
                .sum();
            let share = alike * mode.name.weight / of_part / mode.columns.len() as f64;
            std::iter::repeat_n(share, mode.columns.len())
        });
        let weights: Vec<f64> = weights.collect();
        let all: f64 = weights.iter().sum();
        weights
            .into_iter()
            .map(|weight| (weight / all).ln())
            .collect()
    };
    (0..parts.len()).map(of_part).collect()
}

/// Logarithms of the probability of each effect, where it is not known of which part: by the weights of the modes.
pub fn frequency(dictionary: &Dictionary) -> Vec<f64> {
    let all: f64 = dictionary.modes.iter().map(|mode| mode.name.weight).sum();
    let effects = dictionary.modes.iter().flat_map(|mode| {
        let levels = mode.columns.len();
        std::iter::repeat_n((mode.name.weight / all / levels as f64).ln(), levels)
    });
    effects.collect()
}

fn profile(modes: &[&Mode]) -> Profile {
    let mut profile = Profile::new();
    for mode in modes {
        for column in &mode.columns {
            for place in column.cells.keys() {
                *profile.entry(*place).or_default() += 1.0 / mode.columns.len() as f64;
            }
        }
    }
    profile
}

/// Cosine of the angle between two profiles: 1 of the same, 0 where no check is common.
fn likeness(one: &Profile, other: &Profile) -> f64 {
    let common = one
        .iter()
        .filter_map(|(place, share)| Some(share * other.get(place)?));
    let length = |profile: &Profile| {
        profile
            .values()
            .map(|share| share * share)
            .sum::<f64>()
            .sqrt()
    };
    let lengths = length(one) * length(other);
    if lengths > 0.0 {
        common.sum::<f64>() / lengths
    } else {
        0.0
    }
}
