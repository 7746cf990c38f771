//! Weights and probabilities given by their logarithms, as products of many likelihoods are too small for floating
//! point.

/// Scales weights, given by their logarithms, to a sum of 1; if all weights are 0, the results are equal.
pub fn normalised(ln: &[f64]) -> Vec<f64> {
    let greatest = ln.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if greatest == f64::NEG_INFINITY {
        return vec![1.0 / ln.len().max(1) as f64; ln.len()];
    }
    let weights: Vec<_> = ln.iter().map(|ln| (ln - greatest).exp()).collect();
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / sum).collect()
}

/// Logarithm of the sum of numbers given by their logarithms.
pub fn ln_sum(all: impl Iterator<Item = f64> + Clone) -> f64 {
    let greatest = all.clone().fold(f64::NEG_INFINITY, f64::max);
    if greatest == f64::NEG_INFINITY {
        return greatest;
    }
    greatest + all.map(|ln| (ln - greatest).exp()).sum::<f64>().ln()
}
