//! Orders of the wayside, and the train number keyed in at the cab, as frames.

use ato_under_test::Unit;
use protocol::event::Event;
use protocol::injection::{Effect, FaultMode, Place};
use protocol::message::{
    AtcToTcmsBits, CabEntries, Disarm, DoorSide, Mode, ModeSwitch, NumberState, OrderLacks,
    OrderState, Outputs, SelfTest, StatusBits, TrainLines, TrainOrder, TwcOrders, TwcReport,
    TwcWayside,
};

use super::common::{Bench, departure, fault_from, line, setup};
use super::maintenance::{SESSION, arm};

const OWN: u16 = 8001;

/// A unit at a wayside that gives orders.
struct Wayside {
    bench: Bench,
    orders: TwcOrders,
    report: Option<TwcReport>,
}

impl Wayside {
    fn new(faults: &[FaultMode]) -> Self {
        Self {
            bench: Bench::new(faults),
            orders: TwcOrders {
                train_number: OWN,
                ..TwcOrders::default()
            },
            report: None,
        }
    }

    /// Standing aligned at the end of the first section, driverless, with that station as destination.
    fn arrived(faults: &[FaultMode]) -> Self {
        let mut wayside = Self::new(faults);
        let section = line().sections[0].clone();
        let bench = &mut wayside.bench;
        bench.code("75");
        bench.run(1.0);
        let position_m = |bench: &Bench| f64::from(bench.status.position_cm) / 100.0;
        let marks = section.markers_m.map(|at_m| (60.0, at_m));
        let stop = [(10.0, section.stop_m - 2.0), (1.5, section.stop_m - 0.15)];
        for (passed, (kmh, to_m)) in marks.into_iter().chain(stop).enumerate() {
            let slow = section.stop_m - to_m < 50.0;
            bench.speed_kmh(if slow { f64::min(kmh, 10.0) } else { kmh });
            bench
                .until(120.0, |bench| position_m(bench) >= to_m)
                .unwrap();
            if passed < 4 {
                bench.input.marker = passed as u8 + 1;
                bench.input.marker_edges += 1;
                bench.input.marker_edge_us = 0;
            }
        }
        bench.speed_kmh(0.0);
        bench.station = Some(arrival());
        bench.input.mode_switch = ModeSwitch::Driverless;
        bench.run(2.0);
        assert!(bench.status.bits.contains(StatusBits::ALIGNED));
        assert_eq!(bench.status.mode, Mode::Automatic);
        wayside.orders.destination = section.to_station;
        wayside
    }

    fn run(&mut self, seconds: f64) {
        for scan in 0..(seconds * 100.0) as u32 {
            if scan.is_multiple_of(25) {
                self.bench.send(self.orders);
            }
            self.bench.scan();
        }
        self.report = self.bench.last();
    }

    /// Gives an order for a second, and returns its state then.
    fn order(&mut self, order: TrainOrder) -> OrderState {
        self.orders.order = order;
        self.run(1.0);
        self.state()
    }

    fn state(&self) -> OrderState {
        self.report.expect("orders are answered").order_state
    }

    fn parameters(&mut self, event: Event) -> Vec<i32> {
        self.bench.parameters(event.definition().name)
    }

    fn hcr(&mut self, on: bool) {
        self.bench.input.lines.set(TrainLines::HCR, on);
    }

    fn braked(&self) -> bool {
        !self.bench.has(Outputs::EB_RELAY)
    }

    fn asks(&self, bits: AtcToTcmsBits) -> bool {
        self.bench.to_tcms.bits.contains(bits)
    }
}

/// Station data at the end of the first section.
fn arrival() -> TwcWayside {
    let sections = line().sections;
    TwcWayside {
        station: sections[0].to_station,
        next_station: sections[1].to_station,
        loop_id: sections[0].to_loop,
        door_side: DoorSide::None,
        ..departure(&sections[0])
    }
}

/// Where the next section begins.
fn onward(departure_given: bool) -> TwcWayside {
    TwcWayside {
        departure: u8::from(departure_given),
        ..departure(&line().sections[1])
    }
}

#[test]
fn a_wayside_that_gives_no_orders_hears_no_report() {
    let mut bench = Bench::new(&[]);
    bench.run(2.0);
    assert_eq!(bench.last::<TwcReport>(), None);
}

#[test]
fn the_report_counts_frames_and_names_the_number_in_force() {
    let mut wayside = Wayside::new(&[]);
    wayside.run(1.0);
    let first = wayside.report.unwrap();
    assert_eq!((first.train_number, first.others), (OWN, 0));
    wayside.orders.destination = 999;
    wayside.run(1.0);
    wayside.orders.train_number = 9;
    wayside.run(1.0);
    let last = wayside.report.unwrap();
    let differs = |to: u16, from: u16| to.wrapping_sub(from);
    assert_eq!(differs(last.refused, first.refused), 4);
    assert_eq!(last.others, 4);
    assert_eq!(last.destination, 0, "what was refused is not in force");
    assert_eq!(
        wayside.parameters(Event::TwcWrongDestination),
        [999],
        "logged once"
    );
}

#[test]
fn a_number_keyed_in_counts_at_once_and_ends_with_the_power() {
    let mut wayside = Wayside::new(&[]);
    let key_in = |wayside: &mut Wayside, train_number| {
        for _ in 0..5 {
            wayside.bench.send(CabEntries { train_number });
            wayside.bench.run(0.05);
        }
        wayside.run(1.0);
        wayside.report.unwrap()
    };
    let keyed = key_in(&mut wayside, 8002);
    assert_eq!(keyed.train_number, 8002);
    assert_eq!(keyed.number_state, NumberState::Keyed);
    assert!(keyed.others >= 3, "data for the old number are passed over");
    wayside.orders.train_number = 8002;
    wayside.run(1.0);
    let confirmed = wayside.report.unwrap().number_state;
    assert_eq!(confirmed, NumberState::Confirmed);
    wayside.bench.code("25");
    wayside.bench.run(1.0);
    wayside.bench.speed_kmh(5.0);
    let refused = key_in(&mut wayside, 8003);
    assert_eq!(refused.train_number, 8002);
    assert_eq!(wayside.parameters(Event::TrainNumberRefused), [8003]);
}

#[test]
fn orders_in_the_wrong_place_are_refused_with_what_is_lacking() {
    type Change<'a> = &'a dyn Fn(&mut Wayside);
    let cases: [(TrainOrder, Change<'_>, OrderLacks); 7] = [
        (
            TrainOrder::TurnBack,
            &|wayside| wayside.bench.input.lines.remove(TrainLines::DOORS_CLOSED),
            OrderLacks::DOORS_CLOSED,
        ),
        (
            TrainOrder::TurnBack,
            &|wayside| wayside.orders.destination = line().sections[3].to_station,
            OrderLacks::AT_DESTINATION,
        ),
        (
            TrainOrder::TurnBack,
            &|wayside| wayside.bench.station = None,
            OrderLacks::AT_DESTINATION,
        ),
        (
            TrainOrder::TurnBack,
            &|wayside| wayside.bench.input.mode_switch = ModeSwitch::Manual,
            OrderLacks::DRIVERLESS,
        ),
        (
            TrainOrder::PutAway,
            &|wayside| wayside.bench.speed_kmh(3.0),
            OrderLacks::STANDSTILL,
        ),
        (
            TrainOrder::PutAway,
            &|wayside| wayside.hcr(false),
            OrderLacks::CAB_ACTIVE,
        ),
        (TrainOrder::WakeUp, &|_| {}, OrderLacks::PUT_AWAY),
    ];
    for (order, spoil, lacks) in cases {
        let mut wayside = Wayside::arrived(&[]);
        spoil(&mut wayside);
        wayside.run(1.5);
        assert_eq!(wayside.order(order), OrderState::Idle, "{order:?}");
        let refused = wayside.parameters(Event::OrderRefused);
        assert_eq!(refused, [i32::from(lacks.bits())], "{order:?} {lacks:?}");
    }
}

/// A tester has the train: whoever gives orders meanwhile gets a refusal, and nothing of it is left when the tester has gone.
#[test]
fn orders_are_refused_while_a_tester_is_armed_and_taken_when_it_has_gone() {
    let mut wayside = Wayside::arrived(&[]);
    wayside.bench.tcms_obeys = true;
    wayside
        .bench
        .input
        .lines
        .insert(TrainLines::MAINTENANCE_KEY);
    wayside.bench.code("0");
    wayside.run(2.0);
    assert_eq!(arm(&mut wayside.bench), None);
    assert_eq!(wayside.order(TrainOrder::PutAway), OrderState::Idle);
    let refused = wayside.parameters(Event::OrderRefused);
    assert_eq!(refused, [i32::from(OrderLacks::DISARMED.bits())]);
    wayside.bench.send(Disarm { session: SESSION });
    wayside.bench.session = 0;
    wayside.bench.code("75");
    wayside.run(3.0);
    assert_eq!(wayside.state(), OrderState::Idle);
    wayside.order(TrainOrder::None);
    assert_eq!(wayside.order(TrainOrder::PutAway), OrderState::PutAway);
}

#[test]
fn a_turn_back_hands_the_train_over_braked_and_takes_it_over_held() {
    let mut wayside = Wayside::arrived(&[]);
    assert_eq!(wayside.order(TrainOrder::TurnBack), OrderState::TurningBack);
    assert!(wayside.asks(AtcToTcmsBits::CHANGE_OF_CABS | AtcToTcmsBits::HOLDING_BRAKE));
    assert!(wayside.bench.has(Outputs::HOLDING_BRAKE));
    wayside.hcr(false);
    wayside.run(0.5);
    assert_eq!(wayside.state(), OrderState::HandedOver);
    assert!(wayside.braked() && wayside.bench.status.mode == Mode::Off);
    assert!(!wayside.asks(AtcToTcmsBits::CHANGE_OF_CABS));
    wayside.bench.station = Some(onward(true));
    wayside.hcr(true);
    wayside.run(2.0);
    assert_eq!(wayside.state(), OrderState::TakingOver);
    assert!(wayside.bench.has(Outputs::HOLDING_BRAKE));
    assert_ne!(
        wayside.bench.status.mode,
        Mode::AutomaticRun,
        "a departure of before"
    );
    wayside.bench.station = Some(onward(false));
    wayside.run(1.0);
    assert_eq!(wayside.state(), OrderState::Ready);
    assert_eq!(wayside.bench.status.mode, Mode::Automatic);
    wayside.bench.station = Some(onward(true));
    wayside.run(1.0);
    assert_eq!(wayside.bench.status.mode, Mode::AutomaticRun);
    assert_eq!(wayside.state(), OrderState::Idle);
    assert_eq!(wayside.parameters(Event::ChangeOfCabs), [1, 2]);
}

#[test]
fn cabs_that_are_not_changed_leave_the_train_held() {
    let mut wayside = Wayside::arrived(&[]);
    wayside.order(TrainOrder::TurnBack);
    wayside.bench.station = Some(onward(true));
    wayside.run(3.5);
    assert_eq!(wayside.state(), OrderState::Failed);
    assert!(wayside.bench.has(Outputs::HOLDING_BRAKE));
    assert_eq!(wayside.bench.status.mode, Mode::Automatic);
    assert_eq!(wayside.parameters(Event::CabsNotChanged), [0]);
}

#[test]
fn a_train_put_away_wakes_by_order_after_its_self_test() {
    let mut wayside = Wayside::arrived(&[]);
    assert_eq!(wayside.order(TrainOrder::PutAway), OrderState::PutAway);
    wayside.bench.station = Some(onward(true));
    wayside.run(3.0);
    assert_eq!(wayside.state(), OrderState::PutAway);
    assert!(wayside.braked() && wayside.bench.status.mode == Mode::Off);
    assert!(wayside.asks(AtcToTcmsBits::PUT_AWAY));
    assert_eq!(wayside.order(TrainOrder::WakeUp), OrderState::Waking);
    let started = |wayside: &Wayside| wayside.bench.status.bits.contains(StatusBits::STARTED);
    assert!(!started(&wayside) && wayside.braked());
    wayside.run(2.0);
    assert!(started(&wayside) && wayside.braked(), "departure is given");
    wayside.bench.station = Some(onward(false));
    wayside.run(1.0);
    assert_eq!(wayside.state(), OrderState::Ready);
    assert!(!wayside.braked() && !wayside.asks(AtcToTcmsBits::PUT_AWAY));
    assert_eq!(wayside.parameters(Event::WokenUp), [0]);
}

#[test]
fn somebody_at_the_cab_wakes_the_train_too() {
    let mut wayside = Wayside::arrived(&[]);
    wayside.order(TrainOrder::PutAway);
    wayside.bench.input.mode_switch = ModeSwitch::Manual;
    wayside.run(1.0);
    assert_eq!(wayside.state(), OrderState::Waking);
    wayside.run(2.0);
    assert_eq!(wayside.state(), OrderState::Idle);
    assert!(!wayside.braked() && wayside.bench.status.mode == Mode::Manual);
}

/// Goal: nobody runs after a self-test that failed, in whatever item. Method: TRA, which running needs, and the TEST board,
/// which it does not, fail while the train is put away.
#[test]
fn a_self_test_that_fails_lets_nobody_run() {
    wakes_failed(Place::Tra, SelfTest::TRA);
    wakes_failed(Place::TestBoard, SelfTest::TEST_BOARD);
}

fn wakes_failed(place: Place, item: SelfTest) {
    let mut wayside = Wayside::arrived(&[fault_from(place, Effect::Dead, 200.0)]);
    wayside.order(TrainOrder::PutAway);
    let to_onset: f64 = 201.0 - wayside.bench.now.as_us() as f64 / 1e6;
    wayside.run(to_onset.max(0.0));
    wayside.order(TrainOrder::WakeUp);
    wayside.run(2.0);
    assert_eq!(wayside.state(), OrderState::Failed);
    let bits = i32::from(item.bits());
    assert_eq!(wayside.parameters(Event::WokenUp), [bits]);
    wayside.bench.station = Some(onward(true));
    for _ in 0..200 {
        wayside.run(0.1);
        assert!(wayside.braked(), "it would roll");
        assert!(wayside.asks(AtcToTcmsBits::PUT_AWAY), "the parking brake");
        assert_eq!(wayside.bench.status.mode, Mode::Off);
    }
}

/// Goal: switching a train off and on does not wake it. Method: the flash of a unit that was put away is given to
/// one that is powered up.
#[test]
fn who_was_put_away_is_put_away_after_a_power_up() {
    for (order, expected) in [
        (TrainOrder::PutAway, OrderState::PutAway),
        (TrainOrder::WakeUp, OrderState::Idle),
    ] {
        let mut wayside = Wayside::arrived(&[]);
        wayside.order(TrainOrder::PutAway);
        wayside.order(order);
        wayside.run(3.0);
        let mut fresh = Wayside::new(&[]);
        fresh.bench.unit = Unit::with_flash(setup(&[]), wayside.bench.unit.power_off());
        fresh.bench.now = protocol::Instant::ZERO;
        fresh.bench.link = protocol::link::Link::new(protocol::link::End::Bench);
        fresh.bench.input.mode_switch = ModeSwitch::Driverless;
        fresh.run(3.0);
        assert_eq!(fresh.state(), expected, "{order:?}");
        assert_eq!(fresh.braked(), expected == OrderState::PutAway);
    }
}
