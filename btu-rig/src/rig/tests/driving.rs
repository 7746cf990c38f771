//! The closed loop of train, TCMS and desk, and the way back to the quiescent state.

use protocol::Speed;
use protocol::message::{AtcToTcmsBits, ModeSwitch, Outputs};
use protocol::signal::Signal;

use super::{FakeUnit, bench, order};
use crate::stimulus::{CodeSignal, CutOut, Stimulus, TachoCondition};

#[test]
fn the_train_obeys_ato_passes_its_markers_and_stops_for_the_relay() {
    let mut bench = bench(FakeUnit::default());
    bench.apply(Stimulus::MarkersAlong { section: Some(61) });
    bench.apply(Stimulus::TrainDriven { on: true });
    bench.apply(Stimulus::ModeSwitch(ModeSwitch::Automatic));
    bench.link.to_tcms = order(AtcToTcmsBits::POWER, 1023);
    bench.run_ms(25_000);
    assert!(
        (50.0..75.0).contains(&bench.value(Signal::TrainSpeed)),
        "{}",
        bench.value(Signal::TrainSpeed)
    );
    bench.run_ms(10_000);
    assert_eq!(bench.value(Signal::MarkerCoil), 1.0);
    let position = bench.value(Signal::TrainPosition);
    assert!(position > 304.03, "{position}");
    bench.link.outputs = Outputs::empty();
    bench.run_ms(30_000);
    assert_eq!(bench.value(Signal::TrainSpeed), 0.0);
    assert_eq!(bench.value(Signal::EbLoop), 1.0);
}

#[test]
fn generators_wait_while_the_train_drives() {
    let mut bench = bench(FakeUnit::default());
    bench.apply(Stimulus::TrainDriven { on: true });
    let go = Stimulus::Speed {
        to: Speed::from_kmh(30.0),
        accel_mps2: 1.0,
    };
    bench.refusal(go);
    bench.apply(Stimulus::TrainDriven { on: false });
    bench.apply(go);
    bench.run_ms(10_000);
    assert!((bench.value(Signal::TrainSpeed) - 30.0).abs() < 1e-9);
}

/// Code and reverser stay until the wheels stand: taking them away at speed would make a healthy
/// unit log an overspeed or a rollback.
#[test]
fn making_safe_keeps_what_a_turning_wheel_needs() {
    let mut bench = bench(FakeUnit::default());
    bench.apply(Stimulus::Code(CodeSignal::new(3000.0, 15.0, 500.0)));
    bench.apply(Stimulus::Reverser { position: -1 });
    bench.apply(Stimulus::Direction { backward: true });
    bench.apply(Stimulus::Tacho {
        channel: 1,
        condition: TachoCondition::Dead,
    });
    bench.apply(Stimulus::Doors { closed: false });
    bench.apply(Stimulus::Speed {
        to: Speed::from_mps(9.0),
        accel_mps2: 3.0,
    });
    bench.run_ms(4000);
    bench.make_safe();
    bench.run_ms(2900);
    assert!(!bench.rig.safe());
    assert_eq!(bench.value(Signal::CarrierHz), 3000.0);
    assert_eq!(bench.value(Signal::Tacho1), 1.0);
    assert_eq!(bench.value(Signal::Doors), 1.0);
    bench.run_ms(200);
    assert!(bench.rig.safe());
    assert_eq!(bench.value(Signal::CarrierHz), 0.0);
    assert_eq!(bench.value(Signal::Tacho1), 0.0);
    assert_eq!(bench.value(Signal::TrainSpeed), 0.0);
}

#[test]
fn an_impossible_request_is_refused_with_a_reason() {
    let mut bench = bench(FakeUnit::default());
    for (stimulus, text) in [
        (
            Stimulus::Tacho {
                channel: 3,
                condition: TachoCondition::Good,
            },
            "tachometer 3",
        ),
        (
            Stimulus::MarkersAlong { section: Some(99) },
            "no section 99; it has 54, 55",
        ),
        (
            Stimulus::ControllerVolts { volts: Some(11.0) },
            "controller voltage 11",
        ),
        (Stimulus::Marker { psm: 0 }, "marker 0"),
        (
            Stimulus::Speed {
                to: Speed::from_mps(f64::NAN),
                accel_mps2: 1.0,
            },
            "speed NaN km/h",
        ),
        (
            Stimulus::Speed {
                to: Speed::ZERO,
                accel_mps2: 0.0,
            },
            "acceleration 0 m/s²",
        ),
        (
            Stimulus::Load {
                passengers_kg: -1.0,
            },
            "load -1 kg",
        ),
        (
            Stimulus::CutOut {
                what: CutOut::Inverter,
                car: 1,
                on: true,
            },
            "car 1 is a trailer",
        ),
        (
            Stimulus::CutOut {
                what: CutOut::Brake,
                car: 9,
                on: true,
            },
            "no car 9",
        ),
    ] {
        let refusal = bench.refusal(stimulus);
        assert!(refusal.contains(text), "{refusal}");
    }
}

/// Making safe may be called every scan, and a motion counts as unsettled only until a request
/// comes after it.
#[test]
fn settling_follows_what_was_begun_last() {
    let mut bench = bench(FakeUnit::default());
    let to = Speed::from_mps(10.0);
    let ramp = Stimulus::Speed {
        to,
        accel_mps2: 1.0,
    };
    assert_eq!(bench.settle(ramp), Ok(()));
    assert_eq!(bench.now().as_secs(), 10.0);
    bench.apply(Stimulus::Travel {
        distance_m: 200.0,
        speed: to,
        accel_mps2: 1.0,
    });
    assert_eq!(bench.settle(Stimulus::PtuArm), Ok(()));
    assert!(bench.now().as_secs() < 11.0 && !bench.rig.motion_settled());
    while !bench.rig.safe() {
        bench.make_safe();
        bench.run_ms(10);
        assert!(bench.now().as_secs() < 14.0, "10 m/s at 3 m/s² is 3.4 s");
    }
    assert!(!bench.link.armed());
}
