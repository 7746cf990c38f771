//! The sequence as a table, and after which ends a driverless train waits for a new departure.

use protocol::Duration;

use super::*;

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

/// A switch at driverless, a departure that is heard given or withheld, and preconditions that do not hold.
fn driverless(departure: bool, lacking: Refusals) -> ModeInputs {
    ModeInputs {
        switch: ModeSwitch::Driverless,
        departure,
        heard: Some(departure),
        lacking,
        ..GOOD
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
        let mut sequence = ModeSequence::new();
        let mut log = EventLog::default();
        let mut now = Instant::ZERO;
        let mut after = |inputs| {
            now += Duration::from_ms(600);
            sequence.step(now, inputs, &mut log);
            sequence.mode()
        };
        after(GOOD);
        let run = ModeInputs {
            start: true,
            ..GOOD
        };
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
        let code = Event::LineOpened.definition().code;
        let entries = (0..log.next_index()).filter_map(|at| log.entries().at_or_after(at));
        let of_line = entries.filter(|entry| entry.code == code);
        let parameters = of_line.map(|entry| entry.parameter);
        assert!(parameters.eq(logged), "{moves} {line_fell}");
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
        let mut sequence = ModeSequence::new();
        let mut log = EventLog::default();
        let mut now = Instant::ZERO;
        let mut after = |inputs| {
            for _ in 0..3 {
                now += Duration::from_ms(600);
                sequence.step(now, inputs, &mut log);
            }
            (sequence.mode(), sequence.stops())
        };
        let given = ModeInputs {
            switch,
            start,
            ..GOOD
        };
        after(ModeInputs {
            start: false,
            departure: false,
            heard: Some(false),
            ..given
        });
        assert_eq!(after(given).0, Mode::AutomaticRun);
        let open = ModeInputs {
            lacking: Refusals::EB_APPLIED | Refusals::NOT_STANDSTILL,
            line_open,
            start: false,
            ..given
        };
        assert_eq!(after(open), (Mode::Manual, line_open));
        let moving = ModeInputs {
            lacking: Refusals::NOT_STANDSTILL,
            start: false,
            ..given
        };
        assert_eq!(
            after(moving),
            (Mode::Manual, line_open),
            "closed again on the way"
        );
        let stands = ModeInputs {
            start: false,
            ..given
        };
        assert_eq!(after(stands), (Mode::Automatic, false));
        let again = match start {
            true => given,
            false => {
                after(ModeInputs {
                    departure: false,
                    heard: Some(false),
                    ..stands
                });
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
        let mut sequence = ModeSequence::new();
        let mut log = EventLog::default();
        let mut now = Instant::ZERO;
        let mut after = |departure, lacking| {
            now += Duration::from_ms(1_100);
            sequence.step(now, driverless(departure, lacking), &mut log);
            sequence.mode()
        };
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
    let moves = ModeInputs {
        lacking: Refusals::NOT_STANDSTILL,
        ..GOOD
    };
    let next_section = ModeInputs {
        relocated: true,
        ..GOOD
    };
    for (then, mode) in [
        (turned(ModeSwitch::Driverless), Mode::AutomaticRun),
        (turned(ModeSwitch::Automatic), Mode::Automatic),
        (moves, Mode::AutomaticRun),
        (next_section, Mode::Automatic),
    ] {
        let mut sequence = ModeSequence::new();
        let mut log = EventLog::default();
        let mut now = Instant::ZERO;
        let mut after = |inputs| {
            now += Duration::from_ms(1_100);
            sequence.step(now, inputs, &mut log);
            sequence.mode()
        };
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
        let mut sequence = ModeSequence::new();
        let mut log = EventLog::default();
        let mut now = Instant::ZERO;
        let mut after = |departure, lacking| {
            now += Duration::from_ms(1_100);
            sequence.step(now, driverless(departure, lacking), &mut log);
            (sequence.mode(), sequence.stops())
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
    let mut sequence = ModeSequence::new();
    let mut log = EventLog::default();
    let driverless = ModeInputs {
        switch: ModeSwitch::Driverless,
        ..GOOD
    };
    let mut now = Instant::ZERO;
    let mut after = |inputs| {
        for _ in 0..3 {
            now += Duration::from_ms(600);
            sequence.step(now, inputs, &mut log);
        }
        (sequence.mode(), sequence.refusals())
    };
    let none = Refusals::empty();
    let waits = ModeInputs {
        departure: false,
        heard: Some(false),
        ..driverless
    };
    assert_eq!(after(waits).0, Mode::Automatic);
    assert_eq!(after(driverless), (Mode::AutomaticRun, none));
    let failed = ModeInputs {
        lacking: Refusals::ATO_NOT_READY,
        ..driverless
    };
    let refused = (Mode::Manual, Refusals::ATO_NOT_READY);
    assert_eq!(after(failed), refused);
    assert_eq!(after(driverless), refused, "ready again, not acknowledged");
    let acknowledged = ModeInputs {
        acknowledge: true,
        ..driverless
    };
    assert_eq!(after(acknowledged), (Mode::Automatic, none));
    assert_eq!(
        after(driverless),
        (Mode::Automatic, none),
        "the old departure"
    );
    assert_eq!(after(waits).0, Mode::Automatic);
    assert_eq!(after(driverless).0, Mode::AutomaticRun);
    assert_eq!(after(failed), refused);
    let manual = ModeInputs {
        switch: ModeSwitch::Manual,
        ..GOOD
    };
    assert_eq!(after(manual).0, Mode::Manual);
    assert_eq!(after(driverless).0, Mode::Automatic);
    let pressed = ModeInputs {
        start: true,
        ..driverless
    };
    assert_eq!(after(pressed).0, Mode::AutomaticRun);
}

/// A departure given to a driverless train, and the same train with it withheld.
fn departure() -> (ModeInputs, ModeInputs) {
    let given = ModeInputs {
        switch: ModeSwitch::Driverless,
        ..GOOD
    };
    let withheld = ModeInputs {
        departure: false,
        heard: Some(false),
        ..given
    };
    (given, withheld)
}

/// Goal: neither a power-up nor mode off in a run lets a driverless train drive off by the departure that is still given.
/// Method: that departure is the first thing heard, is heard again after silence, then withheld and given again.
#[test]
fn after_a_power_up_or_mode_off_a_driverless_train_waits_for_a_new_departure() {
    let (given, withheld) = departure();
    let silent = ModeInputs {
        departure: false,
        heard: None,
        ..given
    };
    let cab_lost = ModeInputs {
        cab_active: false,
        lacking: Refusals::CAB_INACTIVE,
        ..given
    };
    let starting = ModeInputs {
        ready: false,
        ..silent
    };
    let mut sequence = ModeSequence::new();
    let mut log = EventLog::default();
    let mut now = Instant::ZERO;
    let mut after = |inputs| {
        for _ in 0..3 {
            now += Duration::from_ms(600);
            sequence.step(now, inputs, &mut log);
        }
        sequence.mode()
    };
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
    let pressed = ModeInputs {
        start: true,
        ..given
    };
    assert_eq!(after(pressed), Mode::AutomaticRun, "by the start button");
}

/// Goal: a departure is for a train that may go. Method: it is withheld and given again while the emergency brake is applied,
/// and while a failure of ATO is not acknowledged; then the brake is released, the failure acknowledged.
#[test]
fn a_departure_given_while_the_train_is_held_does_not_count_afterwards() {
    let (given, withheld) = departure();
    let acknowledged = ModeInputs {
        acknowledge: true,
        ..given
    };
    for held in [Refusals::EB_APPLIED, Refusals::ATO_NOT_READY] {
        let mut sequence = ModeSequence::new();
        let mut log = EventLog::default();
        let mut now = Instant::ZERO;
        let mut after = |inputs| {
            for _ in 0..3 {
                now += Duration::from_ms(600);
                sequence.step(now, inputs, &mut log);
            }
            sequence.mode()
        };
        let lacking = |inputs| ModeInputs {
            lacking: held,
            ..inputs
        };
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
        after(ModeInputs {
            acknowledge: true,
            ..withheld
        });
        assert_eq!(after(given), Mode::AutomaticRun, "{held:?}: given after");
    }
}

/// A switch that passes driverless, and a door that was forced at a stop, send no train off by the departure that is given.
#[test]
fn a_position_that_is_passed_and_a_forced_door_begin_no_run() {
    let driverless = ModeInputs {
        switch: ModeSwitch::Driverless,
        ..GOOD
    };
    let withheld = ModeInputs {
        heard: Some(false),
        departure: false,
        ..driverless
    };
    let (mut sequence, mut log) = (ModeSequence::new(), EventLog::default());
    let mut now = Instant::ZERO;
    let mut after = |ms: u64, inputs| {
        for _ in 0..ms / 50 {
            now += Duration::from_ms(50);
            sequence.step(now, inputs, &mut log);
        }
        sequence.mode()
    };
    let emergency = ModeInputs {
        switch: ModeSwitch::Emergency,
        ..GOOD
    };
    after(
        2_000,
        ModeInputs {
            heard: Some(false),
            departure: false,
            ..emergency
        },
    );
    after(2_000, emergency);
    assert_eq!(after(400, driverless), Mode::Automatic, "passed");
    assert_eq!(after(2_000, GOOD), Mode::Automatic);
    assert_eq!(after(1_200, driverless), Mode::AutomaticRun, "chosen");
    after(
        200,
        ModeInputs {
            arrived: true,
            ..withheld
        },
    );
    after(200, driverless);
    after(
        100,
        ModeInputs {
            arrived: true,
            forced: true,
            lacking: Refusals::DOORS_OPEN,
            ..driverless
        },
    );
    assert_eq!(after(2_000, driverless), Mode::Automatic, "forced");
    after(200, withheld);
    assert_eq!(after(200, driverless), Mode::AutomaticRun, "given anew");
}

#[test]
fn the_sequence_is_this_table() {
    let lacking = |r| ModeInputs { lacking: r, ..GOOD };
    let switch = |s| ModeInputs { switch: s, ..GOOD };
    let cases = [
        (Mode::Manual, GOOD, false, Mode::Automatic),
        (Mode::Manual, GOOD, true, Mode::Automatic),
        (Mode::Automatic, GOOD, true, Mode::AutomaticRun),
        (
            Mode::Automatic,
            lacking(Refusals::NO_TWC),
            true,
            Mode::Manual,
        ),
        (
            Mode::AutomaticRun,
            lacking(Refusals::NOT_STANDSTILL),
            false,
            Mode::AutomaticRun,
        ),
        (
            Mode::AutomaticRun,
            lacking(Refusals::NO_TWC),
            false,
            Mode::AutomaticRun,
        ),
        (
            Mode::AutomaticRun,
            lacking(Refusals::DOORS_OPEN),
            false,
            Mode::Manual,
        ),
        (
            Mode::AutomaticRun,
            lacking(Refusals::ATO_NOT_READY),
            false,
            Mode::Manual,
        ),
        (
            Mode::AutomaticRun,
            lacking(Refusals::ATO_NOT_READY.union(Refusals::NOT_STANDSTILL)),
            false,
            Mode::AutomaticRun,
        ),
        (
            Mode::AutomaticRun,
            lacking(Refusals::TCMS_NOT_READY.union(Refusals::NOT_STANDSTILL)),
            false,
            Mode::AutomaticRun,
        ),
        (
            Mode::AutomaticRun,
            lacking(Refusals::TCMS_NOT_READY),
            false,
            Mode::Manual,
        ),
        (
            Mode::AutomaticRun,
            ModeInputs {
                arrived: true,
                ..GOOD
            },
            false,
            Mode::Automatic,
        ),
        (
            Mode::AutomaticRun,
            switch(ModeSwitch::Manual),
            false,
            Mode::Manual,
        ),
        (
            Mode::AutomaticRun,
            ModeInputs {
                cab_active: false,
                ..GOOD
            },
            false,
            Mode::Off,
        ),
        (
            Mode::Manual,
            ModeInputs {
                ready: false,
                ..GOOD
            },
            true,
            Mode::Off,
        ),
        (Mode::Off, switch(ModeSwitch::Yard), false, Mode::Yard),
        (Mode::Off, switch(ModeSwitch::Unknown(9)), false, Mode::Off),
    ];
    for (from, inputs, departing, to) in cases {
        assert_eq!(
            next(from, &inputs, departing),
            to,
            "{from:?} {inputs:?} {departing}"
        );
    }
}
