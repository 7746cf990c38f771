//! What decision trees cost to make: `cargo bench -p diagnosis --bench matrix`.
//!
//! At most 20 states × 20 tests the optimal one, 2 000 × 2 000 the greedy one; hard shapes beside
//! random ones.

use divan::Bencher;
use matrix::{Matrix, Method, PlanOptions, Posterior, State, Test, plan};

fn main() {
    divan::main();
}

/// How the cells lie.
#[derive(Clone, Copy, Debug)]
enum Shape {
    /// 0 and 1 alike, costs from 1 to 5.
    Random,
    /// One test in ten detects.
    Sparse,
    /// One test for each state: every subset can be reached.
    Single,
    /// Each test sees all faults up to its place in a chain; each state is half as likely as the
    /// one before it.
    Chain,
    /// Random, one cell in twenty uncertain.
    SomeNoise,
    /// Random, no cell certain: 0.9 for 1, 0.05 for 0.
    AllNoise,
}

const SHAPES: [Shape; 6] = [
    Shape::Random,
    Shape::Sparse,
    Shape::Single,
    Shape::Chain,
    Shape::SomeNoise,
    Shape::AllNoise,
];

#[divan::bench(args = SHAPES, sample_count = 3, sample_size = 1)]
fn optimal_20_by_20(bencher: Bencher, shape: Shape) {
    let matrix = matrix(20, shape);
    bencher.bench_local(|| planned(&matrix, None));
}

#[divan::bench(args = SHAPES, sample_count = 1, sample_size = 1)]
fn greedy_2000_by_2000(bencher: Bencher, shape: Shape) {
    let matrix = matrix(2_000, shape);
    bencher.bench_local(|| planned(&matrix, Some(Method::Greedy)));
}

fn planned(matrix: &Matrix, method: Option<Method>) -> bool {
    let options = PlanOptions {
        method,
        ..PlanOptions::default()
    };
    plan(matrix, &Posterior::prior(matrix), options)
        .expect("a plan")
        .optimal
}

fn matrix(size: usize, shape: Shape) -> Matrix {
    let mut state = 1_u64;
    let mut dice = move || {
        // Knuth's MMIX generator; its high bits are good enough here.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let weights: Vec<f64> = (0..size)
        .map(|i| match shape {
            Shape::Chain => 0.5_f64.powi(i.min(900) as i32),
            _ => 0.1 + dice(),
        })
        .collect();
    let total: f64 = weights.iter().sum();
    let states = weights.iter().enumerate().map(|(i, weight)| State {
        id: format!("s{i}"),
        probability: weight / total,
    });
    let states = states.collect();
    let tests = (0..size)
        .map(|i| Test {
            id: format!("t{i}"),
            cost: 1.0 + 4.0 * dice(),
        })
        .collect();
    let cells = (0..size * size)
        .map(|cell| {
            let (state, test) = (cell / size, cell % size);
            let bit = |p: f64, dice: &mut dyn FnMut() -> f64| f64::from(dice() < p);
            match shape {
                Shape::Random => bit(0.5, &mut dice),
                Shape::Sparse => bit(0.1, &mut dice),
                Shape::Single => f64::from(state == test),
                Shape::Chain => f64::from(state <= test),
                Shape::SomeNoise if dice() < 0.05 => dice(),
                Shape::SomeNoise => bit(0.5, &mut dice),
                Shape::AllNoise => 0.05 + 0.85 * bit(0.5, &mut dice),
            }
        })
        .collect();
    Matrix::new(states, tests, cells).expect("a valid matrix")
}
