//! The structure held against scripts, catalogue and dictionary.

use super::*;
use crate::test_support::{procedures, scripts, setup};

fn structure() -> Structure {
    Structure::load(&scripts(), &scripts().faults().unwrap()).unwrap()
}

fn dictionary() -> Dictionary {
    let packed = scripts().bytes("dictionary.zst", u64::MAX - 1).unwrap();
    Dictionary::from_bytes(&packed).unwrap()
}

/// Goal: structure and campaign say the same of the steps that a part's faults fail.
/// Method: the dictionary that comes with the scripts; what it has off the way is what the file lists.
#[test]
fn the_dictionary_fails_steps_on_the_way_of_the_part_and_those_that_are_listed() {
    let structure = structure();
    let off = structure.off_way(&procedures(&setup(&[])), &dictionary());
    let listed = structure.known_off_way.iter().flat_map(|known| {
        known
            .faults
            .iter()
            .map(|fault| (fault.clone(), known.step.clone()))
    });
    let found: BTreeSet<_> = off
        .into_iter()
        .map(|off| (off.fault, off.step.to_string()))
        .collect();
    assert_eq!(found, listed.collect());
}

/// Goal: a way that leads past a part is noticed. Method: the speed without its first sensor.
#[test]
fn a_part_that_is_missing_on_a_way_is_a_finding() {
    let text = scripts().text(FILE).unwrap();
    let sensor = "\"speed_sensor_1\", \"atp_cpu\"]";
    assert!(text.contains(sensor));
    let catalogue = scripts().faults().unwrap();
    let parts: Vec<_> = catalogue.lrus.iter().map(|part| &part.id).collect();
    let without = Structure::from_toml(&text.replace(sensor, "]"), &parts).unwrap();
    let off = without.off_way(&procedures(&setup(&[])), &dictionary());
    let off = without.not_understood(off);
    let of_sensor = |off: &OffWay| off.fault.starts_with("speed_sensor_1.");
    assert!(!off.is_empty() && off.iter().all(of_sensor), "{off:?}");
}

/// A misspelt name would never match, and nobody would see.
#[test]
fn procedures_without_the_bench_are_procedures_of_a_laptop() {
    let procedures = procedures(&setup(&[]));
    for name in &structure().relations.without_bench {
        let of_laptop = |one: &&Arc<Procedure>| one.needs == Connection::Ptu && one.id == *name;
        assert!(procedures.iter().find(of_laptop).is_some(), "{name}");
    }
}

#[test]
fn names_that_there_are_not_and_signals_without_a_way_are_refused() {
    let text = scripts().text(FILE).unwrap();
    let catalogue = scripts().faults().unwrap();
    let parts: Vec<_> = catalogue.lrus.iter().map(|part| &part.id).collect();
    let refused = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        Structure::from_toml(&text.replacen(from, to, 1), &parts).unwrap_err()
    };
    assert!(refused("\"eb_relay\"", "\"relay\"").contains("no part \"relay\""));
    let group = "parts = [\"tcms\", \"rs485_link\"]\nmeasure";
    let unknown = "parts = [\"tcms\", \"link\"]\nmeasure";
    assert!(refused(group, unknown).contains("no part \"link\""));
    assert!(refused("\"limit\"", "\"limits\"").contains("no signal \"limits\""));
    assert!(refused("signals = [\"limit\"]", "signals = []").contains("limit has no way"));
    assert!(refused("signals = [\"eb\"]", "signals = [\"fsb\"]").contains("two ways"));
}
