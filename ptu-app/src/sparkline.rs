//! A series of values as one line of text.

/// Characters for bars, the lowest first.
pub const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// Counts as bars up to the greatest count; a dot for 0.
pub fn sparkline(counts: &[u64]) -> String {
    let most = counts.iter().copied().max().unwrap_or(0);
    let bar = |count: u64| match count {
        0 => '·',
        _ => BARS[((count * 8).div_ceil(most) as usize - 1).min(7)],
    };
    counts.iter().map(|count| bar(*count)).collect()
}

/// Values as bars from the least to the greatest; a missing value leaves a gap.
pub fn sparkline_of(values: &[Option<f64>]) -> String {
    let known = || values.iter().flatten().copied();
    let (least, most) = (
        known().fold(f64::INFINITY, f64::min),
        known().fold(f64::NEG_INFINITY, f64::max),
    );
    let bar = |value: f64| match most > least {
        true => BARS[((value - least) / (most - least) * 7.0).round() as usize % 8],
        false => BARS[3],
    };
    values.iter().map(|value| value.map_or(' ', bar)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_grow_with_counts_and_values() {
        assert_eq!(sparkline(&[0, 1, 4, 8]), "·▁▄█");
        assert_eq!(sparkline(&[0, 0]), "··");
        assert_eq!(sparkline_of(&[Some(0.42), None, Some(0.58)]), "▁ █");
        assert_eq!(sparkline_of(&[Some(1.0), Some(1.0)]), "▄▄");
        assert_eq!(sparkline_of(&[]), "");
    }
}
