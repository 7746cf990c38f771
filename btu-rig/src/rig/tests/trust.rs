//! Data that the rig must not believe: a log that is not answered or does not end, another unit, a bad
//! line.

use protocol::Instant;
use protocol::Random;
use protocol::link::{End, Link};
use protocol::message::{Channel, IoInput, SelfTest};

use super::{FakeUnit, bench, link_error, rig};
use crate::procedure::{LineState, LogState};
use crate::rig::{Bench, LinkTrouble, UnitLink};
use crate::stimulus::{Stimulus, WaysideCondition};

/// What a bad line does to bytes, one in a hundred.
#[derive(Clone, Copy, Debug)]
enum LineDisturbance {
    Flips,
    Doubles,
    /// Adds a hundred random bytes after each scan.
    Floods,
    /// Gives each scan's bytes twice.
    Repeats,
}

/// A line that harms what passes, one way or both.
struct BadLine {
    unit: FakeUnit,
    harm: LineDisturbance,
    to_unit: bool,
    from_unit: bool,
    random: Random,
}

impl BadLine {
    fn pass(&mut self, bytes: &[u8]) -> Vec<u8> {
        let random = &mut self.random;
        let mut out = Vec::new();
        for &byte in bytes {
            let hit = random.unit() < 0.01;
            match self.harm {
                LineDisturbance::Flips if hit => out.push(byte ^ (1 << random.below(8))),
                LineDisturbance::Doubles if hit => out.extend([byte, byte]),
                _ => out.push(byte),
            }
        }
        match self.harm {
            LineDisturbance::Floods => out.extend((0..100).map(|_| random.below(256) as u8)),
            LineDisturbance::Repeats => out.extend_from_slice(bytes),
            LineDisturbance::Flips | LineDisturbance::Doubles => {}
        }
        out
    }
}

impl UnitLink for BadLine {
    fn exchange(
        &mut self,
        now: Instant,
        to_unit: &[u8],
        from_unit: &mut Vec<u8>,
    ) -> Result<(), LinkTrouble> {
        let there = match self.to_unit {
            true => self.pass(to_unit),
            false => to_unit.to_vec(),
        };
        let mut back = Vec::new();
        self.unit.exchange(now, &there, &mut back)?;
        match self.from_unit {
            true => from_unit.extend(self.pass(&back)),
            false => from_unit.extend(back),
        }
        Ok(())
    }
}

fn on_bad_line(harm: LineDisturbance, to_unit: bool, from_unit: bool) -> Bench<BadLine> {
    let line = BadLine {
        unit: FakeUnit::default(),
        harm,
        to_unit,
        from_unit,
        random: Random::new(5),
    };
    Bench::new(rig(1), line)
}

#[test]
fn a_bad_line_is_reported_as_a_line_fault_in_either_direction() {
    for harm in [
        LineDisturbance::Flips,
        LineDisturbance::Doubles,
        LineDisturbance::Floods,
        LineDisturbance::Repeats,
    ] {
        for (to_unit, from_unit) in [(true, false), (false, true), (true, true)] {
            let mut bench = on_bad_line(harm, to_unit, from_unit);
            bench.run_ms(15_000);
            let error = link_error(&bench);
            let told = error.starts_with("the line between tester and unit is bad: within 10 s ");
            assert!(told, "{harm:?} {to_unit} {from_unit}: \"{error}\"");
            assert!(!error.contains("baud"), "{error}");
        }
    }
}

/// Goal: what the unit or TCMS logs because of a bad line is not blamed on a part of the unit when the bench's computer
/// stands still meanwhile; what is lost by the standstill is not counted against the line.
#[test]
fn what_a_line_lost_before_and_after_a_standstill_still_explains_events() {
    let mut bench = on_bad_line(LineDisturbance::Flips, true, true);
    bench.run_ms(4_000);
    let lately = |bench: &Bench<BadLine>| bench.rig.evidence().line.lost_or_damaged_lately;
    let before = lately(&bench);
    assert!(before > 0);
    bench.note_stalled();
    assert!(lately(&bench) >= before, "what was lost is known still");
    assert_eq!(bench.rig.link_error(), None);
    let against_the_line = bench.rig.evidence().line.lost_or_damaged;
    bench.run_ms(1_000);
    assert!(lately(&bench) > before, "what is lost after is known, too");
    let line = bench.rig.evidence().line;
    assert_eq!(line.lost_or_damaged, against_the_line);
}

/// Goal: what TCMS misses right after a standstill is left open until the unit is heard, as on a line that was pulled
/// meanwhile.
#[test]
fn a_line_is_silent_from_a_standstill_until_the_unit_is_heard() {
    let mut bench = bench(FakeUnit::default());
    bench.run_ms(4_000);
    let silent = |bench: &Bench<FakeUnit>| bench.rig.evidence().line.silent;
    assert!(!silent(&bench));
    bench.note_stalled();
    assert!(silent(&bench));
    bench.run_ms(100);
    assert!(!silent(&bench), "the unit is there");
    bench.link.dead = Channel::ALL.to_vec();
    bench.note_stalled();
    bench.run_ms(500);
    assert!(silent(&bench), "the line was pulled");
}

/// Goal: nothing that a unit or a bench does on a good line looks like a bad one. Method: everything that
/// makes frames fail, fall silent or start again on purpose.
#[test]
fn on_a_good_line_nothing_is_harmed() {
    let mut bench = bench(FakeUnit::default());
    bench.run_ms(10_000);
    bench.apply(Stimulus::Wayside(WaysideCondition::Corrupt));
    bench.run_ms(20_000);
    bench.apply(Stimulus::Wayside(WaysideCondition::Good));
    bench.link.dead = vec![Channel::Twc, Channel::Tcms];
    bench.run_ms(10_000);
    bench.link.restart();
    bench.run_ms(10_000);
    bench.apply(Stimulus::PtuSilent { on: true });
    bench.run_ms(5_000);
    bench.apply(Stimulus::PtuSilent { on: false });
    bench.run_ms(10_000);
    assert_eq!(bench.rig.evidence().line, LineState::default());
    assert_eq!(bench.rig.link_error(), None);
}

/// Goal: a unit that refuses frames because its own clock gains is at fault, not the line. Method: a clock
/// so fast that frames are late to it every 30 s.
#[test]
fn frames_that_are_late_to_a_fast_clock_are_not_the_lines() {
    let mut bench = bench(FakeUnit::with(|it| it.clock_gains = 0.017));
    bench.run_ms(120_000);
    assert!(bench.link.link.counters().rejected_total() > 200);
    assert_eq!(bench.rig.evidence().line, LineState::default());
    assert_eq!(bench.rig.link_error(), None);
}

/// Goal: a fast clock is at fault, not the line, also after the tester's computer stood still, when the clock is
/// compared from the beginning; the rate of the clock is measured from 13 s on. Method: a clock 3 % fast, which
/// refuses frames for seconds on end, and stalls.
#[test]
fn a_fast_clock_is_measured_and_stays_wrong_over_a_stall() {
    let mut bench = bench(FakeUnit::with(|it| it.clock_gains = 0.03));
    bench.run_ms(10_000);
    assert_eq!(
        bench.rig.evidence().clock_wrong_by_permille,
        None,
        "not yet"
    );
    bench.run_ms(10_000);
    assert_eq!(bench.rig.evidence().clock_wrong_by_permille, Some(30));
    for _ in 0..30 {
        bench.note_stalled();
        bench.run_ms(4_000);
    }
    assert!(bench.link.link.counters().rejected_total() > 200);
    assert_eq!(bench.rig.evidence().line, LineState::default());
}

#[test]
fn a_log_that_is_never_answered_is_an_error_with_the_count_of_questions() {
    let mut bench = bench(FakeUnit::default());
    bench.run_ms(5_000);
    assert_eq!(bench.rig.evidence().log, LogState::Read);
    bench.link.answers_log = false;
    bench.link.log_event(7);
    bench.run_ms(1_000);
    assert_eq!(bench.rig.evidence().log, LogState::Unanswered);
    assert_eq!(bench.rig.link_error(), None, "not yet");
    bench.run_ms(5_000);
    let error = "the unit's log could not be read: asked 20 times, no answer";
    assert_eq!(link_error(&bench), error);
    bench.link.answers_log = true;
    bench.run_ms(1_000);
    assert_eq!(bench.rig.evidence().log, LogState::Read);
    assert_eq!(bench.rig.link_error(), None);
}

/// A unit whose log is empty and is never answered: whether it could be read is not known.
#[test]
fn a_unit_that_never_shows_its_log_is_an_error_though_nothing_is_in_it() {
    let mut bench = bench(FakeUnit::with(|it| it.answers_log = false));
    bench.run_ms(2_000);
    assert_eq!(bench.rig.evidence().log, LogState::Unanswered);
    bench.run_ms(5_000);
    let error = link_error(&bench);
    assert!(error.ends_with("times, no answer"), "{error}");
}

/// A unit says that it has logged something, and answers with the end of the log alone.
#[test]
fn a_log_without_the_entries_it_should_have_is_an_error() {
    let mut bench = bench(FakeUnit::with(|it| it.entries_per_cycle = 0));
    bench.link.log_event(7);
    bench.run_ms(60_000);
    let error = link_error(&bench);
    assert!(
        error.ends_with("times for entry 0 of 1, which never came"),
        "{error}"
    );
}

/// Goal: a log without end costs neither memory nor time. Method: a unit that logs fifty events a scan and
/// sends them as fast as they come.
#[test]
fn a_log_without_end_is_bounded_counted_and_an_error() {
    let mut bench = bench(FakeUnit::with(|it| it.entries_per_cycle = 400));
    let (mut taken, mut logged) = (0, 0_u64);
    for _ in 0..1_000 {
        for _ in 0..50 {
            bench.link.log_event(400);
            logged += 1;
        }
        bench.run_ms(10);
        taken += bench.rig.take_events().len() as u64;
    }
    assert!(
        (256..256 + 10 * 40 + 1).contains(&taken),
        "{taken} of {logged}"
    );
    let not_kept = bench.rig.evidence().not_kept;
    assert!(not_kept > 10_000, "{not_kept}");
    let error = link_error(&bench);
    assert!(error.starts_with("the unit logs without end"), "{error}");
}

#[test]
fn entries_that_were_gone_before_they_could_be_read_are_an_error_unless_they_are_history() {
    let mut unit = FakeUnit::with(|it| it.oldest = 40);
    unit.log_event(1);
    let mut bench = bench(unit);
    bench.run_ms(4_000);
    assert_eq!(bench.rig.link_error(), None);
    let unit = &mut bench.link;
    unit.oldest += 300;
    unit.log_event(1);
    bench.run_ms(4_000);
    let error = link_error(&bench);
    assert!(
        error.contains("entries of the unit's log were overwritten"),
        "{error}"
    );
}

#[test]
fn another_unit_on_the_same_line_is_an_error_from_then_on() {
    type Change = fn(&mut protocol::message::Identity);
    let changes: [(Change, &str); 4] = [
        (
            |i| i.serial[..3].copy_from_slice(b"B-2"),
            "its serial number was \"A-1\" and is \"B-2\"",
        ),
        (
            |i| i.config[0] = 0xFF,
            "its unit configuration was \"\" and is \"\\xff\"",
        ),
        (
            |i| i.config_crc = 0xBEEF,
            "its configuration's checksum was 00000000 and is 0000beef",
        ),
        (
            |i| i.tdb_crc = 1,
            "its track database's checksum was 00000000 and is 00000001",
        ),
    ];
    for (change, told) in changes {
        let mut unit = FakeUnit::default();
        unit.identity.serial[..3].copy_from_slice(b"A-1");
        let mut bench = bench(unit);
        bench.run_ms(4_000);
        assert_eq!(bench.rig.link_error(), None);
        let before = bench.link.identity;
        change(&mut bench.link.identity);
        bench.run_ms(4_000);
        let error = format!("another unit answers: {told}");
        assert_eq!(link_error(&bench), error);
        bench.link.identity = before;
        bench.run_ms(4_000);
        assert_eq!(
            link_error(&bench),
            error,
            "what was measured is of two units"
        );
    }
}

#[test]
fn failed_self_test_items_are_known_from_identity_and_status() {
    let mut bench = bench(FakeUnit::default());
    bench.link.self_test = SelfTest::TRA;
    bench.link.identity.self_test = SelfTest::MEMORY;
    bench.run_ms(3_000);
    let both = SelfTest::TRA | SelfTest::MEMORY;
    assert_eq!(bench.rig.evidence().self_test, both);
    // The self-test result from before the restart does not hold.
    bench.link.restart();
    bench.run_ms(4_000);
    assert_eq!(bench.rig.evidence().self_test, SelfTest::empty());
}

/// Sends one frame each scan that this end must refuse although it came through whole.
struct Echo;

impl UnitLink for Echo {
    fn exchange(&mut self, now: Instant, _: &[u8], out: &mut Vec<u8>) -> Result<(), LinkTrouble> {
        Link::new(End::Bench).send(now, &IoInput::default().into(), out);
        Ok(())
    }
}

#[test]
fn a_wrong_baud_rate_is_suspected_only_where_no_check_sequence_fits() {
    let mut bench = Bench::new(rig(1), Echo);
    bench.run_ms(3_010);
    let error = link_error(&bench);
    assert!(
        error.contains("no valid frame") && error.contains("own frames come back"),
        "{error}"
    );
    assert!(!error.contains("baud"), "{error}");
}

/// Bytes that hold no frame, where a unit was heard before.
#[test]
fn a_unit_whose_frames_drown_in_noise_is_not_reported_as_silent_only() {
    let mut bench = bench(FakeUnit::default());
    bench.run_ms(4_000);
    bench.link.dead = Channel::ALL.to_vec();
    bench.link.noise = b"noise~";
    bench.run_ms(2_000);
    let error = link_error(&bench);
    assert!(
        error.starts_with("the line between tester and unit is bad"),
        "{error}"
    );
}

/// A supply that dips again before the link has taken the unit's new numbers in.
#[test]
fn a_unit_that_restarts_repeatedly_is_not_reported_as_a_bad_line() {
    let mut bench = bench(FakeUnit::default());
    bench.run_ms(4_000);
    for (down_ms, up_ms) in [(50, 900), (700, 0)] {
        bench.link.dead = Channel::ALL.to_vec();
        bench.run_ms(down_ms);
        bench.link.restart();
        bench.run_ms(up_ms);
    }
    bench.link.dead = Channel::ALL.to_vec();
    bench.run_ms(200);
    // The unit may be about to be heard again.
    assert_eq!(bench.rig.link_error(), None);
    bench.run_ms(9_000);
    let error = link_error(&bench);
    assert!(error.contains("the unit starts again and again"), "{error}");
    assert!(!error.contains("line"), "{error}");
}
