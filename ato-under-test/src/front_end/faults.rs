//! Injected faults by place. Only the signal path asks; nothing that judges does.

use alloc::vec::Vec;

use protocol::injection::{Effect, FaultMode, Place};
use protocol::{Duration, Instant};

use crate::random::Random;

/// The faults of this unit and the present time.
#[derive(Debug)]
pub struct Faults {
    modes: Vec<(Place, Effect, Instant)>,
    now: Instant,
    random: Random,
}

impl Faults {
    /// Faults that begin at their onset.
    pub fn new(modes: &[FaultMode], seed: u64) -> Self {
        let modes = modes
            .iter()
            .map(|mode| {
                (
                    mode.place,
                    mode.effect,
                    Instant::ZERO + Duration::from_secs(mode.onset_s),
                )
            })
            .collect();
        Self {
            modes,
            now: Instant::ZERO,
            random: Random::new(seed),
        }
    }

    /// Moves on to the present.
    pub fn step(&mut self, now: Instant) {
        self.now = now;
    }

    /// What is wrong at a place now.
    pub fn at(&self, place: Place) -> Option<Effect> {
        self.modes
            .iter()
            .find(|(at, _, onset)| *at == place && *onset <= self.now)
            .map(|(_, effect, _)| *effect)
    }

    /// True with probability `p`.
    pub fn chance(&mut self, p: f64) -> bool {
        self.random.chance(p)
    }

    /// A frame passing `place` is lost.
    pub fn loses_frame(&mut self, place: Place) -> bool {
        match self.at(place) {
            Some(Effect::Dead) => true,
            Some(Effect::BitErrors { rate }) => self.chance(rate),
            _ => false,
        }
    }
}
