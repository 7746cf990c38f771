//! Entropies, in bits.

/// Entropy of a test with two outcomes, of which one has the probability `p`.
pub(crate) fn binary_entropy(p: f64) -> f64 {
    if p <= 0.0 || p >= 1.0 {
        return 0.0;
    }
    -(p * p.log2() + (1.0 - p) * (1.0 - p).log2())
}

/// Entropy of weights that need not add up to 1; 0 without weights.
pub(crate) fn entropy(weights: impl Iterator<Item = f64> + Clone) -> f64 {
    let total: f64 = weights.clone().sum();
    if total <= 0.0 {
        return 0.0;
    }
    weights
        .map(|weight| weight / total)
        .filter(|p| *p > 0.0)
        .map(|p| -p * p.log2())
        .sum()
}

/// The most information that a test can give if its probability to fail lies in `low..=high`: the capacity of the
/// binary channel with these two inputs.
pub(crate) fn capacity(low: f64, high: f64) -> f64 {
    let width = high - low;
    if width <= 0.0 {
        return 0.0;
    }
    let slope = (binary_entropy(high) - binary_entropy(low)) / width;
    // The entropy lies furthest above the chord where it rises as steeply as the chord.
    let best = 1.0 / (1.0 + slope.exp2());
    binary_entropy(best) - binary_entropy(low) - (best - low) * slope
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        assert!((binary_entropy(0.5) - 1.0).abs() < 1e-15);
        // 0.11 · log2(1/0.11) + 0.89 · log2(1/0.89) = 0.350285 + 0.149631
        assert!((binary_entropy(0.11) - 0.499_916).abs() < 1e-6);
        assert_eq!(entropy([0.0, 3.0].into_iter()), 0.0);
        assert!((entropy([2.0; 8].into_iter()) - 3.0).abs() < 1e-15);
    }

    #[test]
    fn capacity_of_the_symmetric_and_of_the_z_channel() {
        // 1 − h(0.1), and log2(5/4) for the Z channel of one half (Cover and Thomas).
        assert!((capacity(0.1, 0.9) - (1.0 - binary_entropy(0.1))).abs() < 1e-12);
        assert!((capacity(0.0, 0.5) - 1.25_f64.log2()).abs() < 1e-12);
        assert_eq!(capacity(0.3, 0.3), 0.0);
        assert!((capacity(0.0, 1.0) - 1.0).abs() < 1e-15);
    }
}
