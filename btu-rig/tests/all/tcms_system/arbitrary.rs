//! Whatever TCMS is given, it does not fail and is on the safe side.

use btu_rig::tcms::{CabInputs, ControllerInputs, Tcms, TcmsInputs};
use btu_rig::train::{CarSet, Equipment, MAX_CARS, PerCar, TrainData};
use proptest::prelude::*;
use protocol::message::{AtcToTcms, AtcToTcmsBits, Mode, ModeSwitch, Outputs};
use protocol::{Duration, Instant};

fn number() -> BoxedStrategy<f64> {
    prop_oneof![
        4 => -1e5..1e5,
        2 => 0.0..10.0,
        1 => prop::num::f64::ANY,
        1 => Just(f64::NAN),
        1 => Just(f64::INFINITY),
    ]
    .boxed()
}

fn cars() -> impl Strategy<Value = CarSet> {
    prop_oneof![
        3 => Just(CarSet::NONE),
        1 => prop::collection::vec(0..MAX_CARS, 0..4).prop_map(|cars| {
            cars.into_iter().fold(CarSet::NONE, |set, car| set.with(CarSet::one(car)))
        }),
    ]
}

fn per_car() -> BoxedStrategy<PerCar> {
    prop_oneof![Just([0.0; MAX_CARS]), prop::array::uniform12(number())].boxed()
}

/// A condition that holds seldom, so that the train comes to power at all.
fn seldom() -> impl Strategy<Value = bool> {
    prop::bool::weighted(0.05)
}

fn cab(hcr: f64) -> BoxedStrategy<CabInputs> {
    let volts = prop_oneof![3 => 0.0..10.0, 1 => number()];
    let controller = (any::<(bool, bool)>(), seldom(), volts, seldom()).prop_map(
        |((power, brake), neutral, volts, emergency)| ControllerInputs {
            power,
            brake,
            neutral,
            volts,
            emergency,
        },
    );
    let mode = prop_oneof![4 => 1_u8..6, 1 => any::<u8>()];
    let hcr = prop::bool::weighted(hcr);
    (
        hcr,
        -1_i8..2,
        mode,
        controller,
        any::<bool>(),
        seldom(),
        seldom(),
    )
        .prop_map(
            |(hcr, reverser, mode, controller, dead_man, emergency_button, forced_release)| {
                CabInputs {
                    hcr,
                    reverser,
                    mode_switch: ModeSwitch::from_code(mode),
                    controller,
                    dead_man,
                    emergency_button,
                    forced_release,
                }
            },
        )
        .boxed()
}

fn equipment() -> BoxedStrategy<Equipment> {
    let efforts = (per_car(), per_car(), per_car(), per_car());
    (efforts, cars(), cars(), cars(), seldom())
        .prop_map(
            |((axle_mps, traction_n, electric_n, air_n), inverters, regeneration, units, other)| {
                Equipment {
                    axle_mps,
                    traction_n,
                    electric_n,
                    air_n,
                    inverters_silent: inverters,
                    regeneration_cut_out: regeneration,
                    brake_units_silent: units,
                    other_brakes: other,
                }
            },
        )
        .boxed()
}

fn inputs() -> BoxedStrategy<TcmsInputs<'static>> {
    let switches = (seldom(), seldom(), seldom(), seldom(), seldom(), seldom());
    let contacts = prop_oneof![
        6 => Just(Some(Outputs::EB_RELAY)),
        1 => Just(None),
        1 => any::<u16>().prop_map(|bits| Some(Outputs::from_bits_retain(bits))),
    ];
    let cabs = [cab(0.95), cab(0.05)];
    (
        cabs,
        switches,
        cars(),
        cars(),
        contacts,
        number(),
        number(),
        any::<u32>(),
    )
        .prop_map(
            |(
                cabs,
                (doors, low, cut_out, security, parking, turn),
                brakes,
                motors,
                contacts,
                load,
                speed,
                refused,
            )| {
                TcmsInputs {
                    cabs,
                    doors_closed: !doors,
                    main_reservoir_low: low,
                    eb_cut_out: cut_out,
                    security_brake: security,
                    parking_brake: parking,
                    turn_back: turn,
                    brakes_cut_out: brakes,
                    inverters_cut_out: motors,
                    contacts,
                    load_kg: load,
                    equipment: None,
                    speed_mps: speed,
                    frames_refused: refused,
                }
            },
        )
        .boxed()
}

fn frame() -> impl Strategy<Value = AtcToTcms> {
    let mode =
        prop_oneof![4 => Just(Mode::AutomaticRun), 1 => any::<u8>().prop_map(Mode::from_code)];
    (
        any::<u8>(),
        mode,
        any::<i16>(),
        -1024_i16..1024,
        any::<bool>(),
    )
        .prop_map(|(bits, mode, wild, sound, is_sound)| AtcToTcms {
            bits: AtcToTcmsBits::from_bits_retain(bits.into()),
            mode,
            effort: if is_sound { sound } else { wild },
            ..AtcToTcms::default()
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn nothing_makes_it_fail_or_power_against_a_cut(
        scans in prop::collection::vec(
            (inputs(), prop::option::weighted(0.9, equipment()), prop::option::of(frame()), 0_u64..2000, 1_usize..6),
            1..40,
        ),
        ideal in any::<bool>(),
    ) {
        let train = if ideal { TrainData::ideal() } else { TrainData::line6() };
        let mut tcms = Tcms::new(&train);
        let mut now = Instant::ZERO;
        for (inputs, equipment, frame, ms, times) in &scans {
            let inputs = TcmsInputs { equipment: equipment.as_ref(), ..*inputs };
            for _ in 0..*times {
                now += Duration::from_ms(*ms);
                if let Some(frame) = frame {
                    tcms.atc.receive(now, frame);
                }
                let told = tcms.step(now, &inputs);
                let view = &tcms.view;
                let efforts = told.motor_n.iter().chain(&told.air_n);
                prop_assert!(efforts.chain([&told.demand, &told.load_kg]).all(|n| n.is_finite()));
                prop_assert!((-1.0..=1.0).contains(&told.demand));
                prop_assert!((-1024..=1023).contains(&view.driving.drytebe));
                prop_assert!(view.speed_mps.is_finite() && view.speed_mps >= 0.0);
                let cut = !view.power_cuts.is_empty();
                prop_assert!(!cut || !view.driving.dryinp && told.demand <= 0.0);
                if view.line.applied {
                    prop_assert!(told.emergency && told.motor_n.iter().all(|n| *n <= 0.0));
                }
                prop_assert!(told.air_n.iter().all(|n| *n >= 0.0));
            }
        }
        prop_assert!(tcms.take_events().len() <= 256);
    }
}
