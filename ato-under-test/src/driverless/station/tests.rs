//! The sequence as a table, and what holds whatever comes.

use protocol::Random;

use super::*;
use crate::for_tests::{logged, with};

const CONFIG: DriverlessConfig = DriverlessConfig {
    dwell_min_ms: 5000,
    open_ms: 3000,
    close_ms: 4000,
    reopen_ms: 2000,
    close_tries: 3,
};
/// A train at a platform on the left, held.
const HELD: StationInputs = StationInputs {
    driverless: true,
    standstill: true,
    running: false,
    enabled: DoorSide::Left,
    open: DoorSide::None,
    closed: true,
    departure: false,
    acknowledge: false,
    guards: Guards::ALL,
};
const CYCLE: Duration = Duration::from_ms(50);

fn open(inputs: StationInputs) -> StationInputs {
    with(inputs, |it| (it.open, it.closed) = (DoorSide::Left, false))
}

fn departs(inputs: StationInputs) -> StationInputs {
    with(inputs, |it| it.departure = true)
}

struct Stop {
    station: Station,
    log: EventLog,
    now: Instant,
}

impl Stop {
    fn new() -> Self {
        Self {
            station: Station::default(),
            log: EventLog::default(),
            now: Instant::ZERO,
        }
    }

    /// Feeds these inputs for a time; gives the sides ordered to open then, whether doors are ordered to
    /// close, whether departure waits.
    fn after(&mut self, inputs: StationInputs, ms: u64) -> (DoorSide, bool, bool) {
        for _ in 0..=ms / 50 {
            self.station.step(self.now, &inputs, &CONFIG, &mut self.log);
            self.now += CYCLE;
        }
        let station = &self.station;
        (station.opens, station.closes(), station.waits)
    }
}

const OPENS: (DoorSide, bool, bool) = (DoorSide::Left, false, true);
const CLOSES: (DoorSide, bool, bool) = (DoorSide::None, true, true);
const GOES: (DoorSide, bool, bool) = (DoorSide::None, false, false);

#[test]
fn doors_open_stay_open_and_close_for_departure() {
    let mut stop = Stop::new();
    assert_eq!(stop.after(HELD, 0), OPENS);
    assert_eq!(
        stop.after(open(HELD), 60_000),
        OPENS,
        "as long as it is held"
    );
    assert_eq!(stop.after(open(departs(HELD)), 0), CLOSES);
    assert_eq!(stop.after(open(departs(HELD)), 3_000), CLOSES);
    assert_eq!(stop.after(departs(HELD), 0), GOES);
    assert_eq!(stop.after(HELD, 10_000), GOES, "served once at a stop");
    assert_eq!(logged(&stop.log), []);
}

#[test]
fn a_departure_given_early_waits_for_the_dwell() {
    let mut stop = Stop::new();
    stop.after(departs(HELD), 100);
    assert_eq!(stop.after(open(departs(HELD)), 4_900), OPENS);
    assert_eq!(stop.after(open(departs(HELD)), 100), CLOSES);
}

#[test]
fn a_departure_withdrawn_while_doors_close_opens_them_and_given_anew_closes_them() {
    let mut stop = Stop::new();
    stop.after(HELD, 0);
    stop.after(open(HELD), 6_000);
    assert_eq!(stop.after(open(departs(HELD)), 500), CLOSES);
    assert_eq!(stop.after(open(HELD), 500), OPENS);
    assert_eq!(stop.after(open(departs(HELD)), 500), CLOSES);
    let away = with(open(HELD), |it| it.enabled = DoorSide::None);
    assert_eq!(stop.after(away, 500), CLOSES, "not enabled, not opened");
}

#[test]
fn an_obstacle_opens_the_doors_twice_and_then_refuses_departure() {
    for (goes_on, expected) in [
        (open(HELD), OPENS),
        (
            with(open(departs(HELD)), |it| it.acknowledge = true),
            CLOSES,
        ),
    ] {
        let mut stop = Stop::new();
        stop.after(HELD, 0);
        stop.after(open(HELD), 6_000);
        let obstacle = open(departs(HELD));
        for _ in 0..2 {
            assert_eq!(stop.after(obstacle, 3_900), CLOSES);
            assert_eq!(stop.after(obstacle, 1_900), OPENS);
            stop.after(obstacle, 0);
        }
        assert_eq!(stop.after(obstacle, 3_800), CLOSES);
        assert_eq!(stop.after(obstacle, 60_000), OPENS, "and stays so");
        assert_eq!(logged(&stop.log), [(244, 1)]);
        assert_eq!(stop.after(goes_on, 0), expected);
        assert_eq!(stop.after(obstacle, 0), CLOSES);
        assert_eq!(stop.after(departs(HELD), 0), GOES);
    }
}

#[test]
fn doors_that_do_not_open_are_told_and_do_not_keep_the_train() {
    let mut stop = Stop::new();
    assert_eq!(stop.after(HELD, 2_900), OPENS);
    assert_eq!(stop.after(departs(HELD), 100), GOES);
    assert_eq!(logged(&stop.log), [(246, 1)]);
}

#[test]
fn doors_that_somebody_opened_are_closed_for_departure_without_an_enable() {
    let mut stop = Stop::new();
    let away = with(HELD, |it| it.enabled = DoorSide::None);
    assert_eq!(stop.after(departs(away), 0), GOES);
    assert_eq!(stop.after(open(departs(away)), 4_900).0, DoorSide::None);
    assert_eq!(stop.after(open(departs(away)), 100), CLOSES);
    assert_eq!(stop.after(departs(away), 0), GOES);
}

#[test]
fn nothing_is_ordered_in_a_run_in_motion_or_in_another_mode() {
    for other in [
        with(HELD, |it| it.running = true),
        with(HELD, |it| it.standstill = false),
        with(HELD, |it| it.driverless = false),
    ] {
        let mut stop = Stop::new();
        assert_eq!(stop.after(other, 2_000), GOES, "{other:?}");
        assert_eq!(stop.after(HELD, 0), OPENS);
    }
}

#[test]
fn at_the_next_stop_doors_are_served_anew() {
    let moves = with(HELD, |it| it.standstill = false);
    for (moves_ms, expected) in [(500, GOES), (1_500, OPENS)] {
        let mut stop = Stop::new();
        stop.after(HELD, 0);
        stop.after(open(HELD), 6_000);
        stop.after(open(departs(HELD)), 3_000);
        assert_eq!(stop.after(departs(HELD), 0), GOES);
        stop.after(moves, moves_ms);
        assert_eq!(stop.after(HELD, 0), expected, "{moves_ms} ms");
    }
}

/// Whatever comes in: no side is ordered that is not enabled, no order to open comes with one to close, departure never
/// goes without proof, and with departure given it ends, at the latest after the last try.
#[test]
fn orders_keep_to_the_enables_departure_waits_for_proof_and_every_sequence_ends() {
    for seed in 0..400 {
        let mut random = Random::new(seed);
        let mut stop = Stop::new();
        for _ in 0..40 {
            let mut one_in = |n: u32| random.chance(1.0 / f64::from(n));
            let closed = !one_in(2);
            let inputs = StationInputs {
                standstill: !one_in(10),
                running: one_in(10),
                driverless: !one_in(15),
                enabled: DoorSide::from_code(u8::from(one_in(2)) + 2 * u8::from(one_in(2))),
                closed,
                departure: one_in(2),
                acknowledge: one_in(5),
                ..if closed { HELD } else { open(HELD) }
            };
            let span_ms =
                [0, 100, 1_000, 5_000][usize::from(one_in(2)) + 2 * usize::from(one_in(2))];
            for _ in 0..=span_ms / 50 {
                let (opens, closes, waits) = stop.after(inputs, 0);
                let beyond = opens.code() & !inputs.enabled.code();
                assert_eq!(beyond, 0, "seed {seed}");
                assert!(!closes || opens == DoorSide::None, "seed {seed}");
                let stands = inputs.standstill && inputs.driverless && !inputs.running;
                assert!(waits || closed || !stands, "seed {seed}");
            }
        }
        let (_, closes, _) = stop.after(open(departs(HELD)), 30_000);
        assert!(!closes, "seed {seed}: tries for ever");
    }
}
