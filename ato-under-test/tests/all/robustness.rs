//! Whatever comes in, the unit stays safe: random handling by proptest, invariants after each scan.

use crate::common::Bench;
use proptest::prelude::*;
use protocol::message::{DoorSide, ModeSwitch, Outputs, TrainLines, TwcWayside};

/// Something a careless or broken bench does.
#[derive(Clone, Debug)]
enum Act {
    Code(u16, u16, u16),
    TableCode(usize),
    Speed([f64; 2]),
    Line(u16),
    Switch(u8),
    Controller(i8),
    Marker(u8),
    Counts(u16, u16),
    Station(Option<TwcWayside>),
    Io(bool),
    Bytes(Vec<u8>),
}

fn any_station((station, loop_id, side, departure): (u16, u16, u8, u8)) -> Act {
    Act::Station(Some(TwcWayside {
        station,
        loop_id,
        door_side: DoorSide::from_code(side),
        departure,
        ..crate::common::departure(&crate::common::line().sections[0])
    }))
}

fn act() -> impl Strategy<Value = Act> {
    prop_oneof![
        1 => (any::<u16>(), any::<u16>(), any::<u16>())
            .prop_map(|(a, b, c)| Act::Code(a, b, c)),
        3 => (0usize..7).prop_map(Act::TableCode),
        3 => (-5.0f64..30.0).prop_map(|v| Act::Speed([v; 2])),
        1 => (-5.0f64..30.0, -5.0f64..30.0).prop_map(|(a, b)| Act::Speed([a, b])),
        2 => (0u16..8).prop_map(Act::Line),
        1 => (0u8..8).prop_map(Act::Switch),
        1 => any::<i8>().prop_map(Act::Controller),
        1 => any::<u8>().prop_map(Act::Marker),
        1 => (any::<u16>(), any::<u16>()).prop_map(|(a, b)| Act::Counts(a, b)),
        1 => (820u16..826, 8230u16..8242, 0u8..5, 0u8..3).prop_map(any_station),
        1 => Just(Act::Station(None)),
        1 => any::<bool>().prop_map(Act::Io),
        1 => prop::collection::vec(any::<u8>(), 0..300).prop_map(Act::Bytes),
    ]
}

fn perform(bench: &mut Bench, act: &Act) {
    match act {
        Act::Code(carrier_hz, rate_chz, level_mv) => {
            bench.input.carrier_hz = *carrier_hz;
            bench.input.code_rate_chz = *rate_chz;
            bench.input.level_mv = *level_mv;
        }
        Act::TableCode(index) => {
            let name = crate::common::config().codes[*index].name.clone();
            bench.code(&name);
        }
        Act::Speed(speeds) => bench.speeds = *speeds,
        Act::Line(bit) => bench
            .input
            .lines
            .toggle(TrainLines::from_bits_retain(1 << bit)),
        Act::Switch(code) => bench.input.mode_switch = ModeSwitch::from_code(*code),
        Act::Controller(notch) => bench.input.controller = *notch,
        Act::Marker(marker) => bench.marker(*marker),
        Act::Counts(one, two) => bench.jump_counts(*one, *two),
        Act::Station(station) => bench.station = *station,
        Act::Io(on) => bench.io = *on,
        Act::Bytes(bytes) => bench.unit.receive(bytes),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    /// Goal: no input makes the unit panic, release the brake on a moving train, or open doors on
    /// one. Method: random acts, each followed by half a second of scans that are all checked.
    #[test]
    fn no_handling_makes_it_unsafe(acts in prop::collection::vec(act(), 1..40)) {
        let mut bench = Bench::new(&[]);
        for act in &acts {
            perform(&mut bench, act);
            for _ in 0..50 {
                let was_braking = bench.braking();
                bench.scan();
                let standing = bench.has(Outputs::STANDSTILL);
                prop_assert!(
                    !was_braking || bench.braking() || standing,
                    "released at {} cm/s after {act:?}", bench.output.speed_cms
                );
                let doors = bench.has(Outputs::DOOR_ENABLE_LEFT) || bench.has(Outputs::DOOR_ENABLE_RIGHT);
                prop_assert!(!doors || standing, "doors enabled while moving after {act:?}");
                prop_assert!((-1024..=1023).contains(&bench.status.effort));
            }
        }
    }

    /// Goal: a speed that stays beyond the emergency margin ends in the emergency brake, whatever
    /// the code. Method: any code and excess; step-down grace and brake proof are both over in 10 s.
    #[test]
    fn a_lasting_excess_always_brakes(index in 0usize..7, excess_kmh in 7.0f64..30.0) {
        let mut bench = Bench::new(&[]);
        let code = crate::common::config().codes[index].clone();
        bench.code(&code.name);
        bench.run(0.6);
        bench.speed_kmh(code.limit_kmh + excess_kmh);
        prop_assert!(bench.until(10.0, Bench::braking).is_some());
    }
}
