//! Good units pass all procedures in any order, and workers keep their limits.

use btu_rig::procedure::{Procedure, RunOptions, Verdict};
use protocol::Duration;
use protocol::Random;

use super::*;
use crate::run::select;
use crate::test_support::{Heard, procedures, scripts, setup};

/// Goal: procedures do not lean on a fresh unit, so that a unit on a port passes them all in a
/// row. Method: all of them, forward and backward, on one embedded unit in virtual time.
#[test]
fn procedures_pass_in_any_order_on_a_unit_that_is_never_powered_off() {
    let setup = setup(&[]);
    let procedures = procedures(&setup);
    let backward = procedures.iter().rev();
    let row = procedures.iter().chain(backward);
    all_pass(&setup, row.map(|procedure| (procedure.clone(), 1)));
}

/// Goal: neither does the order of procedures nor repeating them fail a good unit. Method: the default
/// ones, drawn by a seed and each once or twice, on units, trains and benches as good ones differ.
#[test]
fn good_units_pass_procedures_repeated_and_in_random_order() {
    random_order(&[1, 2], 1);
}

#[test]
#[ignore = "long suite: the default procedures a hundred times on one unit"]
fn a_good_unit_passes_procedures_a_hundred_times_in_random_order() {
    random_order(&[3], 100);
}

fn random_order(seeds: &[u64], times: usize) {
    let mut setup = setup(&[]);
    let scatter = scripts().bench_scatter(None).expect("scatter");
    setup.scatter = Some(Arc::new(scatter));
    for seed in seeds {
        setup.seed = *seed;
        let mut procedures = procedures(&setup);
        procedures.retain(|procedure| !procedure.on_request);
        let mut random = Random::new(*seed);
        let order = (0..times).flat_map(|_| {
            select::shuffle(&mut procedures, random.bits());
            let twice = |procedure: &Arc<Procedure>| (procedure.clone(), 1 + random.below(2));
            procedures.iter().map(twice).collect::<Vec<_>>()
        });
        all_pass(&setup, order);
    }
}

/// Each procedure so many times, on one unit.
fn all_pass(setup: &BenchSetup, row: impl Iterator<Item = (Arc<Procedure>, usize)>) {
    let stop = Stop::default();
    let mut session = setup.sim_session("all in a row", &stop);
    session.judge_bring_up(SWITCHED_OFF + READY_WITHIN, settled());
    let mut before = String::from("nothing");
    let mut not_passed = Vec::new();
    for (place, (procedure, repeat)) in row.enumerate() {
        let found = between_procedures(&mut session);
        let mut said: Vec<_> = found
            .into_iter()
            .map(|fault| fault.finding.to_string())
            .collect();
        let mut heard = Heard::default();
        let mut sink = |event| heard.take(event);
        let options = RunOptions {
            repeat: repeat as u32,
            ..RunOptions::default()
        };
        session.run(&procedure, options, Vec::new(), &mut sink, &TO_THE_END);
        // What line, unit type or train lack is the same whatever ran before.
        said.extend(heard.amiss(|step| procedure.steps[step.index].lacks.is_some()));
        if heard.verdict != Some(Verdict::Passed) || !said.is_empty() {
            not_passed.push(format!(
                "{place}: {} × {repeat} after {before}: {said:#?}",
                procedure.id
            ));
        }
        before.clone_from(&procedure.id);
    }
    assert!(
        not_passed.is_empty(),
        "seed {}: {not_passed:#?}",
        setup.seed
    );
}

/// Goal: a run of thousands of procedures keeps room for the events of a few. Method: none is taken.
#[test]
fn workers_start_only_a_limited_number_of_procedures_ahead() {
    const JOBS: usize = 3;
    let setup = setup(&[]);
    let procedures = procedures(&setup);
    let mut named = procedures.iter();
    let link = named.find(|p| p.id == "tcms/link").expect("it");
    let plan = RunPlan {
        jobs: JOBS,
        ..RunPlan::of((0..5_000).map(|_| link.clone()))
    };
    let stop = Stop::default();
    let first_failure = FirstFailure::new(false);
    let mut connected = Connected::Sim(Box::new(setup));
    let begun = std::thread::scope(|scope| {
        let procedures = start(scope, &plan, &mut connected, &first_failure, &stop);
        let first = procedures.recv().expect("the first");
        assert!(first.1.into_iter().count() > 0, "it is run");
        stop.press();
        procedures.into_iter().count()
    });
    assert!((1..=STREAMS_AHEAD + 2 * JOBS).contains(&begun), "{begun}");
}

/// A controller that breaks while no procedure runs is found all the same.
#[test]
fn a_fault_between_two_procedures_is_recorded() {
    let mut setup = setup(&["master_controller.pot_low"]);
    setup.faults[0].onset_s = 20.0;
    let stop = Stop::default();
    let mut session = setup.sim_session("between", &stop);
    session.judge_bring_up(SWITCHED_OFF + READY_WITHIN, settled());
    session.idle(Duration::from_ms(1_000), |_, _, _| {}, |_| false);
    assert!(between_procedures(&mut session).is_empty());
    // Not taken by anybody, as while a window runs out.
    while session.now() < Instant::ZERO + SWITCHED_OFF + Duration::from_ms(21_000) {
        session.bench.tick().expect("bench");
    }
    let found = between_procedures(&mut session);
    let names: Vec<_> = found.iter().map(|fault| fault.name.as_str()).collect();
    assert_eq!(names, ["controller_failed"]);
}
