//! Whatever is asked of the rig in whatever order, it neither panics nor loses a pulse.

use proptest::prelude::*;
use protocol::Speed;
use protocol::message::ModeSwitch;
use protocol::signal::Signal;

use super::{FakeUnit, config, rig};
use crate::lever::Lever;
use crate::rig::Bench;
use crate::stimulus::{CodeSignal, Stimulus, TachoCondition, TcmsCondition, WaysideCondition};

/// A number that may be anything, often something sensible.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![4 => 0.0..50.0, 1 => any::<f64>(), 1 => Just(0.0), 1 => Just(f64::NAN)]
}

fn signal() -> impl Strategy<Value = CodeSignal> {
    let values = (number(), number(), number());
    values
        .prop_map(|(carrier_hz, rate_hz, level_mv)| CodeSignal::new(carrier_hz, rate_hz, level_mv))
}

fn condition() -> impl Strategy<Value = TachoCondition> {
    prop_oneof![
        Just(TachoCondition::Good),
        Just(TachoCondition::Dead),
        number().prop_map(|per_s| TachoCondition::Noisy { per_s }),
        number().prop_map(|factor| TachoCondition::Scaled { factor }),
        Just(TachoCondition::Reversed),
    ]
}

fn motion() -> impl Strategy<Value = Stimulus> {
    prop_oneof![
        (number(), number()).prop_map(|(v, accel_mps2)| Stimulus::Speed {
            to: Speed::from_mps(v),
            accel_mps2
        }),
        (number(), number(), number()).prop_map(|(distance_m, v, accel_mps2)| Stimulus::Travel {
            distance_m,
            speed: Speed::from_mps(v),
            accel_mps2
        }),
        any::<bool>().prop_map(|backward| Stimulus::Direction { backward }),
        any::<bool>().prop_map(|on| Stimulus::TrainDriven { on }),
    ]
}

fn other() -> impl Strategy<Value = Stimulus> {
    prop_oneof![
        signal().prop_map(Stimulus::Code),
        signal().prop_map(Stimulus::Crosstalk),
        (number(), number()).prop_map(|(rate_hz_per_s, level_mv_per_s)| Stimulus::CodeDrift {
            rate_hz_per_s,
            level_mv_per_s
        }),
        (0u8..4, condition())
            .prop_map(|(channel, condition)| Stimulus::Tacho { channel, condition }),
        any::<u8>().prop_map(|psm| Stimulus::Marker { psm }),
        number().prop_map(|diameter_mm| Stimulus::WheelDiameter { diameter_mm }),
        prop::option::of(60u16..63).prop_map(|section| Stimulus::MarkersAlong { section }),
        prop::option::of(number()).prop_map(|coefficient| Stimulus::Adhesion { coefficient }),
        (any::<u8>(), prop::option::of(number()))
            .prop_map(|(psm, by_m)| Stimulus::MarkerMoved { psm, by_m }),
        (0..Lever::ALL.len()).prop_map(|i| Stimulus::Controller {
            lever: Lever::ALL[i]
        }),
        (-2i8..3).prop_map(|position| Stimulus::Reverser { position }),
        number().prop_map(|passengers_kg| Stimulus::Load { passengers_kg }),
        any::<bool>().prop_map(|closed| Stimulus::Doors { closed }),
        any::<bool>().prop_map(|on| Stimulus::PtuSilent { on }),
        Just(Stimulus::ModeSwitch(ModeSwitch::Automatic)),
        Just(Stimulus::Wayside(WaysideCondition::Corrupt)),
        Just(Stimulus::Tcms(TcmsCondition::Stale)),
        any::<bool>().prop_map(|on| Stimulus::CodesAlong { on }),
        Just(Stimulus::PtuArm),
        Just(Stimulus::PtuDisarm),
        Just(Stimulus::PtuRelease),
        Just(Stimulus::PtuClearLog),
        Just(Stimulus::PtuSelfTest),
        (any::<u8>(), number(), number()).prop_map(|(channels, v, accel_mps2)| {
            Stimulus::PtuSpeed {
                channels,
                backward: false,
                to: Speed::from_mps(v),
                accel_mps2,
            }
        }),
    ]
}

/// Every known rig signal within its range, so that it can be stored.
fn check_sample(bench: &Bench<FakeUnit>) -> Result<(), TestCaseError> {
    for &signal in Signal::ALL {
        if let Some(value) = bench.rig.sample().get(signal) {
            let definition = signal.definition();
            prop_assert!(
                (definition.low..=definition.high).contains(&value),
                "{} = {value}",
                definition.name
            );
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn any_sequence_is_survived_and_made_safe(
        seed: u64,
        steps in prop::collection::vec((prop_oneof![motion(), other()], 0u64..300), 1..25),
    ) {
        let mut bench = Bench::new(rig(seed), FakeUnit::default());
        for (stimulus, scans) in steps {
            let now = bench.now();
            let _ = bench.rig.apply(now, &stimulus);
            bench.run_ms(scans * 10);
            check_sample(&bench)?;
            let _ = bench.rig.settled();
        }
        bench.make_safe();
        // 200 km/h at 3 m/s² is 18.5 s.
        bench.run_ms(20_000);
        prop_assert!(bench.rig.safe());
    }

    /// Two good channels count the same way, to a pulse, whatever the wheels do.
    #[test]
    fn counts_follow_the_distance(
        steps in prop::collection::vec((motion(), 0u64..300), 1..20),
    ) {
        let pulse_m = config().metres_per_pulse();
        let mut bench = Bench::new(rig(1), FakeUnit::default());
        let mut pulses = [0u64; 2];
        let mut last = [0u16; 2];
        for (stimulus, scans) in steps {
            let now = bench.now();
            let _ = bench.rig.apply(now, &stimulus);
            for _ in 0..scans {
                bench.tick().unwrap();
                for (i, tacho) in bench.rig.tachos.iter().enumerate() {
                    pulses[i] += u64::from(tacho.count.wrapping_sub(last[i]));
                    last[i] = tacho.count;
                }
            }
            let distance = bench.rig.wheel.motion.distance_m / pulse_m;
            for counted in pulses {
                prop_assert!((counted as f64 - distance).abs() <= 1.0, "{counted} of {distance}");
            }
        }
    }
}

/// A self-test that never ends, and the session's end waiting behind it: making safe does not wait for either.
#[test]
fn a_disarm_behind_a_self_test_that_hangs_is_not_lost() {
    let mut bench = Bench::new(rig(1), FakeUnit::default());
    bench.run_ms(500);
    for stimulus in [Stimulus::PtuArm, Stimulus::PtuSelfTest, Stimulus::PtuDisarm] {
        let now = bench.now();
        bench.rig.apply(now, &stimulus).unwrap();
        bench.run_ms(300);
    }
    bench.make_safe();
    bench.run_ms(10_000);
    assert!(bench.rig.safe());
}
