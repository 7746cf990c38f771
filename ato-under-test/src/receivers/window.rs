//! What receivers measure in a window of values.

use core::f32::consts::{PI, TAU};

use super::downmix::Phasor;

/// Mean of `of(value)` over all values, weighted by a Hann window.
pub(super) fn mean_of(values: &[f32], of: impl Fn(f32) -> f32) -> f32 {
    let weighted = values.iter().zip(hann(values.len()));
    let sum: f32 = weighted.map(|(value, w)| of(*value) * w).sum();
    sum * 2.0 / values.len() as f32
}

/// Power of the values around their mean, mV², weighted by a Hann window.
pub(super) fn power_around(values: &[f32], mean: f32) -> f32 {
    mean_of(values, |value| (value - mean) * (value - mean))
}

/// The share of the time that a keyed carrier is on, from the amplitude of the fundamental over the mean: that is
/// 2 sin(πd) / πd, which falls from 2 to 0. The mean and the fundamental pass the filter whole, the edges do not.
pub(super) fn on_share(fundamental: f32) -> f32 {
    let (mut low, mut high) = (0.05, 0.95);
    for _ in 0..16 {
        let middle = 0.5 * (low + high);
        match 2.0 * libm::sinf(PI * middle) / (PI * middle) > fundamental {
            true => low = middle,
            false => high = middle,
        }
    }
    low
}

pub(super) fn hann(length: usize) -> impl Iterator<Item = f32> {
    let turn = Phasor::at(TAU / length as f32);
    let mut at = Phasor::at(PI / length as f32);
    (0..length).map(move |_| {
        let value = 0.5 - 0.5 * at.re;
        at = at.times(turn);
        value
    })
}

pub(super) fn wrapped(angle: f32) -> f32 {
    angle - TAU * libm::roundf(angle / TAU)
}
