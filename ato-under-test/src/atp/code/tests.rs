use alloc::vec::Vec;

use protocol::SCAN;

use super::*;
use crate::for_tests::{logged, seoul34, sg100};

const SILENCE: AntennaSignal = signal(0.0, 0.0, 0.0);
/// Code 55 of the default table, which is its fifth.
const CODE_55: AntennaSignal = signal(3000.0, 15.0, 500.0);

const fn signal(carrier_hz: f64, rate_hz: f64, level_mv: f64) -> AntennaSignal {
    AntennaSignal {
        carrier_hz,
        rate_hz,
        level_mv,
        heard_for: Duration::ZERO,
        lags: Duration::ZERO,
    }
}

/// A decoder with its clock and its log: detects in 400 ms, holds for 1 000 ms, takes 60 to 2 000 mV.
struct Receiver {
    decoder: CodeDecoder,
    config: UnitConfig,
    log: EventLog,
    now: Instant,
    confirms: bool,
}

impl Receiver {
    fn new() -> Self {
        Self {
            decoder: CodeDecoder::default(),
            config: sg100(),
            log: EventLog::default(),
            now: Instant::from_ms(5000),
            confirms: true,
        }
    }

    /// Hears a signal for some time; when each code came into force, ms from the first scan.
    fn hear(&mut self, signal: AntennaSignal, ms: u64) -> Vec<(u64, Code)> {
        let (begin, mut before, mut changes) = (self.now, self.decoder.code, Vec::new());
        while self.now < begin + Duration::from_ms(ms) {
            self.decoder
                .step(self.now, signal, self.confirms, &self.config, &mut self.log);
            if self.decoder.code != before {
                before = self.decoder.code;
                changes.push((self.now.since(begin).as_ms(), before));
            }
            self.now += SCAN;
        }
        changes
    }

    /// Events so far, with their parameters.
    fn events(&self) -> Vec<(u16, i32)> {
        logged(&self.log)
    }
}

fn event(event: Event, parameter: i32) -> (u16, i32) {
    (event.definition().code, parameter)
}

#[test]
fn a_code_counts_when_it_was_steady_and_is_lost_after_the_hold_time() {
    let mut receiver = Receiver::new();
    assert_eq!(receiver.hear(CODE_55, 1000), [(400, Code::Known(4))]);
    let scan_ms = SCAN.as_ms();
    // The code was heard last one scan before the silence.
    assert_eq!(receiver.hear(SILENCE, 2000), [(1000, Code::None)]);
    assert_eq!(receiver.events(), [event(Event::CodeLost, 0)]);
    // Steady means without a break: 390 ms twice is not 400.
    for _ in 0..2 {
        assert_eq!(receiver.hear(CODE_55, 400 - scan_ms), []);
        assert_eq!(receiver.hear(SILENCE, scan_ms), []);
    }
    // Another code meanwhile begins the time again, too.
    assert_eq!(receiver.hear(signal(3000.0, 12.0, 500.0), 300), []);
    assert_eq!(receiver.hear(CODE_55, 500), [(400, Code::Known(4))]);
}

/// Goal: a code that is back after one long silence is lost and detected again, and no flicker is logged.
#[test]
fn one_long_silence_is_no_flicker() {
    let mut receiver = Receiver::new();
    receiver.hear(CODE_55, 1000);
    receiver.hear(SILENCE, 760);
    let lost_and_found = [(240, Code::None), (400, Code::Known(4))];
    assert_eq!(receiver.hear(CODE_55, 1000), lost_and_found);
    assert_eq!(receiver.events(), [event(Event::CodeLost, 0)]);
}

/// A code heard now and then renews no code, neither itself nor another.
#[test]
fn a_scan_now_and_then_renews_no_code() {
    for rate_hz in [15.0, 12.0] {
        let mut receiver = Receiver::new();
        receiver.hear(CODE_55, 1000);
        receiver.hear(SILENCE, 700);
        receiver.hear(signal(3000.0, rate_hz, 500.0), SCAN.as_ms());
        receiver.hear(SILENCE, 400);
        assert_eq!(receiver.decoder.code, Code::None, "{rate_hz} Hz");
    }
}

const CODE_25: AntennaSignal = signal(3000.0, 29.0, 500.0);
const STOP: AntennaSignal = signal(3000.0, 0.0, 500.0);
const CODE_75: AntennaSignal = signal(3000.0, 10.0, 500.0);

/// Goal: no code stays in force that is not there for long enough, and of codes that alternate the most restrictive
/// holds. Method: 75 for a while, then two signals by turns, each for its time, for eight seconds.
#[test]
fn codes_that_alternate_are_this_table() {
    let (known_25, known_75) = (Code::Known(1), Code::Known(6));
    for (one, one_ms, two, two_ms, code) in [
        (CODE_25, 100, CODE_75, 100, known_25),
        (CODE_25, 380, CODE_75, 10, known_25),
        (CODE_25, 450, CODE_75, 450, known_25),
        (CODE_25, 900, CODE_75, 900, known_25),
        (CODE_25, 10, CODE_75, 10, known_25),
        (
            signal(3000.0, 36.0, 500.0),
            100,
            CODE_75,
            100,
            Code::Known(0),
        ),
        (STOP, 100, CODE_75, 100, Code::AbsoluteStop),
        (STOP, 330, CODE_75, 20, Code::AbsoluteStop),
        (SILENCE, 330, CODE_75, 20, Code::None),
        (SILENCE, 880, CODE_75, 20, Code::None),
        (SILENCE, 100, CODE_75, 200, known_75),
        (CODE_25, 10, CODE_75, 380, known_75),
    ] {
        let mut receiver = Receiver::new();
        receiver.hear(CODE_75, 3000);
        let mut after = alloc::vec![];
        for _ in 0..8000 / (one_ms + two_ms) {
            receiver.hear(one, one_ms);
            after.push(receiver.decoder.code);
            receiver.hear(two, two_ms);
            after.push(receiver.decoder.code);
        }
        let settled = &after[after.len() / 2..];
        let what = (one, one_ms, two, two_ms);
        assert!(
            settled.iter().all(|held| *held == code),
            "{what:?}: {settled:?}"
        );
        let told = receiver.events().iter().any(|(event, _)| *event == 202);
        // Where each code stays for 450 ms, each is detected by itself, and no flicker is logged.
        assert_eq!(told, code != known_75 && one_ms != 450, "{what:?}");
    }
}

/// Goal: the most restrictive holds also where nothing is heard between two codes that alternate.
#[test]
fn a_pause_between_codes_that_alternate_frees_none() {
    let mut receiver = Receiver::new();
    receiver.hear(CODE_75, 3000);
    let mut after = alloc::vec![];
    for _ in 0..6 {
        receiver.hear(CODE_25, 450);
        receiver.hear(SILENCE, 50);
        receiver.hear(CODE_75, 450);
        receiver.hear(SILENCE, 50);
        after.push(receiver.decoder.code);
    }
    assert!(
        after.iter().all(|code| *code == Code::Known(1)),
        "{after:?}"
    );
}

#[test]
fn a_code_that_was_taken_for_a_moment_is_back_after_the_hold_time() {
    let mut receiver = Receiver::new();
    receiver.hear(CODE_75, 3000);
    assert_eq!(receiver.hear(CODE_25, 500), [(400, Code::Known(1))]);
    assert_eq!(receiver.hear(CODE_75, 1500), [(1000, Code::Known(6))]);
    receiver.hear(CODE_25, 3000);
    assert_eq!(
        receiver.hear(CODE_75, 1500),
        [(400, Code::Known(6))],
        "for long"
    );
    receiver.confirms = false;
    receiver.hear(CODE_75, 300);
    for _ in 0..20 {
        receiver.hear(CODE_25, 100);
        receiver.hear(CODE_75, 100);
    }
    assert_eq!(receiver.decoder.code, Code::Known(6), "the fault");
}

#[test]
fn level_carrier_and_rate_are_taken_within_their_tolerances() {
    for (signal, code) in [
        (signal(3000.0, 15.0, 60.0), Code::Known(4)),
        (signal(3000.0, 15.0, 59.9), Code::None),
        (signal(3000.0, 15.0, 2000.0), Code::Known(4)),
        (signal(3000.0, 15.0, 2000.1), Code::None),
        (signal(2950.0, 15.0, 500.0), Code::Known(4)),
        (signal(2949.0, 15.0, 500.0), Code::None),
        (signal(3050.0, 15.0, 500.0), Code::Known(4)),
        (signal(3051.0, 15.0, 500.0), Code::None),
        (signal(3000.0, 14.5, 500.0), Code::Known(4)),
        (signal(3000.0, 14.4, 500.0), Code::None),
        (signal(3000.0, 0.0, 500.0), Code::AbsoluteStop),
        (signal(4000.0, 0.0, 500.0), Code::None),
    ] {
        let mut receiver = Receiver::new();
        receiver.hear(signal, 1000);
        assert_eq!(receiver.decoder.code, code, "{signal:?}");
    }
}

/// Goal: a code of the yard lets no train run on the line. Method: it alone, and by turns with codes of the line, half
/// the time each.
#[test]
fn a_code_of_the_yard_permits_nothing_on_the_line() {
    let config = seoul34();
    let [yard, low, top] = [3.2, 5.0, 20.4].map(|rate_hz| signal(990.0, rate_hz, 500.0));
    for other in [yard, low, top] {
        let mut receiver = Receiver::new();
        receiver.config = config.clone();
        receiver.hear(other, 4000);
        for _ in 0..40 {
            receiver.hear(yard, 100);
            receiver.hear(other, 100);
        }
        let limit = receiver.decoder.limit(&config.codes);
        assert_eq!(
            (receiver.decoder.code, limit),
            (Code::Known(1), Speed::ZERO),
            "{other:?}"
        );
    }
}

#[test]
fn an_unknown_code_is_logged_once_with_its_rate_each_time_it_comes() {
    let mut receiver = Receiver::new();
    let unknown = signal(3000.0, 18.3, 500.0);
    receiver.hear(unknown, 1400);
    assert_eq!(receiver.events(), []);
    receiver.hear(unknown, 3000);
    let once = event(Event::CodeUnknown, 1830);
    assert_eq!(receiver.events(), [once]);
    receiver.hear(signal(3000.0, 18.3, 10.0), 3000);
    assert_eq!(receiver.events(), [once]);
    receiver.hear(unknown, 3000);
    assert_eq!(receiver.events(), [once, once]);
}
