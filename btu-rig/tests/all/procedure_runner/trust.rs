//! Situations that the runner may not judge: a lost link, a stalled tester, an unread log, lost
//! frames.

use btu_rig::procedure::link_trouble::LinkTrouble;
use btu_rig::procedure::{Finding, LogState, RunEvent, Verdict};
use protocol::Duration;
use protocol::event::Event;
use protocol::message::SelfTest;
use protocol::signal::Signal;

use super::stand_in::{HEAD, OFF, ON, World, run};

#[test]
fn a_lost_link_ends_the_step_as_an_error_and_skips_the_rest() {
    let script = format!("{HEAD}look('a', do = wait(s(5)))\nlook('b')");
    let outcome = run(&script, |world| {
        if world.ms() >= 1000 {
            world.link_error = Some(LinkTrouble::LogNotAnswered { times: 5 });
        }
    });
    let text = "link to the unit: the unit's log could not be read: asked 5 times, no answer";
    let reason = format!("not run, {text}");
    let expected = [
        ("a", Verdict::Error, text),
        ("b", Verdict::Skipped, &reason),
    ];
    assert_eq!(outcome.summary(), expected);
    assert_eq!(outcome.finished(), (Verdict::Error, text));
    assert_eq!(outcome.fake.applied, [ON, OFF]);
    assert!(outcome.scans < 110);
}

/// Goal: a computer that stands still for a moment is no fault of the unit. Method: brake and event that
/// come in with the scan after it, as the unit's inputs were gone meanwhile.
#[test]
fn a_stalled_tester_reports_an_error_and_no_fault() {
    let script = format!(
        "{HEAD}look('a')\nstep('b', do = wait(s(5)), measure = value('v', speed, low = kmh(5)))\nlook('c')"
    );
    let outcome = run(&script, |world| {
        if world.ms() == 1000 {
            world
                .runner
                .interrupted(Finding::Told("held up for 0.50 s".into()));
            world.sample.set(Signal::Eb, 1.0);
            world.log(Event::InputsLost);
        }
    });
    let text = "held up for 0.50 s";
    let expected = [
        ("a", Verdict::Passed, ""),
        ("b", Verdict::Error, text),
        ("c", Verdict::Skipped, "not run, held up for 0.50 s"),
    ];
    assert_eq!(outcome.summary(), expected);
    assert_eq!(outcome.finished(), (Verdict::Error, text));
    assert_eq!(outcome.steps()[1].measurements[0].value, None);
    assert_eq!(outcome.unsolicited(), 0);
    assert_eq!(outcome.fake.applied, [ON, OFF], "clean-up is run");
}

/// Goal: no verdict on time from a bench, or by frames, that were late. Method: the same failures, in time, by a bench that is
/// behind, and by a link that holds frames back for one scan.
#[test]
fn a_failure_while_the_bench_is_behind_is_not_tested_unless_the_unit_logged_it() {
    let script =
        format!("{HEAD}step('a', do = wait(s(1)), expect = becomes(eb, 'applied', within = s(1)))");
    let verdict_of = |behind_ms: u64, link_ms: u64, says: bool| {
        let outcome = run(&script, |world| {
            world.fake.evidence.line.late = Duration::ZERO;
            if world.ms() == 500 {
                world.fake.evidence.line.late = Duration::from_ms(link_ms);
                world.runner.behind(Duration::from_ms(behind_ms));
                if says {
                    world.log(Event::TwcLost);
                }
            }
        });
        outcome.steps()[0].verdict
    };
    assert_eq!(verdict_of(40, 40, false), Verdict::Failed);
    assert_eq!(verdict_of(60, 0, false), Verdict::Skipped);
    assert_eq!(verdict_of(0, 60, false), Verdict::Skipped);
    assert_eq!(
        verdict_of(60, 60, true),
        Verdict::Failed,
        "an event is an event"
    );
}

#[test]
fn a_procedure_stalled_in_its_setup_runs_no_step_and_cleans_up() {
    let script =
        "procedure(title = 'x', setup = [wait(s(5))], cleanup = [cab.key(False)])\nlook('a')";
    let outcome = run(script, |world| {
        if world.ms() == 1000 {
            world.runner.interrupted(Finding::Told("held up".into()));
        }
    });
    assert_eq!(
        outcome.summary(),
        [("a", Verdict::Skipped, "not run, held up")]
    );
    assert_eq!(outcome.finished(), (Verdict::Error, "held up"));
    assert_eq!(outcome.fake.applied, [OFF]);
}

/// Goal: no step passes whose log is not known. Method: the log falls silent in the last step, for a while
/// and for good.
#[test]
fn a_step_ends_when_the_log_of_its_time_is_read_and_is_an_error_if_it_cannot_be() {
    let script = format!("{HEAD}step('a', do = wait(s(1)), expect = never_logs('twc_lost'))");
    let silent = |world: &mut World, until_ms: u32| {
        world.fake.evidence.log = match world.ms() {
            ms if ms >= 500 && ms < until_ms => LogState::Unanswered,
            _ => LogState::Read,
        };
    };
    let outcome = run(&script, |world| {
        silent(world, 4_000);
        if world.ms() == 4_000 {
            world.log(Event::TwcLost);
        }
    });
    assert_eq!(
        outcome.steps()[0].verdict,
        Verdict::Failed,
        "what came late counts"
    );
    let lost = LinkTrouble::LogNotAnswered { times: 69 };
    let outcome = run(&script, |world| {
        silent(world, u32::MAX);
        world.link_error = (world.ms() >= 6_000).then(|| lost.clone());
    });
    let text = format!("link to the unit: {lost}");
    assert_eq!(outcome.summary(), [("a", Verdict::Error, text.as_str())]);
    assert_eq!(outcome.finished(), (Verdict::Error, text.as_str()));
    let forever = run(&script, |world| silent(world, u32::MAX));
    assert_eq!(forever.steps()[0].verdict, Verdict::Error, "not given up");
    assert_eq!(forever.finished().0, Verdict::Error);
}

#[test]
fn an_awaited_event_is_not_missing_while_the_log_is_not_read() {
    let script =
        format!("{HEAD}step('a', do = wait(s(1)), expect = logs('twc_lost', within = s(1)))");
    let outcome = run(&script, |world| {
        world.fake.evidence.log = match world.ms() {
            500..3_000 => LogState::Behind,
            _ => LogState::Read,
        };
        if world.ms() == 2_900 {
            world.log(Event::TwcLost);
        }
    });
    assert_eq!(outcome.summary(), [("a", Verdict::Passed, "")]);
    let in_vain = run(&script, |world| {
        world.fake.evidence.log = LogState::Unanswered;
        world.link_error = (world.ms() >= 6_000).then_some(LinkTrouble::MemoryExchanged);
    });
    let reason = format!("link to the unit: {}", LinkTrouble::MemoryExchanged);
    assert_eq!(in_vain.summary(), [("a", Verdict::Error, reason.as_str())]);
}

#[test]
fn a_procedure_ends_with_its_log_read() {
    let script = format!("{HEAD}look('a', do = wait(s(1)))");
    let behind_until = |until_ms: u32| {
        run(&script, |world| {
            world.fake.evidence.log = match world.ms() {
                ms if ms >= 900 && ms < until_ms => LogState::Behind,
                _ => LogState::Read,
            };
        })
    };
    let outcome = behind_until(3_000);
    assert_eq!(
        (outcome.finished().0, outcome.scans),
        (Verdict::Passed, 300)
    );
    let message = "the unit's log was not read to its end within 25.000 s";
    assert_eq!(behind_until(u32::MAX).finished(), (Verdict::Error, message));
    let lost = run(&script, |world| {
        if world.ms() >= 900 {
            world.fake.evidence.log = LogState::Behind;
        }
        world.link_error = (world.ms() >= 2_000).then_some(LinkTrouble::MemoryExchanged);
    });
    let reason = format!("link to the unit: {}", LinkTrouble::MemoryExchanged);
    assert_eq!(lost.finished(), (Verdict::Error, reason.as_str()));
}

/// Goal: what a bad line does is no fault of a part, and what a part does on a good line is one. Method: the
/// same events, brake and missing reaction, with and without frames that did not come through.
#[test]
fn an_event_that_lost_frames_explain_is_an_error_and_no_fault() {
    let script = format!("{HEAD}look('a', do = wait(s(2)))");
    let expects =
        format!("{HEAD}step('a', do = wait(s(2)), expect = becomes(alarm, True, within = s(1)))");
    let came_to = |script: &str, lost_or_damaged: u64, event: Option<Event>, brake: bool| {
        let outcome = run(script, |world| {
            world.sample.set(Signal::Alarm, 0.0);
            if world.ms() == 500 {
                world.fake.evidence.line.lost_or_damaged = lost_or_damaged;
                world.fake.evidence.line.lost_or_damaged_lately = lost_or_damaged;
                event.into_iter().for_each(|event| world.log(event));
                if brake {
                    world.sample.set(Signal::Eb, 1.0);
                }
            }
        });
        assert_eq!(outcome.finished().0, outcome.steps()[0].verdict);
        (outcome.steps()[0].verdict, outcome.unsolicited())
    };
    let (failed, error) = (Verdict::Failed, Verdict::Error);
    for event in [
        Event::TwcLost,
        Event::TcmsLost,
        Event::InputsLost,
        Event::FramesRejected,
    ] {
        assert_eq!(
            came_to(&script, 0, Some(event), false),
            (failed, 1),
            "{event:?}"
        );
        assert_eq!(
            came_to(&script, 3, Some(event), false),
            (error, 0),
            "{event:?}"
        );
    }
    assert_eq!(
        came_to(&script, 3, Some(Event::EbRelayWelded), false),
        (failed, 1)
    );
    assert_eq!(came_to(&script, 0, None, true), (failed, 1));
    assert_eq!(came_to(&script, 3, None, true), (error, 0));
    assert_eq!(came_to(&expects, 0, None, false).0, failed);
    assert_eq!(came_to(&expects, 3, None, false).0, error);
}

#[test]
fn a_failed_self_test_is_reported_item_by_item_and_is_no_pass() {
    let outcome = run(&format!("{HEAD}look('a', do = wait(s(1)))"), |world| {
        world.fake.evidence.self_test = SelfTest::MEMORY | SelfTest::from_bits_retain(1 << 12);
    });
    let message = "the unit says its self-test failed: Memory pattern test; bit 12";
    assert_eq!(outcome.summary(), [("a", Verdict::Passed, "")]);
    assert_eq!(outcome.finished(), (Verdict::Failed, message));
}

/// Goal: one fault, one part: what a unit refuses because it restarted by itself is its failure, and what it refuses
/// otherwise is none. Method: a refused request, and the unit's log read a moment later, with the restart in it or without.
#[test]
fn what_a_unit_refuses_after_a_restart_of_its_own_is_a_failure_with_the_part_it_names() {
    let script = format!("{HEAD}look('a', do = ptu.code('75'), suspect = 'test_board')\nlook('b')");
    let text = "unit refused the test code: not_armed";
    for (dips, expected) in [(true, Verdict::Failed), (false, Verdict::Error)] {
        let outcome = run(&script, |world| {
            world.fake.refusal = Some(text);
            if world.ms() == 100 && dips {
                world.log(Event::SupplyDip);
            }
        });
        let steps = outcome.steps();
        let told = steps[0].findings.to_string();
        assert_eq!(steps[0].verdict, expected, "{told}");
        assert!(told.contains(text), "{told}");
        let part = steps[0].suspect.as_ref().map(|part| part.as_str());
        assert_eq!(part, Some(if dips { "power_supply" } else { "test_board" }));
        assert_eq!(outcome.finished().0, expected);
    }
}

#[test]
fn a_restart_of_the_units_own_counts_beside_the_steps_too() {
    let script = "procedure(title = 'x', setup = wait(s(1)), cleanup = wait(s(1)))\nlook('a')";
    for at_ms in [500, 1500] {
        let outcome = run(script, |world| {
            if world.ms() == at_ms {
                world.log(Event::SupplyDip);
                world.log(Event::TcmsLost);
            }
        });
        let told = outcome.events.iter();
        let told: Vec<_> = told
            .filter_map(|event| match event {
                RunEvent::UnsolicitedEvent(entry) => Event::from_code(entry.code),
                _ => None,
            })
            .collect();
        assert_eq!(told, [Event::SupplyDip], "{at_ms}");
        assert_eq!(outcome.finished().0, Verdict::Failed, "{at_ms}");
    }
}

/// Goal: a clock of the unit that goes wrong fails the procedure, once, and says by how much; no step is about it.
#[test]
fn a_clock_that_goes_wrong_fails_the_procedure_beside_its_steps() {
    let script = format!("{HEAD}look('a', do = wait(s(2)))\nlook('b', do = wait(s(2)))");
    let outcome = run(&script, |world| {
        if world.ms() >= 500 {
            world.fake.evidence.clock_wrong_by_permille = Some(-31);
        }
    });
    let expected = [("a", Verdict::Passed, ""), ("b", Verdict::Passed, "")];
    assert_eq!(outcome.summary(), expected);
    let said = "the unit's clock goes 3.1 % too slow by the tester's";
    assert_eq!(outcome.finished(), (Verdict::Failed, said));
    let told = |event: &&RunEvent| {
        matches!(
            event,
            RunEvent::UnitClockWrong {
                by_permille: -31,
                ..
            }
        )
    };
    assert_eq!(outcome.events.iter().filter(told).count(), 1);
}
