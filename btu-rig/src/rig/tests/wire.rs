//! Traffic on the wire: periods, budget, determinism, and what is said of a bad connection.

use protocol::message::{Channel, DoorSide, RunningMode};
use protocol::{Instant, SCAN};

use super::{FakeUnit, bench, link_error, rig};
use crate::rig::{Bench, LinkTrouble, UnitLink};
use crate::stimulus::{
    CodeSignal, StationData, Stimulus, TachoCondition, TcmsCondition, WaysideCondition,
};
use protocol::Speed;

/// Bytes each way in a cycle of 50 ms (576 fit at 115 200 baud).
const BUDGET: usize = 400;

const STATION: StationData = StationData {
    route: 0x7E7D,
    section: 61,
    station: 823,
    next_station: 824,
    loop_id: 0x7D7D,
    fixed_speed_kmh: None,
    running_mode: RunningMode::Recovery,
    door_side: DoorSide::Right,
    departure: true,
    train_number: 0x7E7E,
};

/// Everything at once, at bytes that must be escaped where a stimulus can choose them.
#[test]
fn no_cycle_exceeds_the_budget() {
    let mut unit = FakeUnit::default();
    (0..200).for_each(|_| unit.log_event(1));
    let mut bench = bench(unit);
    let signal = CodeSignal::new(32_382.0, 323.82, 32_382.0);
    bench.apply(Stimulus::Code(signal));
    bench.apply(Stimulus::Station(STATION));
    bench.apply(Stimulus::Speed {
        to: Speed::from_kmh(110.0),
        accel_mps2: 1.0,
    });
    bench.apply(Stimulus::Tacho {
        channel: 2,
        condition: TachoCondition::Noisy { per_s: 900.0 },
    });
    bench.apply(Stimulus::PtuArm);
    for _ in 0..120 {
        for _ in 0..8 {
            bench.apply(Stimulus::PtuTwc(STATION));
        }
        bench.run_ms(500);
        assert!(bench.rig.settled().is_ok());
    }
    let bytes = &bench.link.bytes_per_scan;
    let worst = bytes
        .windows(5)
        .map(|cycle| cycle.iter().sum::<usize>())
        .max();
    assert!(worst < Some(BUDGET), "{worst:?}");
}

#[test]
fn frames_keep_their_periods() {
    let mut bench = bench(FakeUnit::default());
    bench.run_ms(10_000);
    let rig = &mut bench.rig;
    // As many as the fake unit answers: 100 I/O a second, 20 TCMS, 4 TWC.
    let counters = *rig.counters();
    assert_eq!(counters.accepted(Channel::Io), 1000);
    assert_eq!(counters.accepted(Channel::Tcms), 200);
    assert_eq!(counters.accepted(Channel::Twc), 40);
    bench.apply(Stimulus::Wayside(WaysideCondition::Corrupt));
    bench.apply(Stimulus::Tcms(TcmsCondition::Silent));
    bench.run_ms(10_000);
    assert_eq!(bench.rig.counters().accepted(Channel::Twc), 40);
    assert_eq!(bench.rig.counters().accepted(Channel::Io), 2000);
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let run = |seed: u64| {
        let mut bench = Bench::new(rig(seed), FakeUnit::default());
        bench.apply(Stimulus::Wayside(WaysideCondition::Corrupt));
        let condition = TachoCondition::Noisy { per_s: 30.0 };
        bench.apply(Stimulus::Tacho {
            channel: 1,
            condition,
        });
        bench.run_ms(5000);
        bench.link.all_bytes.clone()
    };
    assert_eq!(run(5), run(5));
    assert_ne!(run(5), run(6));
}

/// Sends the same bytes every scan.
struct Noise(&'static [u8]);

impl UnitLink for Noise {
    fn exchange(&mut self, _: Instant, _: &[u8], out: &mut Vec<u8>) -> Result<(), LinkTrouble> {
        out.extend_from_slice(self.0);
        Ok(())
    }
}

#[test]
fn a_bad_connection_is_named_after_the_time_for_first_contact() {
    for (noise, text) in [
        (&b""[..], "unit silent: not one byte in 3.0 s"),
        (&b"\x00\xF8\x80"[..], "garbage: 903 bytes, no valid frame"),
        (
            &b"~~abcdefghijklmnopqrst~"[..],
            "refused for checksum — wrong baud rate?",
        ),
    ] {
        let mut bench = Bench::new(rig(1), Noise(noise));
        bench.run_ms(3_000);
        assert_eq!(bench.rig.link_error(), None);
        bench.tick().unwrap();
        let error = link_error(&bench);
        assert!(error.contains(text), "{error}");
    }
}

/// Goal: frames that the tester's own computer lost while it stood still are no silence of the unit. Method: 3 s in which
/// nothing is heard, made up by the bench, and what comes after them.
#[test]
fn a_standstill_of_the_testers_computer_is_no_silence_of_the_unit() {
    let mut bench = bench(FakeUnit::default());
    bench.run_ms(4000);
    bench.link.dead = vec![Channel::Ptu, Channel::Io];
    for _ in 0..300 {
        bench.tick().unwrap();
        bench.note_stalled();
    }
    bench.run_ms(1400);
    assert_eq!(bench.rig.link_error(), None);
    bench.run_ms(200);
    let error = link_error(&bench);
    assert!(error.starts_with("unit silent for 1.6 s"), "{error}");
}

#[test]
fn silence_of_the_io_channel_is_an_error_and_of_tcms_is_a_finding() {
    let mut bench = bench(FakeUnit::default());
    bench.run_ms(4000);
    bench.link.dead = vec![Channel::Tcms, Channel::Twc];
    bench.run_ms(4000);
    assert_eq!(bench.rig.link_error(), None);
    bench.link.dead = vec![Channel::Io];
    // A unit that starts again is heard again after a second.
    bench.run_ms(1400);
    assert_eq!(bench.rig.link_error(), None);
    bench.run_ms(200);
    let error = "unit silent for 1.6 s on the I/O channel";
    assert_eq!(link_error(&bench), error);
    assert_eq!(SCAN.as_ms(), 10);
}
