//! Links without a unit at their end: an unknown port, one that no program opens, a silent peer, garbage, an echo, one that hangs up. The
//! run is recorded as an error, and earlier ones stay.

use std::io::{Read, Write};
use std::time::{Duration, Instant};

use crate::common::Place;
use crate::common::proxy::peer;

/// Time in which `ptu` must have given up, with room for a busy machine.
const GIVES_UP_WITHIN: Duration = Duration::from_secs(60);

/// Runs against this unit: exit 3 with these words, one more run recorded, as an error.
#[track_caller]
pub fn fails(unit: &str, words: &[&str]) {
    let place = Place::new();
    let earlier = place.recorded_run();
    let began = Instant::now();
    place
        .ptu(&["run", "tcms/link", "--unit", unit])
        .exits(3)
        .explains(words);
    assert!(began.elapsed() < GIVES_UP_WITHIN, "{:?}", began.elapsed());
    let runs = place.run_ids();
    assert_eq!(runs.len(), 2);
    assert_eq!(runs[1], earlier);
    let run = place.json("runs show latest --json");
    assert_eq!(run["run"]["verdict"], "error");
    assert_eq!(run["run"]["state"], "finished");
}

#[test]
fn a_host_that_does_not_exist() {
    fails(
        "tcp:no-such-host.invalid:7000",
        &[
            "no-such-host.invalid:7000",
            "check that the unit is served there",
        ],
    );
}

#[test]
fn a_silent_unit() {
    let address = peer(|mut stream| {
        let mut ignored = [0; 4096];
        while stream.read(&mut ignored).is_ok_and(|count| count > 0) {}
    });
    fails(
        &format!("tcp:{address}"),
        &[&address.to_string(), "unit silent", "check the cable"],
    );
}

/// A peer that is held up until `ptu` gives up was silent.
#[test]
fn a_unit_speaking_garbage() {
    let address = peer(|mut stream| {
        // A fixed sequence without meaning (linear congruence), flags and escapes included.
        let mut state = 1_u32;
        let mut noise = [0_u8; 96];
        loop {
            for byte in &mut noise {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                *byte = (state >> 24) as u8;
            }
            if stream.write_all(&noise).is_err() {
                return;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    });
    fails(
        &format!("tcp:{address}"),
        &[
            &address.to_string(),
            "garbage",
            "no valid frame",
            "baud rate",
        ],
    );
}

/// A loop-back plug, or two testers on one line: what is heard are the own frames.
#[test]
fn an_echo_instead_of_a_unit() {
    let address = peer(|mut stream| {
        let mut heard = [0; 4096];
        while let Ok(count @ 1..) = stream.read(&mut heard) {
            if stream.write_all(&heard[..count]).is_err() {
                return;
            }
        }
    });
    fails(
        &format!("tcp:{address}"),
        &[&address.to_string(), "no valid frame"],
    );
}

#[test]
fn a_unit_that_hangs_up() {
    let address = peer(|stream| {
        std::thread::sleep(Duration::from_millis(500));
        drop(stream);
    });
    fails(
        &format!("tcp:{address}"),
        &[&address.to_string(), "check the cable"],
    );
}
