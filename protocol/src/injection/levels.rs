//! Levels of a fault mode: the numbers its effect may have, the strengths of intermittent ones, and the kinds
//! of modes that follow from both.

use serde::{Deserialize, Serialize};

use alloc::vec::Vec;

use super::{Effect, FaultMode};

/// Greatest effort; a limit begins here and falls as the fault grows [S0: 1024 steps].
const FULL_EFFORT: f64 = 1024.0;
/// Strength from which on an effect without a number acts.
const HALF: f64 = 0.5;

crate::labelled! {
    /// How a fault mode acts: all the time, now and then, or in part.
    #[derive(
        Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema,
    )]
    #[serde(rename_all = "snake_case")]
    pub enum FaultKind: word {
        /// Something does not work, all the time.
        Permanent = "permanent",
        /// The fault comes and goes, by time, speed or warmth.
        Intermittent = "intermittent",
        /// Something works, but not as well as it should.
        Degraded = "degraded",
    }
}

impl FaultMode {
    /// What kind of fault this is.
    pub fn kind(&self) -> FaultKind {
        match self.effect {
            _ if !self.occurs.is_always() => FaultKind::Intermittent,
            Effect::Dead | Effect::StuckOn | Effect::StuckOff => FaultKind::Permanent,
            _ => FaultKind::Degraded,
        }
    }

    /// The mode at a level: 0 = as it is written, from 1 on the numbers of `levels`; `None` beyond.
    pub fn at_level(&self, level: usize) -> Option<Self> {
        let Some(listed) = level.checked_sub(1) else {
            return Some(self.clone());
        };
        let number = *self.levels.get(listed)?;
        Some(Self {
            effect: self.effect.with_number(number),
            ..self.clone()
        })
    }

    /// Pairs of neighbouring levels on the same side of a good part: the mode may have any size between the two.
    pub fn next_levels(&self) -> Vec<[usize; 2]> {
        let sizes = (0..=self.levels.len()).filter_map(|level| {
            let size = self.at_level(level)?.effect.size()?;
            (size != 0.0).then_some((size, level))
        });
        let mut sizes: Vec<_> = sizes.collect();
        sizes.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        let next = sizes.windows(2);
        let one_sided = next.filter(|next| next[0].0.signum() == next[1].0.signum());
        one_sided.map(|next| [next[0].1, next[1].1]).collect()
    }
}

impl Effect {
    /// Difference between the effect's number and that of a good part; `None` for an effect without a number.
    fn size(self) -> Option<f64> {
        match self {
            Self::Dead | Self::StuckOn | Self::StuckOff | Self::Deaf { .. } => None,
            Self::Gain { factor } => Some(factor - 1.0),
            Self::Limit { to } => Some(to - FULL_EFFORT),
            Self::Offset { by: number }
            | Self::Noise { per_s: number }
            | Self::BitErrors { rate: number } => Some(number),
            Self::Delay { ms } | Self::Bounce { ms } => Some(f64::from(ms)),
        }
    }

    /// The effect at a strength of 0 to 1; `None` when it does not act.
    pub fn at_strength(self, strength: f64) -> Option<Self> {
        if strength <= 0.0 {
            return None;
        }
        let share = strength.min(1.0);
        Some(match self {
            Self::Dead | Self::StuckOn | Self::StuckOff | Self::Deaf { .. } => {
                return (share >= HALF).then_some(self);
            }
            Self::Gain { factor } => self.with_number(1.0 + (factor - 1.0) * share),
            Self::Limit { to } => self.with_number(FULL_EFFORT + (to - FULL_EFFORT) * share),
            Self::Offset { by: number }
            | Self::Noise { per_s: number }
            | Self::BitErrors { rate: number } => self.with_number(number * share),
            Self::Delay { ms } | Self::Bounce { ms } => self.with_number(f64::from(ms) * share),
        })
    }

    /// This effect with another number; an effect without a number stays as it is.
    fn with_number(self, number: f64) -> Self {
        match self {
            Self::Dead | Self::StuckOn | Self::StuckOff | Self::Deaf { .. } => self,
            Self::Gain { .. } => Self::Gain { factor: number },
            Self::Offset { .. } => Self::Offset { by: number },
            Self::Limit { .. } => Self::Limit { to: number },
            Self::Delay { .. } => Self::Delay { ms: number as u32 },
            Self::Bounce { .. } => Self::Bounce { ms: number as u32 },
            Self::Noise { .. } => Self::Noise { per_s: number },
            Self::BitErrors { .. } => Self::BitErrors { rate: number },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_grow_with_the_strength_and_contacts_turn_over_at_half() {
        let gain = Effect::Gain { factor: 0.8 };
        assert_eq!(gain.at_strength(0.0), None);
        assert_eq!(gain.at_strength(0.5), Some(Effect::Gain { factor: 0.9 }));
        assert_eq!(gain.at_strength(1.0), Some(gain));
        let limit = Effect::Limit { to: 300.0 };
        assert_eq!(limit.at_strength(0.5), Some(Effect::Limit { to: 662.0 }));
        let delay = Effect::Delay { ms: 400 };
        assert_eq!(delay.at_strength(0.25), Some(Effect::Delay { ms: 100 }));
        let rate = Effect::BitErrors { rate: 0.6 };
        assert_eq!(rate.at_strength(0.5), Some(Effect::BitErrors { rate: 0.3 }));
        assert_eq!(Effect::StuckOn.at_strength(0.49), None);
        assert_eq!(Effect::StuckOn.at_strength(0.5), Some(Effect::StuckOn));
    }
}
