//! What the suite finds, without a dictionary.

use btu_rig::procedure::plan::Connection;
use protocol::injection::FaultMode;

use super::{Purpose, Request, Sample, Suite, SuiteRun, samples};
use crate::pool;
use crate::stop::Stop;
use crate::test_support::scripts;

fn runs(suite: &Suite, samples: &[Sample]) -> Vec<SuiteRun> {
    let stop = Stop::default();
    let one = |i: usize| suite.run(&samples[i], &stop);
    let runs = pool::run(samples.len(), 2, &stop, &mut |_| {}, one);
    runs.into_iter().map(|(_, run)| run).collect()
}

/// Goal: a laptop alone detects at least 90 % of the fault modes that the catalogue declares within its reach.
/// Method: each at all its levels, on a unit that differs as good ones do.
#[test]
fn a_laptop_alone_finds_nine_in_ten_of_what_is_within_its_reach() {
    let suite = Suite::load(&scripts(), Connection::Ptu).unwrap();
    let modes = suite.catalogue.faults.iter();
    let reachable: Vec<&FaultMode> = modes.filter(|mode| mode.out_of_reach.is_none()).collect();
    let asked = Request {
        faults: None,
        seeds: 0,
        held_out: 1,
        good: 0,
        jobs: 2,
    };
    let samples = samples(&reachable, &asked);
    let missed: Vec<_> = runs(&suite, &samples)
        .into_iter()
        .zip(&samples)
        .filter(|(run, _)| run.passed)
        .filter_map(|(_, sample)| sample.mode())
        .collect();
    assert!(10 * missed.len() <= samples.len(), "missed: {missed:?}");
}

/// Goal: one fault, one part: a unit that its supply starts again and again is the finding of every procedure in which
/// it does, and none of them is an error of the bench. Method: twelve seeds of the whole suite.
#[test]
fn a_supply_that_dips_when_warm_fails_the_suite_and_is_no_error_of_the_bench() {
    let suite = Suite::load(&scripts(), Connection::Btu).unwrap();
    let mode = suite.catalogue.fault("power_supply.dips_when_warm");
    let of = |seed: u64| Sample {
        purpose: Purpose::Assessment,
        fault: mode.cloned(),
        sets_in_s: 0.0,
        level: 0,
        seed,
    };
    let samples: Vec<_> = (1..=12).map(of).collect();
    for (run, sample) in runs(&suite, &samples).into_iter().zip(&samples) {
        assert!(!run.passed, "seed {}", sample.seed);
        let errors = run
            .not_passed
            .iter()
            .filter(|what| what.contains(": error "));
        let errors: Vec<_> = errors.collect();
        assert!(errors.is_empty(), "seed {}: {errors:?}", sample.seed);
    }
}
