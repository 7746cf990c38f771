//! What of a unit's log becomes occurrences, once and under the same ids on every laptop.

use std::path::Path;

use fault_db::FaultFilter;
use protocol::event::Event;

use super::*;
use crate::clock::open_options;
use btu_rig::procedure::UnitEvent;

fn store(directory: &Path, name: &str) -> Store {
    Store::open(&directory.join(name), open_options()).expect("a database")
}

fn source(endpoint: &str, until_us: i64) -> Source {
    Source {
        endpoint: endpoint.into(),
        serial: "SG-0042".into(),
        config_name: "sg100".into(),
        line: "line8".into(),
        operator: endpoint.into(),
        from_us: until_us - 1_000_000,
        until_us,
        ..Source::default()
    }
}

/// An entry each 10 min; those of the first power-up have no date.
fn entries(until: u32) -> Vec<Entry> {
    let entry = |sequence: u32| {
        let power_up = 1 + sequence / 3;
        let at_us = (power_up > 1).then(|| 1_000_000_000_000 + i64::from(sequence) * 600_000_000);
        Entry {
            event: UnitEvent::at_stand(sequence % 3, Event::TachoDead1, 1_000 * sequence),
            at_us,
            is_sure: true,
            stored: Some(StoredPlace {
                power_up,
                sequence,
                not_after_us: Some(1_000_001_800_000_000),
                uncertainty_us: Some(500_000),
            }),
        }
    };
    (0..until).map(entry).collect()
}

fn occurrences(store: &Store) -> Vec<Id> {
    let faults = store.faults(&FaultFilter::default()).expect("listed");
    let [fault] = &faults[..] else {
        panic!("{faults:?}");
    };
    let detail = store.fault(fault.id).expect("read");
    assert_eq!(fault.occurrences as usize, detail.occurrences.len());
    let mut ids: Vec<_> = detail.occurrences.iter().map(|seen| seen.id).collect();
    ids.sort_unstable();
    ids
}

#[test]
fn importing_a_log_again_adds_what_is_new_and_nothing_twice() {
    let dir = tempfile::tempdir().expect("a directory");
    let store = store(dir.path(), "a.db");
    let first =
        import(&store, &source("serial:a", 2_000_000_000_000), &entries(5)).expect("stored");
    assert_eq!((first.new.len(), first.known), (5, 0));
    let again =
        import(&store, &source("serial:a", 2_100_000_000_000), &entries(7)).expect("stored");
    assert_eq!((again.new.len(), again.known), (2, 5));
    assert_eq!(occurrences(&store).len(), 7);
    let dated_by = |fault: &FaultRecord| {
        let sample = fault.freeze.iter().find(|sample| sample.name == "dated_by");
        sample
            .and_then(|sample| sample.label.clone())
            .expect("said")
    };
    assert!(dated_by(&first.new[1]).starts_with("power-up 1 and 1.000 s after it"));
    assert_eq!(first.new[1].at_us, 1_000_001_800_000_000, "not later than");
    assert!(dated_by(&first.new[4]).contains("told in power-up 2, within 0.5 s"));
}

/// Goal: two laptops that import the same log, at different times, have the same occurrences, and one of each when
/// their files meet. Method: both ways, twice, with the check of the database after each.
#[test]
fn two_laptops_that_import_the_same_log_make_the_same_occurrences() {
    let dir = tempfile::tempdir().expect("a directory");
    let (a, b) = (store(dir.path(), "a.db"), store(dir.path(), "b.db"));
    import(&a, &source("serial:a", 2_000_000_000_000), &entries(5)).expect("stored");
    import(&b, &source("serial:b", 2_100_000_000_000), &entries(7)).expect("stored");
    for (to, from) in [(&a, &b), (&b, &a), (&a, &b), (&b, &a)] {
        let merged = to.merge_from(from).expect("merged");
        assert!(merged.different.is_empty(), "{merged:?}");
        assert!(merged.refused.is_empty(), "{merged:?}");
        let report = to.check().expect("checked");
        assert!(report.problems.is_empty(), "{report:?}");
        assert_eq!(occurrences(to).len(), 7);
    }
    assert_eq!(occurrences(&a), occurrences(&b));
}

#[test]
fn a_count_of_power_ups_that_falls_is_told_and_its_entries_are_others() {
    let dir = tempfile::tempdir().expect("a directory");
    let store = store(dir.path(), "a.db");
    import(&store, &source("serial:a", 2_000_000_000_000), &entries(7)).expect("stored");
    let read = |power_up| StoredRead {
        power_up,
        ..StoredRead::default()
    };
    let against = |power_up| against_history(&store, "SG-0042", &read(power_up)).expect("read");
    assert_eq!((against(3), against(4)), (None, None));
    let told = against(1).expect("told");
    assert!(
        told.contains("counts 1 power-ups and had counted 3"),
        "{told}"
    );
    let mut from_start = entries(1);
    from_start[0].event.at_ms = 77;
    let imported =
        import(&store, &source("serial:a", 2_200_000_000_000), &from_start).expect("stored");
    assert_eq!((imported.new.len(), imported.known), (1, 0));
}
