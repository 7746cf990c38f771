//! Mamdani inference [S1 §2.3.3]: 15 rules, minimum for *and*, clipped output sets, their maximum, and the centre of
//! gravity of this maximum.
//!
//! All variables are in units of their outermost peak. Their sets are isosceles triangles that overlap
//! by half, so a value belongs to at most two sets, with degrees that make 1. Beyond the outermost
//! peak a value belongs wholly to the outermost set.

/// Sets of the error: nb, ns, zc, ps, pb; also of the output: nvh, nh, zero, ph, pvh.
const SETS: usize = 5;
/// Distance between the sets' peaks.
const SPACING: f64 = 0.5;

/// Output set of each rule [S1 table 1]; rows: change negative, none, positive; columns: error nb .. pb.
const RULES: [[usize; SETS]; 3] = [[0, 1, 2, 3, 3], [0, 1, 2, 3, 4], [1, 1, 2, 3, 4]];

/// Output for an error and its change. NaN gives the hardest brake.
pub(super) fn infer(error: f64, change: f64) -> f64 {
    if error.is_nan() || change.is_nan() {
        return -1.0;
    }
    let errors: [f64; SETS] = degrees(error.clamp(-1.0, 1.0) / SPACING);
    let changes: [f64; 3] = degrees(change.clamp(-1.0, 1.0));
    let mut heights = [0.0_f64; SETS];
    for (row, change) in RULES.iter().zip(changes) {
        for (&output, error) in row.iter().zip(errors) {
            let fires = error.min(change);
            heights[output] = heights[output].max(fires);
        }
    }
    centre_of_gravity(heights)
}

/// Degrees to which `x` belongs to triangles with peaks one apart, the middle one at 0.
fn degrees<const N: usize>(x: f64) -> [f64; N] {
    let middle = (N / 2) as f64;
    core::array::from_fn(|i| (1.0 - libm::fabs(x + middle - i as f64)).max(0.0))
}

/// Centre of gravity of the output sets, each clipped at its height.
///
/// Exact: between two peaks only their two sets count, and beyond the outermost ones a flank each. So
/// the area is a row of trapezoids.
fn centre_of_gravity(heights: [f64; SETS]) -> f64 {
    let mut shape = Shape::default();
    let padded = |i: usize| {
        if (1..=SETS).contains(&i) {
            heights[i - 1]
        } else {
            0.0
        }
    };
    for i in 0..=SETS {
        // Place of the left one of the two peaks, in spacings.
        let peak = i as f64 - 3.0;
        shape.add_between(peak, padded(i), padded(i + 1));
    }
    SPACING * shape.moment / shape.area
}

/// Area and first moment.
#[derive(Clone, Default)]
struct Shape {
    area: f64,
    moment: f64,
}

impl Shape {
    /// Adds the space between two peaks one apart, whose sets are clipped at `left` and `right`.
    fn add_between(&mut self, peak: f64, left: f64, right: f64) {
        // The falling flank begins at 1 − left and the rising one ends at right; where both are
        // above a half they meet in the middle, else the higher set comes down or up to the lower one.
        let (from, to) = if left.min(right) >= 0.5 {
            self.add(peak, (1.0 - left, left), (0.5, 0.5));
            self.add(peak, (0.5, 0.5), (right, right));
            (1.0 - left, right)
        } else if left > right {
            self.add(peak, (1.0 - left, left), (1.0 - right, right));
            (1.0 - left, 1.0 - right)
        } else {
            self.add(peak, (left, left), (right, right));
            (left, right)
        };
        self.add(peak, (0.0, left), (from, left));
        self.add(peak, (to, right), (1.0, right));
    }

    /// Adds the trapezoid under the line from one point to the other, `(x, height)`.
    fn add(&mut self, origin: f64, (x0, y0): (f64, f64), (x1, y1): (f64, f64)) {
        let area = 0.5 * (x1 - x0) * (y0 + y1);
        let third = (x1 - x0) / 3.0;
        // The centre lies on the side of the higher end: first moment about x0 is w²(y0 + 2y1)/6.
        let moment_about_x0 = 0.5 * third * (x1 - x0) * (y0 + 2.0 * y1);
        self.area += area;
        self.moment += area * (origin + x0) + moment_about_x0;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// At the peaks of both inputs one rule fires alone, so its output set's own peak comes out:
    /// S1's table, read as nvh = -1 .. pvh = 1.
    #[test]
    fn each_rule_alone_gives_its_output() {
        let table = [
            (-1.0, [-1.0, -0.5, 0.0, 0.5, 0.5]),
            (0.0, [-1.0, -0.5, 0.0, 0.5, 1.0]),
            (1.0, [-0.5, -0.5, 0.0, 0.5, 1.0]),
        ];
        for (change, row) in table {
            for (error, expected) in [-1.0, -0.5, 0.0, 0.5, 1.0].into_iter().zip(row) {
                let got = infer(error, change);
                assert!((got - expected).abs() < 1e-12, "{error} {change}: {got}");
            }
        }
    }

    /// S1's eq. 6 summed over a fine grid of the output.
    fn summed(heights: [f64; SETS]) -> f64 {
        let steps = 60_000;
        let (mut area, mut moment) = (0.0, 0.0);
        for i in 0..steps {
            let y = -1.5 + 3.0 * (f64::from(i) + 0.5) / f64::from(steps);
            let sets: [f64; SETS] = degrees(y / SPACING);
            let height = sets
                .iter()
                .zip(heights)
                .fold(0.0_f64, |h, (set, clip)| h.max(set.min(clip)));
            area += height;
            moment += height * y;
        }
        moment / area
    }

    #[test]
    fn the_centre_is_that_of_the_printed_sum() {
        for heights in [
            [0.0, 0.0, 0.3, 0.7, 0.0],
            [0.0, 0.0, 0.8, 0.6, 0.0],
            [0.2, 0.4, 0.9, 0.1, 0.5],
            [1.0, 1.0, 1.0, 1.0, 0.2],
            [0.0, 0.0, 0.0, 0.5, 0.5],
        ] {
            let (got, expected) = (centre_of_gravity(heights), summed(heights));
            assert!(
                (got - expected).abs() < 1e-6,
                "{heights:?}: {got}, sum {expected}"
            );
        }
    }

    #[test]
    fn nan_brakes_and_infinity_belongs_to_the_outermost_set() {
        assert_eq!(infer(f64::NAN, 0.0), -1.0);
        assert_eq!(infer(1.0, f64::NAN), -1.0);
        assert_eq!(infer(f64::INFINITY, f64::INFINITY), infer(1.0, 1.0));
        assert_eq!(infer(f64::NEG_INFINITY, 0.0), infer(-1.0, 0.0));
    }

    proptest! {
        #[test]
        fn odd_bounded_and_without_jumps(e in -2.0..2.0_f64, de in -2.0..2.0_f64) {
            let got = infer(e, de);
            prop_assert!(got.abs() <= 1.0 + 1e-12);
            prop_assert!((got + infer(-e, -de)).abs() < 1e-12, "not odd");
            let h = 1e-6;
            for near in [infer(e + h, de), infer(e, de + h)] {
                prop_assert!((near - got).abs() < 20.0 * h, "jumps from {got} to {near}");
            }
        }

        /// More error asks for no less force. The printed rules themselves take back up to 3 % of it
        /// when an error beyond `ps` shrinks fast: (negative, pb) lifts the whole of `ph` beside a
        /// sliver of `pvh`.
        #[test]
        fn monotone_in_the_error(e in -1.2..1.2_f64, more in 0.0..1.0_f64, de in -1.2..1.2_f64) {
            prop_assert!(infer(e + more, 0.0) >= infer(e, 0.0) - 1e-12);
            prop_assert!(infer(e + more, de) >= infer(e, de) - 0.03);
        }
    }
}
