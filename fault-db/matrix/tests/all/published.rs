//! Examples of the literature on diagnosis. What they are is taken from it; what comes out is derived here.
//!
//! The circuits are those of de Kleer and Williams ("Diagnosing multiple faults", Artificial Intelligence 32,
//! 1987), the matrix of five faults is one by which Pattipati, Alexandridis, Raghavan and Shakeri explain test
//! sequencing (IEEE Trans. SMC 20(4), 1990, and SMC-A 29(2), 1999). The papers were not at hand: the
//! examples are written from memory, no result is quoted, and each expected value follows from the definition by
//! trying everything.

use ::matrix::{Matrix, Method, Outcome, Posterior};

use super::matrix::{exhaustive_crisp, exhaustive_noisy, near, planned, prior, test, weighted};

/// Probability that a component has failed, before anything is measured.
const FAILED: f64 = 0.01;

/// Probability that just the components of a set, as bits, have failed.
fn of_failed(set: u32, components: u32) -> f64 {
    let failed = set.count_ones();
    FAILED.powi(failed as i32) * (1.0 - FAILED).powi((components - failed) as i32)
}

/// The polybox: multipliers M1, M2, M3 make x = ac, y = bd, z = ce of 3, 2, 2, 3, 3; adders A1, A2 make
/// f = x + y and g = y + z. Seen are f = 10 and g = 12. Gives for each set of failed components (M1 is the
/// lowest bit, A2 the highest) all x, y, z that agree with it.
fn polybox() -> Vec<(u32, Vec<[i32; 3]>)> {
    const VALUES: std::ops::RangeInclusive<i32> = 0..=12;
    let all = VALUES.flat_map(|x| VALUES.flat_map(move |y| VALUES.map(move |z| [x, y, z])));
    let all: Vec<_> = all.collect();
    (0..32_u32)
        .map(|failed| {
            let agrees = |[x, y, z]: &[i32; 3]| {
                let works = [*x == 6, *y == 6, *z == 6, x + y == 10, y + z == 12];
                (0..5).all(|part| failed >> part & 1 == 1 || works[part])
            };
            (failed, all.iter().copied().filter(agrees).collect())
        })
        .filter(|(_, values): &(_, Vec<_>)| !values.is_empty())
        .collect()
}

/// What fails where nothing is measured yet: A1, M1, A2 with M2, M2 with M3, and all that hold one of these.
#[test]
fn the_polybox_has_four_least_sets_of_failed_parts() {
    let sets: Vec<u32> = polybox().into_iter().map(|(failed, _)| failed).collect();
    let holds = |set: u32, other: u32| other != set && other & set == other;
    let least = |set: &&u32| !sets.iter().any(|other| holds(**set, *other));
    let least: Vec<u32> = sets.iter().filter(least).copied().collect();
    let (m1, m2, m3, a1, a2) = (1, 2, 4, 8, 16);
    assert_eq!(least, [m1, m2 | m3, a1, m2 | a2]);
}

/// Goal: the first measurement is the one that tells M1 from A1, and Bayes' rule names the part after it.
#[test]
fn the_polybox_is_measured_at_x_first() {
    let candidates = polybox();
    let weights: Vec<f64> = candidates
        .iter()
        .map(|(set, _)| of_failed(*set, 5))
        .collect();
    let names = candidates.iter().map(|(set, _)| format!("{set:05b}"));
    let states = weighted(names.zip(weights.iter().copied()));
    // A test fails where the value is not 6; each value that agrees is as likely as any other.
    let cell = |values: &[[i32; 3]], place: usize| {
        let wrong = values.iter().filter(|value| value[place] != 6).count();
        wrong as f64 / values.len() as f64
    };
    let cells = candidates
        .iter()
        .flat_map(|(_, values)| [0, 1, 2].map(|place| cell(values, place)));
    let tests = ["x", "y", "z"].map(|id| test(id, 1.0)).to_vec();
    let matrix = Matrix::new(states, tests, cells.collect()).expect("a valid matrix");

    let wanted = exhaustive_noisy(&matrix, &prior(&matrix), &mut vec![false; 3]);
    for method in [Method::Optimal, Method::Greedy] {
        let made = planned(&matrix, method);
        assert_eq!(made.tree.first_test(), Some(0), "{method:?}");
        near(made.expected_cost, wanted, 0);
    }
    for (outcome, wrong, part) in [(Outcome::Fail, true, 1), (Outcome::Pass, false, 8)] {
        let known = Posterior::given(&matrix, &[("x".into(), outcome)]).expect("it can be so");
        let mut left = Vec::new();
        for ((set, values), weight) in candidates.iter().zip(&weights) {
            let so = values.iter().filter(|value| (value[0] != 6) == wrong);
            let share = so.count() as f64 / values.len() as f64;
            left.push((set & part != 0, weight * share));
        }
        let all: f64 = left.iter().map(|(_, weight)| weight).sum();
        let with_part = left.iter().filter(|(has, _)| *has);
        let wanted = with_part.map(|(_, weight)| weight).sum::<f64>() / all;
        let found = candidates.iter().enumerate();
        let found = found.filter(|(_, (set, _))| set & part != 0);
        let found: f64 = found.map(|(state, _)| known.probability(state)).sum();
        near(found, wanted, 0);
        assert!(found > 0.95, "{found}");
    }
}

/// Four inverters A, B, C and D in a row make b, c, d and e of a; e is wrong. A failed one gives 0 or 1, as
/// likely. Goal: the row is halved at c, then the half that is left: two measurements for each single fault.
#[test]
fn a_row_of_four_inverters_is_halved_twice() {
    let mut states = Vec::new();
    let mut cells = Vec::new();
    for failed in 1..16_u32 {
        // What the inverters make wrong of their own, as bits: any of those that have failed.
        let own = (0..16_u32).filter(|own| own & !failed == 0);
        let is_wrong = |own: u32, net: u32| (own & ((2 << net) - 1)).count_ones() % 2 == 1;
        let seen: Vec<u32> = own.filter(|own| is_wrong(*own, 3)).collect();
        let share = |net| {
            let wrong = seen.iter().filter(|own| is_wrong(**own, net)).count();
            wrong as f64 / seen.len() as f64
        };
        cells.extend([0, 1, 2].map(share));
        let explains = seen.len() as f64 / f64::from(1 << failed.count_ones());
        states.push((format!("{failed:04b}"), of_failed(failed, 4) * explains));
    }
    let tests = ["b", "c", "d"].map(|id| test(id, 1.0)).to_vec();
    let states = weighted(states.into_iter());
    let matrix = Matrix::new(states, tests, cells).expect("a valid matrix");
    let wanted = exhaustive_noisy(&matrix, &prior(&matrix), &mut vec![false; 3]);
    assert!((wanted - 2.0).abs() < 0.02, "{wanted}");
    for method in [Method::Optimal, Method::Greedy] {
        let made = planned(&matrix, method);
        assert_eq!(made.tree.first_test(), Some(1), "{method:?}");
        near(made.expected_cost, wanted, 0);
    }
}

/// A sound system and five faults, one of which may be there; five tests of equal cost.
#[test]
fn the_matrix_of_five_faults_is_solved_as_by_trying_everything() {
    let rows = [
        (0.70, [0.0, 0.0, 0.0, 0.0, 0.0]),
        (0.01, [0.0, 1.0, 0.0, 0.0, 1.0]),
        (0.02, [0.0, 0.0, 1.0, 1.0, 0.0]),
        (0.10, [1.0, 0.0, 0.0, 1.0, 1.0]),
        (0.05, [1.0, 1.0, 0.0, 0.0, 0.0]),
        (0.12, [1.0, 1.0, 1.0, 1.0, 0.0]),
    ];
    let states = rows.iter().enumerate();
    let states = weighted(states.map(|(i, (probability, _))| (format!("s{i}"), *probability)));
    let tests = (1..=5).map(|i| test(&format!("t{i}"), 1.0));
    let cells = rows.iter().flat_map(|(_, cells)| *cells);
    let matrix = Matrix::new(states, tests.collect(), cells.collect());
    let matrix = matrix.expect("a valid matrix");
    let wanted = exhaustive_crisp(&matrix, &[0, 1, 2, 3, 4, 5]);
    // As the search that tries everything has it.
    near(wanted, 2.18, 0);
    for method in [Method::Optimal, Method::Greedy] {
        near(planned(&matrix, method).expected_cost, wanted, 0);
    }
}
