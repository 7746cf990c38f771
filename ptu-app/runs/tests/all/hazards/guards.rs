//! Guards removed in turn: each guard of the unit can fail by itself, and then a scene shows the breach.

use protocol::injection::Effect;

use super::acts::Kind;
use super::{Search, play};
use crate::setup;

/// All guards, as the unit has them: name and place of each.
const GUARDS: &str = include_str!("../../../../../ato-under-test/src/guards.rs");
/// Scenes that are played of each at most, in blocks.
const SCENES: u64 = 120;
const BLOCK: u64 = 12;
/// Guards that are found in this number of scenes. For the other guards a scene is too rare, or the guarded thing
/// is no invariant.
const FOUND: usize = 7;

/// Places of all guards.
fn places() -> Vec<&'static str> {
    let (_, list) = GUARDS
        .split_once("\nguards! {")
        .expect("the list of guards");
    let rows = list
        .lines()
        .map(str::trim)
        .filter(|row| !row.starts_with("//"));
    rows.filter_map(|row| Some(row.split_once(": ")?.1.trim_end_matches(',')))
        .collect()
}

/// Kind of input that such a guard watches.
fn kind(place: &str) -> Option<Kind> {
    Some(match place {
        "StopGuard" => Kind::Code,
        "CodeConfirmation" => Kind::Flicker,
        "DoorGuard" | "DepartureGuard" | "EnableLatch" | "DoorClosing" | "DoorReopening" => {
            Kind::Doors
        }
        "ReleaseGuard" | "ReleaseStandstill" => Kind::Acknowledge,
        "NeutralGuard" => Kind::Reverser,
        "SpeedGuard" => Kind::Tachometer,
        "LineGuard" => Kind::Line,
        "WheelGuard" | "CabEntries" => Kind::WheelDiameter,
        "TrainGuard" | "StationGuard" | "SideGuard" | "SlowRunning" => Kind::Station,
        "OrderGuard" | "PutAwayBrake" | "WakeUpTest" | "HandOverBrake" => Kind::Orders,
        "MarkerGuard" | "MarkerDebounce" => Kind::Marker,
        "ArmStandstill" | "ArmBrakes" | "MotionGuard" | "CodeGuard" | "ModeGuard" | "KeyGuard"
        | "BrakeHold" | "TractionBar" | "StartBar" | "DoorBar" => Kind::Tests,
        _ => return None,
    })
}

/// The first scene that shows that a guard is gone, with what is broken, and which is safe with the guard.
fn shown(place: &str) -> Option<(u64, String)> {
    let mut search = Search::new(setup(&[]), "*");
    search
        .modes
        .retain(|mode| format!("{:?}", mode.place) == place && mode.effect == Effect::Dead);
    search.modes.truncate(1);
    assert!(!search.modes.is_empty(), "no fault mode takes {place} away");
    search.first = kind(place);
    (0..SCENES / BLOCK).find_map(|block| {
        let (finds, _) = search.run(block * BLOCK..(block + 1) * BLOCK);
        finds.into_iter().find_map(|(number, find)| {
            let mut sound = search.plan(number);
            sound.faults.clear();
            let gone = find.breach.condition.is_none() && play(&search.setup, &sound).is_none();
            gone.then(|| {
                (
                    number,
                    format!("{:?} {}", find.breach.invariant, find.breach.how),
                )
            })
        })
    })
}

/// Goal: the monitor misses no guard that is gone. Method: the fault mode of each, in scenes with what it guards against.
#[test]
#[ignore = "long suite: each guard in up to 120 scenes"]
fn guards_removed_in_turn_are_found() {
    let places = places();
    let mut found = 0;
    for place in &places {
        let shown = shown(place);
        found += usize::from(shown.is_some());
        let said = shown.map_or("not found".to_owned(), |(number, how)| {
            format!("scene {number}: {how}")
        });
        println!("{place:20} {said}");
    }
    println!("{found} of {} guards", places.len());
    assert!(found >= FOUND);
}
