//! The sequence as a table, and after which ends a driverless train waits for a new departure.

use protocol::Duration;

use super::*;
use crate::for_tests::{parameters, with};

const GOOD: ModeInputs = ModeInputs {
    ready: true,
    cab_active: true,
    switch: ModeSwitch::Automatic,
    lacking: Refusals::empty(),
    departure: true,
    heard: Some(true),
    start: false,
    acknowledge: false,
    arrived: false,
    relocated: false,
    gave_up: false,
    line_open: false,
    line_fell: false,
    forced: false,
};

/// A driverless train with a departure given.
const DRIVERLESS: ModeInputs = ModeInputs {
    switch: ModeSwitch::Driverless,
    ..GOOD
};

/// The departure withheld.
fn withheld(inputs: ModeInputs) -> ModeInputs {
    with(inputs, |it| (it.departure, it.heard) = (false, Some(false)))
}

/// A switch at driverless, a departure that is heard given or withheld, and preconditions that do not hold.
fn driverless(departure: bool, lacking: Refusals) -> ModeInputs {
    ModeInputs {
        departure,
        heard: Some(departure),
        lacking,
        ..DRIVERLESS
    }
}

struct Train {
    sequence: ModeSequence,
    log: EventLog,
    now: Instant,
}

impl Train {
    fn new() -> Self {
        let (log, now) = (EventLog::default(), Instant::ZERO);
        let sequence = ModeSequence::new();
        Self { sequence, log, now }
    }

    /// The mode after so many steps, each that long after the one before.
    fn after(&mut self, steps: u64, ms: u64, inputs: ModeInputs) -> Mode {
        for _ in 0..steps {
            self.now += Duration::from_ms(ms);
            self.sequence.step(self.now, inputs, &mut self.log);
        }
        self.sequence.mode
    }
}

/// Goal: who opened the line is logged once. Method: a run that the line ends, at rest and in motion, read back or told by
/// TCMS; in motion the emergency brake logs a line that is read back.
#[test]
fn a_line_that_others_open_is_logged_once() {
    for (moves, line_fell, logged) in [
        (false, true, Some(0)),
        (false, false, Some(1)),
        (true, true, None),
        (true, false, Some(1)),
    ] {
        let mut train = Train::new();
        let mut after = |inputs| train.after(1, 600, inputs);
        after(GOOD);
        let run = with(GOOD, |it| it.start = true);
        assert_eq!(after(run), Mode::AutomaticRun);
        let mut lacking = Refusals::EB_APPLIED;
        lacking.set(Refusals::NOT_STANDSTILL, moves);
        let open = ModeInputs {
            line_open: true,
            line_fell,
            lacking,
            ..GOOD
        };
        assert_eq!((after(open), after(open)), (Mode::Manual, Mode::Manual));
        let told = parameters(&train.log, Event::LineOpened);
        assert!(told.into_iter().eq(logged), "{moves} {line_fell}");
    }
}

#[test]
fn an_emergency_brake_ends_the_run_and_the_next_departs_anew() {
    let switches = [
        (ModeSwitch::Automatic, true),
        (ModeSwitch::Driverless, false),
    ];
    let by_others = [true, false];
    for ((switch, start), line_open) in switches
        .into_iter()
        .flat_map(|one| by_others.map(|line_open| (one, line_open)))
    {
        let mut train = Train::new();
        let mut after = |inputs| (train.after(3, 600, inputs), train.sequence.stops);
        let given = with(GOOD, |it| (it.switch, it.start) = (switch, start));
        after(withheld(with(given, |it| it.start = false)));
        assert_eq!(after(given).0, Mode::AutomaticRun);
        let open = ModeInputs {
            lacking: Refusals::EB_APPLIED | Refusals::NOT_STANDSTILL,
            line_open,
            start: false,
            ..given
        };
        assert_eq!(after(open), (Mode::Manual, line_open));
        let moving = with(given, |it| {
            (it.lacking, it.start) = (Refusals::NOT_STANDSTILL, false)
        });
        assert_eq!(
            after(moving),
            (Mode::Manual, line_open),
            "closed again on the way"
        );
        let stands = with(given, |it| it.start = false);
        assert_eq!(after(stands), (Mode::Automatic, false));
        let again = match start {
            true => given,
            false => {
                after(withheld(stands));
                stands
            }
        };
        assert_eq!(after(again).0, Mode::AutomaticRun);
    }
}

/// Goal: a driverless train departs by what is given to it at rest, free to go. Method: a departure given in motion, and one
/// given under the emergency brake; both stay given.
#[test]
fn a_departure_given_on_the_way_or_under_the_brake_sends_no_train_off() {
    for lacking in [Refusals::NOT_STANDSTILL, Refusals::EB_APPLIED] {
        let mut train = Train::new();
        let mut after = |departure, lacking| train.after(1, 1_100, driverless(departure, lacking));
        let free = Refusals::empty();
        for (departure, lacking) in [(false, free), (false, lacking), (true, lacking)] {
            after(departure, lacking);
        }
        for _ in 0..3 {
            assert_eq!(after(true, free), Mode::Automatic, "{lacking:?}");
        }
        after(false, free);
        assert_eq!(after(true, free), Mode::AutomaticRun, "{lacking:?}");
    }
}

/// Goal: a run that was authorised by one position of the switch, or for one section, does not go on by another. Method: the
/// switch turned to automatic at rest and in motion, and data of the next section before the train has arrived.
#[test]
fn a_run_goes_on_by_the_switch_and_through_the_section_that_began_it() {
    let turned = |switch| ModeInputs { switch, ..GOOD };
    let moves = with(GOOD, |it| it.lacking = Refusals::NOT_STANDSTILL);
    let next_section = with(GOOD, |it| it.relocated = true);
    for (then, mode) in [
        (turned(ModeSwitch::Driverless), Mode::AutomaticRun),
        (turned(ModeSwitch::Automatic), Mode::Automatic),
        (moves, Mode::AutomaticRun),
        (next_section, Mode::Automatic),
    ] {
        let mut train = Train::new();
        let mut after = |inputs| train.after(1, 1_100, inputs);
        for departure in [false, false, true] {
            after(driverless(departure, Refusals::empty()));
        }
        assert_eq!(after(turned(ModeSwitch::Driverless)), Mode::AutomaticRun);
        assert_eq!(after(then), mode, "{then:?}");
    }
}

/// Goal: no run that ends on the way leaves the train to roll. Method: a door or the cab, as others read them, for a cycle.
#[test]
fn a_door_or_the_cab_that_ends_a_run_in_motion_stops_the_train() {
    let moves = Refusals::NOT_STANDSTILL;
    for (lost, stops) in [
        (Refusals::DOORS_OPEN, true),
        (Refusals::CAB_INACTIVE, true),
        (Refusals::CONTROLLER_NOT_NEUTRAL, false),
    ] {
        let mut train = Train::new();
        let mut after = |departure, lacking| {
            (
                train.after(1, 1_100, driverless(departure, lacking)),
                train.sequence.stops,
            )
        };
        after(false, Refusals::empty());
        after(false, Refusals::empty());
        after(true, Refusals::empty());
        assert_eq!(after(true, moves), (Mode::AutomaticRun, false), "{lost:?}");
        assert_eq!(after(true, moves | lost), (Mode::Manual, stops), "{lost:?}");
        assert_eq!(after(true, moves), (Mode::Manual, stops), "{lost:?}");
        after(true, Refusals::empty());
        let mode = after(true, Refusals::empty()).0;
        assert_eq!(
            mode,
            Mode::Automatic,
            "{lost:?}: by the departure from before"
        );
        after(false, Refusals::empty());
        assert_eq!(after(true, Refusals::empty()).0, Mode::AutomaticRun);
    }
}

#[test]
fn after_a_failure_of_ato_a_driverless_train_waits_for_a_new_departure() {
    let mut train = Train::new();
    let mut after = |inputs| (train.after(3, 600, inputs), train.sequence.refusals);
    let none = Refusals::empty();
    let waits = withheld(DRIVERLESS);
    assert_eq!(after(waits).0, Mode::Automatic);
    assert_eq!(after(DRIVERLESS), (Mode::AutomaticRun, none));
    let failed = with(DRIVERLESS, |it| it.lacking = Refusals::ATO_NOT_READY);
    let refused = (Mode::Manual, Refusals::ATO_NOT_READY);
    assert_eq!(after(failed), refused);
    assert_eq!(after(DRIVERLESS), refused, "ready again, not acknowledged");
    let acknowledged = with(DRIVERLESS, |it| it.acknowledge = true);
    assert_eq!(after(acknowledged), (Mode::Automatic, none));
    assert_eq!(
        after(DRIVERLESS),
        (Mode::Automatic, none),
        "the old departure"
    );
    assert_eq!(after(waits).0, Mode::Automatic);
    assert_eq!(after(DRIVERLESS).0, Mode::AutomaticRun);
    assert_eq!(after(failed), refused);
    let manual = with(GOOD, |it| it.switch = ModeSwitch::Manual);
    assert_eq!(after(manual).0, Mode::Manual);
    assert_eq!(after(DRIVERLESS).0, Mode::Automatic);
    let pressed = with(DRIVERLESS, |it| it.start = true);
    assert_eq!(after(pressed).0, Mode::AutomaticRun);
}

/// Goal: neither a power-up nor mode off in a run lets a driverless train drive off by the departure that is still given.
/// Method: that departure is the first thing heard, is heard again after silence, then withheld and given again.
#[test]
fn after_a_power_up_or_mode_off_a_driverless_train_waits_for_a_new_departure() {
    let (given, withheld) = (DRIVERLESS, withheld(DRIVERLESS));
    let silent = with(given, |it| (it.departure, it.heard) = (false, None));
    let cab_lost = with(given, |it| {
        (it.cab_active, it.lacking) = (false, Refusals::CAB_INACTIVE)
    });
    let starting = with(silent, |it| it.ready = false);
    let mut train = Train::new();
    let mut after = |inputs| train.after(3, 600, inputs);
    for off in [starting, cab_lost] {
        assert_eq!(after(off), Mode::Off);
        assert_eq!(after(given), Mode::Automatic, "the old departure");
        after(silent);
        assert_eq!(after(given), Mode::Automatic, "heard again after silence");
        after(withheld);
        after(silent);
        assert_eq!(after(given), Mode::AutomaticRun, "given again");
    }
    after(cab_lost);
    assert_eq!(after(given), Mode::Automatic);
    let pressed = with(given, |it| it.start = true);
    assert_eq!(after(pressed), Mode::AutomaticRun, "by the start button");
}

/// Goal: a departure is for a train that may go. Method: it is withheld and given again while the emergency brake is applied,
/// and while a failure of ATO is not acknowledged; then the brake is released, the failure acknowledged.
#[test]
fn a_departure_given_while_the_train_is_held_does_not_count_afterwards() {
    let (given, withheld) = (DRIVERLESS, withheld(DRIVERLESS));
    let acknowledged = with(given, |it| it.acknowledge = true);
    for held in [Refusals::EB_APPLIED, Refusals::ATO_NOT_READY] {
        let mut train = Train::new();
        let mut after = |inputs| train.after(3, 600, inputs);
        let lacking = |inputs: ModeInputs| with(inputs, |it| it.lacking = held);
        after(lacking(given));
        after(lacking(withheld));
        after(lacking(given));
        // A unit that was powered up is released with that departure still there, as one that ended a run is.
        if held == Refusals::EB_APPLIED {
            assert_eq!(after(acknowledged), Mode::Automatic, "powered up");
        }
        after(withheld);
        assert_eq!(after(given), Mode::AutomaticRun);
        assert_eq!(after(lacking(given)), Mode::Manual);
        after(lacking(withheld));
        after(lacking(given));
        after(acknowledged);
        assert_eq!(after(given), Mode::Automatic, "{held:?}: given before");
        after(withheld);
        assert_eq!(after(given), Mode::AutomaticRun, "given again");
        // Withheld while it was held, and given when it may go.
        after(lacking(given));
        after(lacking(withheld));
        after(with(withheld, |it| it.acknowledge = true));
        assert_eq!(after(given), Mode::AutomaticRun, "{held:?}: given after");
    }
}

/// A switch that passes driverless, and a door that was forced at a stop, send no train off by the departure that is given.
#[test]
fn a_position_that_is_passed_and_a_forced_door_begin_no_run() {
    let mut train = Train::new();
    let mut after = |ms: u64, inputs| train.after(ms / 50, 50, inputs);
    let emergency = with(GOOD, |it| it.switch = ModeSwitch::Emergency);
    after(2_000, withheld(emergency));
    after(2_000, emergency);
    assert_eq!(after(400, DRIVERLESS), Mode::Automatic, "passed");
    assert_eq!(after(2_000, GOOD), Mode::Automatic);
    assert_eq!(after(1_200, DRIVERLESS), Mode::AutomaticRun, "chosen");
    after(200, with(withheld(DRIVERLESS), |it| it.arrived = true));
    after(200, DRIVERLESS);
    after(
        100,
        ModeInputs {
            arrived: true,
            forced: true,
            lacking: Refusals::DOORS_OPEN,
            ..DRIVERLESS
        },
    );
    assert_eq!(after(2_000, DRIVERLESS), Mode::Automatic, "forced");
    after(200, withheld(DRIVERLESS));
    assert_eq!(after(200, DRIVERLESS), Mode::AutomaticRun, "given again");
}

#[test]
fn the_sequence_is_this_table() {
    let lacking = |r| with(GOOD, |it| it.lacking = r);
    let switch = |s| with(GOOD, |it| it.switch = s);
    let moves = Refusals::NOT_STANDSTILL;
    let of_run = [
        (lacking(moves), Mode::AutomaticRun),
        (lacking(Refusals::NO_TWC), Mode::AutomaticRun),
        (lacking(Refusals::DOORS_OPEN), Mode::Manual),
        (lacking(Refusals::ATO_NOT_READY), Mode::Manual),
        (lacking(Refusals::ATO_NOT_READY | moves), Mode::AutomaticRun),
        (
            lacking(Refusals::TCMS_NOT_READY | moves),
            Mode::AutomaticRun,
        ),
        (lacking(Refusals::TCMS_NOT_READY), Mode::Manual),
        (with(GOOD, |it| it.arrived = true), Mode::Automatic),
        (switch(ModeSwitch::Manual), Mode::Manual),
        (with(GOOD, |it| it.cab_active = false), Mode::Off),
    ];
    let of_run = of_run.map(|(inputs, to)| (Mode::AutomaticRun, inputs, false, to));
    let (lost, starting) = (lacking(Refusals::NO_TWC), with(GOOD, |it| it.ready = false));
    let others = [
        (Mode::Manual, GOOD, false, Mode::Automatic),
        (Mode::Manual, GOOD, true, Mode::Automatic),
        (Mode::Automatic, GOOD, true, Mode::AutomaticRun),
        (Mode::Automatic, lost, true, Mode::Manual),
        (Mode::Manual, starting, true, Mode::Off),
        (Mode::Off, switch(ModeSwitch::Yard), false, Mode::Yard),
        (Mode::Off, switch(ModeSwitch::Unknown(9)), false, Mode::Off),
    ];
    for (from, inputs, departing, to) in of_run.into_iter().chain(others) {
        let then = next(from, &inputs, departing);
        assert_eq!(then, to, "{from:?} {inputs:?} {departing}");
    }
}
