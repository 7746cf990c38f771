//! Finds the entries of a unit's log that are faults of the unit and its train. Information, acts of a tester and the
//! silence of a unit with nothing connected are none.

use std::ops::Range;

use btu_rig::procedure::UnitEvent;
use protocol::event::Event;
use protocol::message::{Channel, Mode};

use super::read::Entry;
use crate::run::is_fault;

/// Inputs and TCMS that fall silent so close together, ms, were taken away at once: their time-outs
/// differ by less, and no single fault of the unit silences both.
const TOGETHER_MS: u32 = 2_000;
/// Events of a unit to which nothing is connected any more.
const SILENCE: [Event; 4] = [
    Event::InputsLost,
    Event::TcmsLost,
    Event::TwcLost,
    Event::AtoFailed,
];

/// Frames of several partners refused so close together, ms, were damaged on the line they share: the
/// unit counts over ten seconds.
const ONE_LINE_MS: u32 = 12_000;
/// Events of a unit that frames do not reach.
const FRAMES_LOST: [Event; 4] = [
    Event::FramesRejected,
    Event::InputsLost,
    Event::TcmsLost,
    Event::TwcLost,
];

#[derive(Clone, Debug, Default, PartialEq)]
pub struct JudgedLog {
    /// Faults, in order.
    pub faults: Vec<Entry>,
    /// Counts of entries that are no faults, by reason.
    pub left_out: ExcludedEntries,
}

/// Entries left out, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExcludedEntries {
    /// Information only; also the loss of a station's loop in a mode that needs none.
    pub information: u32,
    /// Entries made before the time asked for.
    pub too_old: u32,
    /// Entries made while a run of the same history tested the unit; the run has judged them.
    pub under_test: u32,
    /// Entries made while a tester had armed the unit, which may do what the tester asks; also refused
    /// frames of a tester.
    pub tester: u32,
    /// Silence of a unit that nothing is connected to.
    pub alone: u32,
    /// Frames lost on the one line that all partners of the unit share.
    pub line: u32,
}

/// Judges entries, which are in order; `tested` are the spans, µs UTC, in which runs tested the unit.
pub fn judge(entries: &[Entry], tested: &[(i64, i64)], since_us: Option<i64>) -> JudgedLog {
    let events: Vec<_> = entries.iter().map(|entry| entry.event).collect();
    let armed = armed(&events);
    let alone = alone(&events);
    let within = |spans: &[Range<usize>], place| spans.iter().any(|span| span.contains(&place));
    let mut judged = JudgedLog::default();
    for (place, entry) in entries.iter().enumerate() {
        let silence = SILENCE.iter().any(|event| is(&entry.event, *event));
        let left_out = &mut judged.left_out;
        let dated = |holds: &dyn Fn(i64) -> bool| entry.at_us.is_some_and(holds);
        let reason = if !is_fault(&entry.event) || left_loop(&entry.event) {
            &mut left_out.information
        } else if entry.is_sure && dated(&|at| since_us.is_some_and(|since| at < since)) {
            &mut left_out.too_old
        } else if dated(&|at| {
            tested
                .iter()
                .any(|(from, until)| (*from..=*until).contains(&at))
        }) {
            &mut left_out.under_test
        } else if within(&armed, place) || of_testers_line(&entry.event) {
            &mut left_out.tester
        } else if silence && within(&alone, place) {
            &mut left_out.alone
        } else if FRAMES_LOST.iter().any(|event| is(&entry.event, *event))
            && of_a_bad_line(&events, place)
        {
            &mut left_out.line
        } else {
            judged.faults.push(*entry);
            continue;
        };
        *reason += 1;
    }
    judged
}

fn is(entry: &UnitEvent, event: Event) -> bool {
    entry.code == event.definition().code
}

/// A train that is driven by hand, or shunted into a depot, leaves the loop of a station; only automatic modes need
/// one.
fn left_loop(entry: &UnitEvent) -> bool {
    is(entry, Event::TwcLost) && matches!(entry.mode, Mode::Yard | Mode::Manual | Mode::Emergency)
}

/// Refused frames of a tester: by its cable, or because one tester took over from another.
fn of_testers_line(entry: &UnitEvent) -> bool {
    is(entry, Event::FramesRejected) && entry.parameter == i32::from(Channel::Ptu.code())
}

/// Whether frames of more than one partner were refused around this entry, in the same power-up: a part
/// of the unit hurts one channel only.
fn of_a_bad_line(events: &[UnitEvent], place: usize) -> bool {
    let at_ms = events[place].at_ms;
    let near = |entry: &&UnitEvent| {
        !is(entry, Event::PowerUp) && entry.at_ms.abs_diff(at_ms) <= ONE_LINE_MS
    };
    let before = events[..place].iter().rev().take_while(near);
    let after = events[place..].iter().take_while(near);
    let mut refused = before
        .chain(after)
        .filter(|entry| is(entry, Event::FramesRejected));
    let first = refused.next();
    first.is_some_and(|first| refused.any(|other| other.parameter != first.parameter))
}

/// Spans of entries in which a tester had the unit armed. Where the log no longer has its
/// beginning, arming began before the log.
fn armed(events: &[UnitEvent]) -> Vec<Range<usize>> {
    let mut spans = Vec::new();
    let mut began = None;
    for (place, entry) in events.iter().enumerate() {
        if is(entry, Event::Armed) {
            began.get_or_insert(place);
        } else if is(entry, Event::ArmingLapsed) {
            let from = began.take().or(spans.is_empty().then_some(0));
            spans.extend(from.map(|from| from..place));
        } else if is(entry, Event::PowerUp) {
            spans.extend(began.take().map(|from| from..place));
        }
    }
    spans.extend(began.map(|from| from..events.len()));
    spans
}

/// Spans of entries in which nothing was connected to the unit: from the loss of both inputs and TCMS to the return of
/// the first.
fn alone(events: &[UnitEvent]) -> Vec<Range<usize>> {
    let mut spans = Vec::new();
    let (mut inputs, mut tcms): (Option<usize>, Option<usize>) = (None, None);
    let mut began = None;
    for (place, entry) in events.iter().enumerate() {
        let any_back = is(entry, Event::InputsRestored) || is(entry, Event::TcmsRestored);
        if any_back || is(entry, Event::PowerUp) {
            spans.extend(began.take().map(|from| from..place));
            let powers_up = is(entry, Event::PowerUp);
            inputs = inputs.filter(|_| !powers_up && !is(entry, Event::InputsRestored));
            tcms = tcms.filter(|_| !powers_up && !is(entry, Event::TcmsRestored));
        } else if is(entry, Event::InputsLost) {
            inputs = Some(place);
        } else if is(entry, Event::TcmsLost) {
            tcms = Some(place);
        }
        if let (Some(inputs), Some(tcms), None) = (inputs, tcms, began) {
            let (first, second) = (inputs.min(tcms), inputs.max(tcms));
            let apart_ms = events[second].at_ms.abs_diff(events[first].at_ms);
            // A partner lost long before is a fault; the other one went with the tester.
            began = Some(if apart_ms <= TOGETHER_MS {
                first
            } else {
                second
            });
        }
    }
    spans.extend(began.map(|from| from..events.len()));
    spans
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An entry that is surely dated, if at all.
    fn entry(event: UnitEvent, at_us: Option<i64>) -> Entry {
        Entry {
            event,
            at_us,
            is_sure: true,
            stored: None,
        }
    }

    /// Entries half a second apart from the first on, dated by their own time; names of the faults.
    fn faults(events: &[Event], tested: &[(i64, i64)]) -> (Vec<u32>, ExcludedEntries) {
        let entries: Vec<_> = (0..)
            .zip(events)
            .map(|(index, code)| {
                let event = UnitEvent::at_stand(index, *code, index * 500);
                entry(event, Some(i64::from(index) * 500_000))
            })
            .collect();
        let judged = judge(&entries, tested, None);
        let indices = judged.faults.iter().map(|entry| entry.event.index);
        (indices.collect(), judged.left_out)
    }

    #[test]
    fn a_loop_left_by_a_train_that_is_driven_by_hand_is_no_fault() {
        for (mode, faults) in [(Mode::Manual, 0), (Mode::Yard, 0), (Mode::Automatic, 1)] {
            let event = UnitEvent {
                mode,
                ..UnitEvent::at_stand(0, Event::TwcLost, 5_000)
            };
            let judged = judge(&[entry(event, None)], &[], None);
            assert_eq!(judged.faults.len(), faults, "{mode:?}");
        }
    }

    #[test]
    fn disconnecting_the_bench_is_no_fault_of_the_unit() {
        let (found, left_out) = faults(
            &[
                Event::PowerUp,
                Event::TachoDead1,
                Event::InputsLost,
                Event::TcmsLost,
                Event::TwcLost,
                Event::EbRelayWelded,
            ],
            &[],
        );
        assert_eq!(found, [1, 5], "what is not silence stays");
        assert_eq!((left_out.information, left_out.alone), (1, 3));
    }

    #[test]
    fn loss_of_inputs_or_of_tcms_alone_is_a_fault_and_so_is_an_earlier_loss() {
        assert_eq!(faults(&[Event::InputsLost, Event::TwcLost], &[]).0, [0, 1]);
        let gone_before = [
            Event::TcmsLost,
            Event::MarkerMissing,
            Event::MarkerMissing,
            Event::MarkerMissing,
            Event::MarkerMissing,
            Event::InputsLost,
            Event::TwcLost,
        ];
        assert_eq!(faults(&gone_before, &[]).0, [0, 1, 2, 3, 4]);
        let back = [
            Event::InputsLost,
            Event::TcmsLost,
            Event::InputsRestored,
            Event::TcmsRestored,
            Event::TcmsLost,
        ];
        assert_eq!(faults(&back, &[]).0, [4]);
    }

    #[test]
    fn the_effects_of_a_tester_are_no_faults() {
        let armed = [
            Event::OverspeedEb,
            Event::Armed,
            Event::OverspeedEb,
            Event::ArmingLapsed,
            Event::TachoDead1,
        ];
        assert_eq!(faults(&armed, &[]).0, [0, 4]);
        // The beginning is overwritten; a unit still armed.
        let cut = [
            Event::OverspeedEb,
            Event::ArmingLapsed,
            Event::TachoDead1,
            Event::Armed,
            Event::OverspeedEb,
        ];
        assert_eq!(faults(&cut, &[]).0, [2]);
        let (found, left_out) = faults(&[Event::OverspeedEb; 6], &[(900_000, 2_100_000)]);
        assert_eq!(found, [0, 1, 5]);
        assert_eq!(left_out.under_test, 3);
    }

    /// Goal: what a bad line did is no fault of modems and boards, and what a bad modem did is one. Method:
    /// frames refused on two channels at once, and on one.
    #[test]
    fn frames_of_several_partners_rejected_at_once_are_blamed_on_the_line() {
        let refused = |channel: Channel, at_ms: u32| {
            let event = UnitEvent {
                parameter: i32::from(channel.code()),
                ..UnitEvent::at_stand(0, Event::FramesRejected, at_ms)
            };
            entry(event, None)
        };
        let lost = |at_ms| entry(UnitEvent::at_stand(0, Event::TwcLost, at_ms), None);
        let bad_line = [
            refused(Channel::Twc, 1_000),
            lost(3_000),
            refused(Channel::Io, 6_000),
        ];
        let judged = judge(&bad_line, &[], None);
        assert_eq!((judged.faults.len(), judged.left_out.line), (0, 3));
        let bad_modem = [
            refused(Channel::Twc, 1_000),
            lost(3_000),
            refused(Channel::Twc, 11_000),
        ];
        assert_eq!(judge(&bad_modem, &[], None).faults.len(), 3);
        let long_before = [
            refused(Channel::Io, 1_000),
            lost(30_000),
            refused(Channel::Twc, 31_000),
        ];
        assert_eq!(judge(&long_before, &[], None).faults.len(), 3);
    }

    #[test]
    fn only_entries_that_are_surely_dated_can_be_too_old() {
        let entry = |at_us, is_sure| Entry {
            is_sure,
            ..entry(UnitEvent::at_stand(0, Event::TachoDead1, 0), at_us)
        };
        let entries = [
            entry(Some(1), true),
            entry(Some(3), true),
            entry(None, true),
            entry(Some(1), false),
        ];
        let judged = judge(&entries, &[], Some(2));
        assert_eq!(judged.faults, entries[1..]);
        assert_eq!(judged.left_out.too_old, 1);
    }
}
