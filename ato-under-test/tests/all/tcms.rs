//! Reports of TCMS to the unit: who opens the emergency brake line, what lets a train not run, and
//! whose fault it is that a train does not do what ATO asks.

use crate::common::{Bench, fault};
use crate::journey::Journey;
use protocol::event::Event;
use protocol::injection::{Effect, Place};
use protocol::message::{
    AtcToTcmsBits, AtoFailure, AtoState, FsbCause, Mode, ModeSwitch, Outputs, Refusals, TcmsToAtc,
    TcmsToAtcBits, TrainLines,
};
use protocol::{LruId, SCAN};

/// TCMS says this besides that ATO may run.
fn says(bench: &mut Bench, bits: TcmsToAtcBits) {
    if let Some(tcms) = &mut bench.tcms {
        tcms.bits = TcmsToAtcBits::ATO_ENABLE | bits;
    }
}

/// Parts the unit suspects by its log.
fn suspects(journey: &mut Journey) -> Vec<LruId> {
    journey.faults();
    let entries = journey.bench.log.iter();
    let parts = entries.filter_map(|e| Event::from_code(e.code)?.suspect(e.parameter));
    parts.collect()
}

#[test]
fn a_line_that_something_else_opens_is_not_blamed_on_the_relay() {
    for controller in [0, -8] {
        let mut bench = Bench::new(&[]);
        bench.opens_line = true;
        bench.input.controller = controller;
        bench.run(5.0);
        assert!(
            !bench.braking() && bench.has(Outputs::HEALTHY),
            "{controller}"
        );
        bench.opens_line = false;
        bench.run(1.0);
        assert!(!bench.events().contains(&"eb_relay_open"));
    }
}

/// The relay picks up and the line it is fed from stays dead behind it.
#[test]
fn an_open_relay_is_noticed_while_the_line_is_fed() {
    let open = fault(Place::EbRelay, Effect::StuckOff);
    let mut bench = Bench::new(std::slice::from_ref(&open));
    assert!(bench.events().contains(&"eb_relay_open"));
    assert!(!bench.has(Outputs::HEALTHY));

    let mut unfed = Bench::unfed(&[open]);
    unfed.run(5.0);
    assert!(!unfed.events().contains(&"eb_relay_open"));
    unfed.opens_line = false;
    unfed.run(2.0);
    assert!(unfed.events().contains(&"eb_relay_open"));
}

#[test]
fn a_train_that_cannot_run_does_not_start() {
    let mut bench = Bench::new(&[]);
    bench.code("65");
    bench.input.mode_switch = ModeSwitch::Automatic;
    bench.run(1.5);
    assert_eq!(bench.status.mode, Mode::Automatic);
    says(&mut bench, TcmsToAtcBits::BRAKE_NOT_RELEASED);
    bench.run(0.2);
    assert_eq!(bench.status.mode, Mode::Manual);
    assert!(bench.status.refusals.contains(Refusals::TCMS_NOT_READY));
    says(&mut bench, TcmsToAtcBits::empty());
    bench.run(0.2);
    assert_eq!(bench.status.mode, Mode::Automatic);
}

/// Braking hides a brake that is not released, so what TCMS says is kept: the train is braked until it
/// stands, and does not depart by itself.
#[test]
fn a_brake_that_is_not_released_on_the_way_stops_the_run() {
    let reasons = [
        (TcmsToAtcBits::BRAKE_NOT_RELEASED, true),
        (TcmsToAtcBits::empty(), false),
    ];
    for (bits, may_run) in reasons {
        let mut journey = Journey::new(&[]).until_position(200.0);
        says(&mut journey.bench, bits);
        if let Some(tcms) = journey.bench.tcms.as_mut().filter(|_| !may_run) {
            tcms.bits.remove(TcmsToAtcBits::ATO_ENABLE);
        }
        (0..20).for_each(|_| journey.step());
        assert!(journey.bench.has(Outputs::FSB));
        assert_eq!(journey.bench.status.fsb_cause, FsbCause::NotPermitted);
        assert_eq!(
            journey.bench.status.mode,
            Mode::AutomaticRun,
            "until it stands"
        );
        says(&mut journey.bench, TcmsToAtcBits::empty());
        let mut journey = journey.run();
        assert_eq!(journey.bench.status.mode, Mode::Manual);
        let told = journey.bench.to_tcms.bits;
        assert!(
            journey.bench.has(Outputs::HOLDING_BRAKE)
                && told.contains(AtcToTcmsBits::HOLDING_BRAKE),
            "no cab has it yet"
        );
        let refusals = journey.bench.status.refusals;
        assert!(refusals.contains(Refusals::TCMS_NOT_READY));
        journey.bench.acknowledge();
        assert_eq!(journey.bench.status.mode, Mode::Automatic);
        assert_eq!(suspects(&mut journey), [""; 0]);
    }
}

#[test]
fn a_lost_link_brakes_until_the_train_stands_and_a_standing_counter_names_tcms() {
    for (stands, part) in [(false, "rs485_link"), (true, "tcms")] {
        let mut journey = Journey::new(&[]).until_position(200.0);
        journey.bench.alive_stands = stands;
        journey.bench.tcms = journey.bench.tcms.filter(|_| stands);
        (0..100).for_each(|_| journey.step());
        assert_eq!(journey.bench.status.fsb_cause, FsbCause::TcmsLost);
        assert_eq!(journey.bench.status.mode, Mode::AutomaticRun);
        let mut journey = journey.run();
        assert_eq!(journey.bench.status.mode, Mode::Manual);
        assert_eq!(suspects(&mut journey), [part]);
    }
}

/// TCMS cuts powering or brakes by itself in mid-run; when it lets the train go, ATO goes on.
#[test]
fn what_tcms_does_by_itself_is_not_the_units_fault() {
    for bits in [
        TcmsToAtcBits::FULL_SERVICE_BRAKE | TcmsToAtcBits::POWERING_CUT,
        TcmsToAtcBits::POWERING_CUT,
        TcmsToAtcBits::HOLDING_BRAKE_APPLIED | TcmsToAtcBits::POWERING_CUT,
    ] {
        let mut journey = Journey::new(&[]).until_position(100.0);
        says(&mut journey.bench, bits);
        journey.by_tcms_mps2 = Some(if bits == TcmsToAtcBits::POWERING_CUT {
            0.0
        } else {
            -3.5 / 3.6
        });
        (0..3000).for_each(|_| journey.step());
        let state = journey.bench.status.ato_state;
        assert!(
            matches!(state, AtoState::Start | AtoState::Run | AtoState::Stop),
            "{state:?}"
        );
        says(&mut journey.bench, TcmsToAtcBits::empty());
        journey.by_tcms_mps2 = None;
        let mut journey = journey.run();
        let error_m = journey.stop_error_m();
        assert!(error_m.abs() < 0.3, "{bits:?}: {error_m}");
        let mut faults = journey.faults();
        // The train stood on the way, where no door may open.
        faults.retain(|event| *event != "door_enable_refused");
        assert_eq!(faults, [""; 0], "{bits:?}");
    }
}

/// Goal: a brake line that others open ends the run, and no train goes on by itself when it is closed again. Method: TCMS
/// tells that the line is open in mid-run, then no more; departure stays given.
#[test]
fn a_line_that_tcms_tells_to_be_open_ends_the_run() {
    let mut journey = Journey::new(&[]).until_position(100.0);
    let open = TcmsToAtcBits::EMERGENCY_BRAKE_APPLIED | TcmsToAtcBits::POWERING_CUT;
    says(&mut journey.bench, open);
    journey.by_tcms_mps2 = Some(-3.5 / 3.6);
    (0..100).for_each(|_| journey.step());
    assert_eq!(journey.bench.status.mode, Mode::Manual);
    says(&mut journey.bench, TcmsToAtcBits::empty());
    (0..20).for_each(|_| journey.step());
    assert_eq!(journey.bench.status.fsb_cause, FsbCause::NotPermitted);
    (0..4000).for_each(|_| journey.step());
    assert_eq!(journey.bench.status.mode, Mode::Automatic);
    assert_eq!(journey.bench.status.speed1_cms, 0);
    if let Some(station) = &mut journey.bench.station {
        station.departure = 1;
    }
    (0..50).for_each(|_| journey.step());
    assert_eq!(journey.bench.status.mode, Mode::Automatic);
    journey.bench.input.lines.insert(TrainLines::START);
    (0..200).for_each(|_| journey.step());
    assert_eq!(journey.bench.status.mode, Mode::AutomaticRun);
}

/// A train that gives a tenth of what it is sent: reported by TCMS it is the train's, a brake that is missing
/// ends the run all the same; a TCMS that says it gives all leaves ATO under suspicion.
#[test]
fn a_train_that_withholds_effort_by_its_own_word_is_not_atos_failure() {
    let failing = |says: f64| {
        let mut journey = Journey::new(&[]).until_position(400.0);
        (journey.follows, journey.says) = (0.1, says);
        let mut journey = journey.run();
        let parts = suspects(&mut journey);
        (
            journey.faults(),
            journey.bench.parameters("ato_failed"),
            parts,
        )
    };
    let (faults, failed, parts) = failing(0.1);
    assert!(faults.contains(&"train_withholds"), "{faults:?}");
    assert!(!faults.contains(&"ato_not_following"), "{faults:?}");
    assert_eq!(failed, [i32::from(AtoFailure::TrainWithholds.code())]);
    assert!(!parts.contains(&LruId::from_static("ato_cpu")), "{parts:?}");
    let (faults, failed, _) = failing(1.0);
    assert!(faults.contains(&"ato_not_following"), "{faults:?}");
    assert_eq!(failed, [i32::from(AtoFailure::NotFollowing.code())]);
}

/// Power that is withheld is reported once, and the run goes on with what there is.
#[test]
fn a_train_with_little_power_runs_late_and_is_told() {
    let mut journey = Journey::new(&[]);
    (journey.follows, journey.says) = (0.15, 0.15);
    while journey.x_m < 60.0 {
        journey.step();
    }
    (journey.follows, journey.says) = (1.0, 1.0);
    let mut journey = journey.run();
    assert_eq!(journey.faults(), ["train_withholds"]);
    assert!(journey.bench.parameters("train_withholds")[0] < 0);
    assert!(journey.stop_error_m().abs() < 0.3);
}

/// The effort that ATO's processor spoils is read back: then the train is not said to withhold it.
#[test]
fn an_effort_that_is_spoilt_before_it_is_sent_stays_atos() {
    let limited = fault(Place::AtoCpu, Effect::Limit { to: 100.0 });
    let mut journey = Journey::new(&[limited]);
    let mut seconds = 0.0;
    while journey.bench.status.ato_state != AtoState::Inspection && seconds < 60.0 {
        journey.step();
        seconds += SCAN.as_secs();
    }
    let faults = journey.faults();
    assert!(faults.contains(&"ato_not_following"), "{faults:?}");
    assert!(!faults.contains(&"train_withholds"), "{faults:?}");
}

/// Frames that no train can mean: counted, and the link given up with the safe reaction.
#[test]
fn frames_that_make_no_sense_are_as_good_as_lost() {
    for (effort, load_100kg) in [(4000, 0), (0, 60_000)] {
        let mut bench = Bench::new(&[]);
        bench.tcms = Some(TcmsToAtc {
            bits: TcmsToAtcBits::ATO_ENABLE,
            effort,
            load_100kg,
            ..TcmsToAtc::default()
        });
        bench.run(2.0);
        assert!(bench.status.refusals.contains(Refusals::TCMS_NOT_READY));
        let begin = ["power_up", "mode_changed", "eb_released"];
        let events = bench.events();
        assert_eq!(events[..3], begin);
        assert_eq!(events[3..], ["tcms_lost", "frames_rejected"]);
    }
}
