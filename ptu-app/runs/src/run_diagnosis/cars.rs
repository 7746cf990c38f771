//! A train has several of some parts, one on a car or a pair of cars: the faults of a run say on which.

use std::collections::BTreeSet;

use btu_rig::procedure::Finding;
use fault_db::RunOccurrence;
use protocol::injection::Lru;

use crate::stored::findings;

/// Adds to the name of a part the car on which faults of a run name it, where they all name one.
pub(super) fn name_cars<'a>(
    names: &mut [Lru],
    occurrences: impl Iterator<Item = &'a RunOccurrence> + Clone,
) {
    for part in names {
        let of_part = occurrences
            .clone()
            .filter(|one| part.id.as_str() == one.lru);
        let mut cars: BTreeSet<i32> = of_part.filter_map(car).collect();
        if let (Some(car), true) = (cars.pop_first(), cars.is_empty()) {
            part.name = format!("{} of car {car}", part.name);
            part.name_ko = format!("{car}호차 {}", part.name_ko);
        }
    }
}

/// The car that a fault names, from 1 on.
fn car(seen: &RunOccurrence) -> Option<i32> {
    findings(&seen.findings).iter().find_map(|found| {
        let Finding::Event { event, .. } = &found.finding else {
            return None;
        };
        let meaning = event.event()?.definition().parameter;
        let is_car = meaning.split(';').next() == Some("car") && event.parameter > 0;
        is_car.then_some(event.parameter)
    })
}
