//! Frames of the unit that contradict themselves, grow old or are refused.

use btu_rig::procedure::EventSource;
use btu_rig::rig::Rig;
use protocol::event::Event;
use protocol::link::{End, Link};
use protocol::message::{AtcToTcms, AtcToTcmsBits, Mode, ModeSwitch};
use protocol::{Instant, SCAN};

use super::bench::{Bench, order};

const P: AtcToTcmsBits = AtcToTcmsBits::POWER;
const B: AtcToTcmsBits = AtcToTcmsBits::BRAKE;

/// The safe reading wins, and an event says so once.
#[test]
fn contradicting_orders_brake() {
    let none = AtcToTcmsBits::empty();
    for (bits, effort, value, contradicts) in [
        (P, 600, 600, false),
        (B, -600, -600, false),
        (none, 0, 0, false),
        (P | B, 600, -600, true),
        (P | B, -600, -600, true),
        (P, -600, -600, true),
        (B, 600, -600, true),
        (none, 600, 0, true),
        (none, -600, -600, true),
        (P, 1024, -1024, true),
        (P, i16::MAX, -1024, true),
        (B, i16::MIN, -1024, true),
        (none, -1025, -1024, true),
    ] {
        let mut bench = Bench::automatic(bits, effort);
        bench.run(1000);
        let name = format!("{bits:?} {effort}");
        assert_eq!(bench.view().driving.drytebe, value, "{name}");
        assert_eq!(bench.powers(), value > 0, "{name}");
        let events = vec![Event::AtoOrderContradicts; usize::from(contradicts)];
        assert_eq!(bench.events(), events, "{name}");
        bench.order = Some(order(none, 0));
        bench.run(100);
        bench.order = Some(order(bits, effort));
        bench.run(100);
        assert_eq!(bench.events(), events, "{name}: again");
    }
}

/// Orders count for 0.3 s; then it is ATO that failed.
#[test]
fn old_orders_are_a_full_brake_in_automatic_only() {
    let mut bench = Bench::automatic(P, 1023);
    bench.run(1000);
    assert!(bench.powers() && !bench.full_service());
    bench.order = None;
    bench.run(250);
    assert!(!bench.full_service());
    bench.run(100);
    assert!(bench.full_service() && !bench.view().driving.dryinp);
    bench.run(2000);
    assert!(!bench.powers());
    bench.order = Some(order(P, 1023));
    bench.run(100);
    assert!(!bench.full_service());
    assert_eq!(bench.events(), [Event::AtcSilent, Event::AtcRestored]);

    bench.inputs.cabs[0].mode_switch = ModeSwitch::Manual;
    bench.order = None;
    bench.run(2000);
    assert!(!bench.full_service(), "by hand ATO is not needed");
}

#[test]
fn refused_frames_are_told_when_many_come_together() {
    let mut bench = Bench::new();
    for _ in 0..20 {
        bench.inputs.frames_refused += 1;
        bench.run(500);
    }
    assert!(bench.events().is_empty(), "now and then is nothing");
    for _ in 0..20 {
        bench.inputs.frames_refused += 1;
        bench.run(100);
    }
    assert_eq!(bench.events(), [Event::AtcFramesRefused]);
}

/// Through the wire: a frame that comes again (stale sequence), one with a wrong FCS, one cut short.
#[test]
fn the_rig_counts_what_its_link_refuses() {
    let (unit, line) = crate::shipped();
    let mut rig = Rig::new(&unit, &line, 1);
    let mut unit = Link::new(End::Unit);
    let (mut now, mut out) = (Instant::from_ms(1000), Vec::new());
    let mut told = 0;
    for scan in 0..100 {
        now += SCAN;
        if scan % 5 == 0 {
            let mut frame = Vec::new();
            unit.send(now, &AtcToTcms::default().into(), &mut frame);
            rig.receive(now, &frame);
            let mut wrong = frame.clone();
            match scan % 15 {
                0 => {}
                5 => {
                    let middle = wrong.len() / 2;
                    wrong[middle] ^= 0x01;
                }
                _ => {
                    wrong.remove(wrong.len() / 2);
                }
            }
            rig.receive(now, &wrong);
        }
        rig.step(now, &mut out);
        let events = rig.take_events();
        let refused = Event::AtcFramesRefused.definition().code;
        let tcms = events.iter().filter(|e| e.source == EventSource::Tcms);
        told += tcms.filter(|e| e.code == refused).count();
    }
    assert!(rig.counters().rejected_total() >= 15);
    assert_eq!(told, 1);
}

/// In automatic run powering drives backward when ATO says so. A direction is taken at standstill, and until then
/// there is no power.
#[test]
fn ato_turns_the_direction_at_standstill_in_automatic_run_alone() {
    const BACK: AtcToTcmsBits = P.union(AtcToTcmsBits::BACKWARD);
    let mut bench = Bench::automatic(P, 600);
    assert!(!bench.run(500).backward && bench.powers());
    bench.order = Some(order(BACK, 600));
    assert!(bench.run(200).backward && bench.powers());
    bench.speed_kmh(2.0);
    bench.order = Some(order(P, 600));
    assert!(bench.run(200).backward && !bench.powers(), "moving");
    bench.order = Some(order(B, -600));
    assert!(bench.run(500).demand < 0.0, "braked whichever way it goes");
    bench.speed_kmh(0.0);
    bench.order = Some(order(P, 600));
    assert!(!bench.run(1_000).backward && bench.powers());

    bench.order = Some(order(BACK, 600));
    assert!(bench.run(200).backward);
    bench.order = Some(AtcToTcms {
        mode: Mode::Automatic,
        ..order(BACK, 600)
    });
    assert!(!bench.run(200).backward, "no run");
    bench.order = Some(order(BACK, 600));
    bench.inputs.cabs[0].mode_switch = ModeSwitch::Manual;
    assert!(!bench.run(200).backward, "by hand the reverser counts");
    bench.inputs.cabs[0].reverser = -1;
    assert!(bench.run(200).backward);
}
