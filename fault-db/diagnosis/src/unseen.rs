//! What a fault mode that nobody has seen yet may act like.
//!
//! The modes of a part act on the checks through which the part's signals pass. A new mode acts like another mode of
//! the part, or like a mode of another part on the same way: the likelier, the more the modes of both parts act on the
//! same checks. The likeness counts squared, as most checks pass through many parts.

use protocol::LruId;

use super::dictionary::{Dictionary, Mode};

/// How often the modes of a part act on each check, scaled to a sum of squares of 1; zeros for a part without modes.
type Profile = Vec<f64>;

/// Logarithms of the probability that an unseen mode of each part acts like each effect (a level of a mode) of the dictionary,
/// by part and effect. `other_part` is the least likeness of two parts, 0 to 1.
pub fn resemblance(dictionary: &Dictionary, parts: &[&LruId], other_part: f64) -> Vec<Vec<f64>> {
    let modes = &dictionary.modes;
    let part_of = |mode: &Mode| parts.iter().position(|part| **part == mode.name.lru);
    let parts_of_modes: Vec<Option<usize>> = modes.iter().map(part_of).collect();
    let of_part = |part: usize| {
        let of_modes = modes.iter().zip(&parts_of_modes);
        of_modes.filter_map(move |(mode, of)| (*of == Some(part)).then_some(mode))
    };
    let numbers = 0..parts.len();
    let checks = dictionary.checks.len();
    let profile = |part| profile(of_part(part), checks);
    let profiles: Vec<Profile> = numbers.clone().map(profile).collect();
    let weight = |part| of_part(part).map(|mode| mode.name.weight).sum::<f64>();
    let weights: Vec<f64> = numbers.clone().map(weight).collect();
    let like_each = |part: usize| -> Vec<f64> {
        let alike = |other: usize| match other == part {
            true => 1.0,
            false => other_part + likeness(&profiles[part], &profiles[other]).powi(2),
        };
        let alike: Vec<f64> = numbers.clone().map(alike).collect();
        let shares = modes.iter().zip(&parts_of_modes).flat_map(|(mode, other)| {
            let other = other.unwrap_or(part);
            let levels = mode.columns.len();
            let share = alike[other] * mode.name.weight / weights[other] / levels as f64;
            std::iter::repeat_n(share, levels)
        });
        let shares: Vec<f64> = shares.collect();
        let all: f64 = shares.iter().sum();
        shares.into_iter().map(|share| (share / all).ln()).collect()
    };
    numbers.clone().map(like_each).collect()
}

fn profile<'a>(modes: impl Iterator<Item = &'a Mode>, checks: usize) -> Profile {
    let mut profile = vec![0.0; checks];
    for mode in modes {
        for column in &mode.columns {
            for place in column.cells.keys() {
                profile[*place] += 1.0 / mode.columns.len() as f64;
            }
        }
    }
    let length = likeness(&profile, &profile).sqrt();
    profile
        .iter_mut()
        .for_each(|share| *share /= length.max(f64::MIN_POSITIVE));
    profile
}

/// Cosine of the angle between two profiles: 1 if they are equal, 0 if they have no check in common.
fn likeness(one: &Profile, other: &Profile) -> f64 {
    one.iter().zip(other).map(|(one, other)| one * other).sum()
}
