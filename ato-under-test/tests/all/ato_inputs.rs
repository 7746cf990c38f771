//! Whatever ATO is given: the effort stays within its 10 bits and sign, nothing powers that must
//! not, and what cannot be believed brakes.

use crate::common::config;
use ato_under_test::ato::{Ato, AtoInputs, AtoOutputs, Checks, TrainReport};
use proptest::prelude::*;
use protocol::Speed;
use protocol::config::{ControllerKind, UnitConfig};
use protocol::line::{Curve, Gradient, Section};
use protocol::message::{AtoFailure, AtoState, Mode, RunningMode};

/// One cycle's inputs as drawn; the section is the printed one or made of drawn numbers.
#[derive(Clone, Debug)]
struct Drawn {
    mode: Mode,
    limit_mps: f64,
    fixed_mps: Option<f64>,
    section: Option<Section>,
    position_m: f64,
    ahead_m: f64,
    speed_mps: f64,
    standstill: bool,
    power_cut: bool,
    train: TrainReport,
    load_kg: f64,
    checks: Checks,
}

fn printed() -> Section {
    crate::common::line().section(61).unwrap().clone()
}

/// Mostly a value a train could have, now and then anything a float can be.
fn value(usual: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    prop_oneof![
        12 => usual,
        1 => any::<f64>(),
        1 => prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY), Just(-1.0)],
    ]
}

fn section() -> impl Strategy<Value = Option<Section>> {
    let made = (
        value(-10.0..2000.0),
        value(0.0..2000.0),
        prop::array::uniform4(value(0.0..2000.0)),
        value(-40.0..40.0),
        value(0.0..2000.0),
    )
        .prop_map(|(start_m, stop_m, markers_m, permille, radius_m)| {
            Some(Section {
                start_m,
                stop_m,
                markers_m,
                gradients: vec![Gradient {
                    at_m: 0.0,
                    permille,
                }],
                curves: vec![Curve {
                    at_m: start_m,
                    radius_m,
                    limit_kmh: None,
                }],
                ..printed()
            })
        });
    prop_oneof![8 => Just(Some(printed())), 1 => Just(None), 2 => made]
}

fn drawn() -> impl Strategy<Value = Drawn> {
    let state = (
        prop_oneof![8 => Just(Mode::AutomaticRun), 1 => Just(Mode::Automatic), 1 => Just(Mode::Manual)],
        prop_oneof![12 => Just(Checks::Passed), 1 => Just(Checks::Running),
            1 => Just(Checks::Failed(AtoFailure::Processor))],
        prop::bool::weighted(0.3),
        prop::bool::weighted(0.1),
    );
    let speeds = (
        value(0.0..22.0),
        prop::option::of(value(0.0..22.0)),
        value(0.0..20.0),
    );
    let places = (
        section(),
        value(-50.0..900.0),
        value(0.0..30.0),
        value(0.0..160e3),
        (
            prop::bool::weighted(0.2),
            any::<i16>(),
            any::<Option<i16>>(),
        ),
    );
    (state, speeds, places).prop_map(
        |((mode, checks, standstill, power_cut), (limit_mps, fixed_mps, speed_mps), place)| Drawn {
            mode,
            limit_mps,
            fixed_mps,
            section: place.0,
            position_m: place.1,
            ahead_m: place.2,
            speed_mps,
            standstill,
            power_cut,
            train: TrainReport {
                overrides: place.4.0,
                sent: place.4.1,
                given: place.4.2,
            },
            load_kg: place.3,
            checks,
        },
    )
}

fn step(
    ato: &mut Ato,
    drawn: &Drawn,
    UnitConfig {
        ato: config, codes, ..
    }: &UnitConfig,
) -> AtoOutputs {
    let inputs = AtoInputs {
        mode: drawn.mode,
        limit: Speed::from_mps(drawn.limit_mps),
        codes,
        heard_within_s: 1.0,
        fixed_speed: drawn.fixed_mps.map(Speed::from_mps),
        running_mode: RunningMode::Normal,
        section: drawn.section.as_ref(),
        position_m: drawn.position_m,
        ahead_m: drawn.ahead_m,
        aligned_m: 0.3,
        last_marker: true,
        jogs: true,
        speed: Speed::from_mps(drawn.speed_mps),
        standstill: drawn.standstill,
        power_cut: drawn.power_cut,
        train: drawn.train,
        load_kg: drawn.load_kg,
        checks: drawn.checks,
    };
    ato.step(inputs, config)
}

/// A sound cycle of a departure.
fn departing() -> Drawn {
    Drawn {
        mode: Mode::AutomaticRun,
        limit_mps: 18.0,
        fixed_mps: None,
        section: Some(printed()),
        position_m: 0.0,
        ahead_m: 0.0,
        speed_mps: 0.0,
        standstill: true,
        power_cut: false,
        train: TrainReport::default(),
        load_kg: 0.0,
        checks: Checks::Passed,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn any_inputs_give_an_effort_in_range_and_no_power_that_must_not_be(
        kind in prop::sample::select(ControllerKind::ALL.to_vec()),
        cycles in prop::collection::vec((drawn(), 1..40usize), 1..30),
    ) {
        let mut unit = config();
        unit.ato.controller = kind;
        let mut ato = Ato::new(&unit);
        for (drawn, times) in cycles {
            for _ in 0..times {
                let out = step(&mut ato, &drawn, &unit);
                prop_assert!((-1024..=1023).contains(&out.effort));
                prop_assert!(out.target.mps().is_finite() && out.target >= Speed::ZERO, "{:?}", out);
                let may_power = drawn.mode == Mode::AutomaticRun
                    && drawn.checks == Checks::Passed
                    && !drawn.power_cut
                    && out.failure == AtoFailure::None
                    && out.findings.absurd.is_empty();
                prop_assert!(may_power || out.effort <= 0, "{drawn:?} {out:?}");
                let doubts = !out.findings.absurd.is_empty() || out.failure != AtoFailure::None;
                let rolls = drawn.mode == Mode::AutomaticRun && !drawn.standstill;
                prop_assert!(!(doubts && rolls) || out.effort == -1024, "{drawn:?} {out:?}");
            }
        }
    }

    /// One absurd value while ATO drives is enough; back to normal, it drives again only after the
    /// run has ended and the train stands.
    #[test]
    fn one_absurd_value_ends_the_run(
        which in 0..6usize,
        bad in prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(-1e9), Just(1e9)],
    ) {
        let unit = config();
        let mut ato = Ato::new(&unit);
        let good = Drawn { speed_mps: 1.0, standstill: false, ..departing() };
        for _ in 0..5 {
            step(&mut ato, &departing(), &unit);
        }
        step(&mut ato, &Drawn { speed_mps: 0.5, ..good.clone() }, &unit);
        prop_assert_eq!(ato.state, AtoState::Run);
        let mut absurd = good.clone();
        match which {
            0 => absurd.speed_mps = bad,
            1 => absurd.position_m = bad,
            2 => absurd.load_kg = bad,
            3 => absurd.limit_mps = bad,
            4 => absurd.ahead_m = bad,
            _ => absurd.section.as_mut().unwrap().stop_m = bad,
        }
        let out = step(&mut ato, &absurd, &unit);
        prop_assert!(!out.findings.absurd.is_empty());
        prop_assert_eq!((out.effort, out.failure, out.ready), (-1024, AtoFailure::Inputs, false));
        let out = step(&mut ato, &good, &unit);
        prop_assert_eq!((out.effort, out.ready), (-1024, false));
        step(&mut ato, &Drawn { mode: Mode::Manual, ..departing() }, &unit);
        let out = step(&mut ato, &Drawn { mode: Mode::Manual, ..departing() }, &unit);
        prop_assert!(out.ready);
    }
}
