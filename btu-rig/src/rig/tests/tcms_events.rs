//! Events that TCMS logs, as the bench hands them on.

use protocol::event::Event;
use protocol::injection::FaultCatalogue;
use protocol::{Instant, LruId};

use super::{FakeUnit, bench};
use crate::rig::Bench;
use crate::rig::session::MAX_EVENTS;
use crate::stimulus::{Stimulus, TrainSwitch};

/// A line that takes nothing is one event and no inverter's fault; one inverter is one event of its car.
#[test]
fn a_line_that_takes_no_power_is_told_from_an_inverter_that_gives_none() {
    let regeneration = |on| Stimulus::Switch {
        switch: TrainSwitch::Regeneration,
        on,
    };
    let parts = |bench: &mut Bench<FakeUnit>| -> Vec<(i32, Option<LruId>)> {
        let code = Event::RegenerationCutOut.definition().code;
        let events = bench.rig.take_events().into_iter();
        events
            .filter(|entry| entry.code == code)
            .map(|entry| entry.parameter)
            .map(|parameter| (parameter, Event::RegenerationCutOut.suspect(parameter)))
            .collect()
    };
    let catalogue =
        FaultCatalogue::from_toml(include_str!("../../../../scripts/units/faults.toml")).unwrap();
    for (mode, begins, line) in [
        (None, vec![], vec![(0, None)]),
        (Some("inverter.dead"), vec![], vec![(0, None)]),
        (
            Some("inverter.regeneration_lost"),
            vec![(3, Some(LruId::from_static("inverter")))],
            vec![(0, None)],
        ),
    ] {
        let mut bench = bench(FakeUnit::default());
        let faults: Vec<_> = mode
            .and_then(|id| catalogue.fault(id))
            .cloned()
            .into_iter()
            .collect();
        bench.rig.inject(&faults, Instant::ZERO);
        bench.apply(Stimulus::TrainDriven { on: true });
        bench.run_ms(500);
        assert_eq!(parts(&mut bench), begins, "{mode:?}");
        for _ in 0..2 {
            bench.apply(regeneration(false));
            bench.run_ms(500);
            assert_eq!(parts(&mut bench), line, "{mode:?}");
            bench.apply(regeneration(true));
            bench.run_ms(500);
            assert_eq!(parts(&mut bench), [], "{mode:?}");
        }
    }
}

#[test]
fn events_of_tcms_that_nobody_takes_are_counted() {
    let mut bench = bench(FakeUnit::default());
    let low = |on| Stimulus::Switch {
        switch: TrainSwitch::MainReservoirLow,
        on,
    };
    bench.run_ms(100);
    bench.rig.take_events();
    for _ in 0..MAX_EVENTS + 5 {
        for on in [true, false] {
            bench.apply(low(on));
            bench.run_ms(20);
        }
    }
    let code = Event::MainReservoirLow.definition().code;
    let lost = bench.rig.events_overwritten() as usize;
    let kept = bench.rig.take_events();
    assert_eq!(kept.len(), MAX_EVENTS);
    let low_kept = kept.iter().filter(|entry| entry.code == code).count();
    assert!(
        lost >= 5 && lost + low_kept >= MAX_EVENTS + 5,
        "{lost} {low_kept}"
    );
}
