//! Properties of the wire: whatever is sent arrives, and whatever happens to it on the way is
//! refused and counted.

use proptest::collection::vec;
use proptest::prelude::*;
use protocol::frame::{Decoder, MAX_BODY, Reject};
use protocol::link::{Counters, End, Link, MAX_AHEAD, RESYNC, Received};
use protocol::message::{CATALOGUE, Channel, Identify, KeepAlive, Message};
use protocol::{Duration, Instant};

use crate::common::{message_from, over_channels, receiver};

/// Any message: every field of every layout takes any bytes, unknown words and bits included.
fn any_message() -> impl Strategy<Value = Message> {
    (0..CATALOGUE.len(), vec(any::<u8>(), 1..64))
        .prop_map(|(i, bytes)| message_from(&CATALOGUE[i], &bytes))
}

/// Messages of one direction.
fn messages_to(end: End) -> impl Strategy<Value = Vec<Message>> {
    let specs: Vec<_> = CATALOGUE
        .iter()
        .filter(|spec| receiver(spec) == end)
        .collect();
    let one = (0..specs.len(), vec(any::<u8>(), 1..64));
    vec(
        one.prop_map(move |(i, bytes)| message_from(specs[i], &bytes)),
        1..20,
    )
}

fn any_end() -> impl Strategy<Value = End> {
    prop_oneof![Just(End::Unit), Just(End::Bench)]
}

fn other(end: End) -> End {
    match end {
        End::Unit => End::Bench,
        End::Bench => End::Unit,
    }
}

const NOW: Instant = Instant::from_ms(5_000_000_000);

/// One frame for each message, from a new sender.
fn frames(end: End, messages: &[Message]) -> Vec<Vec<u8>> {
    let mut link = Link::new(other(end));
    let send = |message| {
        let mut frame = Vec::new();
        link.send(NOW, message, &mut frame);
        frame
    };
    messages.iter().map(send).collect()
}

/// Everything a new receiver accepts of a stream.
fn received(end: End, stream: &[u8]) -> (Vec<Received>, Counters) {
    let mut link = Link::new(end);
    link.push(stream);
    let received = std::iter::from_fn(|| link.poll(NOW)).collect();
    (received, *link.counters())
}

fn words(received: &[Received]) -> Vec<Message> {
    received.iter().map(|received| received.message).collect()
}

/// Three frames of one channel, the middle one the victim, and where to hit it.
fn victim() -> impl Strategy<Value = (End, [Vec<u8>; 3], [Message; 3], proptest::sample::Index)> {
    let triple = (
        0..CATALOGUE.len(),
        vec(any::<u8>(), 64..192),
        any::<proptest::sample::Index>(),
    );
    triple.prop_map(|(i, bytes, index)| {
        let spec = &CATALOGUE[i];
        let third = bytes.len() / 3;
        let messages = [0, 1, 2].map(|n| message_from(spec, &bytes[n * third..(n + 1) * third]));
        let end = receiver(spec);
        let frames = frames(end, &messages);
        (
            end,
            frames.try_into().expect("three frames"),
            messages,
            index,
        )
    })
}

/// A length the flags cannot be part of.
fn inside(frame: &[u8], index: proptest::sample::Index) -> usize {
    1 + index.index(frame.len() - 2)
}

proptest! {
    // A failure prints its smallest input, which belongs into a test of its own, not into a file.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_message_round_trips(
        (end, messages) in any_end().prop_flat_map(|end| (Just(end), messages_to(end))),
        noise in vec(vec(any::<u8>(), 0..12), 20),
        chunks in vec(1..40usize, 1..10),
    ) {
        let mut stream = Vec::new();
        for (frame, noise) in frames(end, &messages).iter().zip(&noise) {
            stream.extend(noise);
            stream.extend(frame);
        }
        let mut link = Link::new(end);
        let mut arrived = Vec::new();
        let mut rest = &stream[..];
        for &chunk in chunks.iter().cycle() {
            let (piece, later) = rest.split_at(chunk.min(rest.len()));
            link.push(piece);
            arrived.extend(std::iter::from_fn(|| link.poll(NOW)));
            rest = later;
            if rest.is_empty() { break }
        }
        prop_assert_eq!(words(&arrived), messages);
        prop_assert_eq!(over_channels(|c| link.counters().gaps(c)), 0);
    }

    #[test]
    fn values_shown_are_values_sent(message in any_message()) {
        let shown = message.show();
        prop_assert_eq!(shown.len(), message.spec().fields.len());
        for (field, value) in shown {
            prop_assert!(!value.is_empty() && !value.contains(' '), "{} {value}", field.name);
        }
    }

    #[test]
    fn a_changed_byte_is_refused((end, [a, mut b, c], sent, index) in victim(), change in 1..=255u8) {
        let at = inside(&b, index);
        b[at] ^= change;
        let (arrived, counters) = received(end, &[a, b, c].concat());
        prop_assert_eq!(words(&arrived), [sent[0], sent[2]]);
        let named = [Reject::Checksum, Reject::Escape, Reject::TooShort];
        let refused: u64 = named.iter().map(|&reason| counters.rejected(reason)).sum();
        // A byte that became a flag makes two of one.
        prop_assert!((1..=2).contains(&refused), "{counters:?}");
        prop_assert_eq!(counters.rejected_total(), refused);
        prop_assert_eq!(over_channels(|c| counters.gaps(c)), 1);
    }

    #[test]
    fn a_changed_flag_costs_that_frame_at_most(
        (end, [a, mut b, c], sent, _) in victim(), last in any::<bool>(), change in 1..=255u8,
    ) {
        let at = if last { b.len() - 1 } else { 0 };
        b[at] ^= change;
        let (arrived, counters) = received(end, &[a, b, c].concat());
        prop_assert_eq!(words(&arrived), [sent[0], sent[2]]);
        prop_assert_eq!(counters.rejected_total(), 1);
    }

    #[test]
    fn a_truncated_frame_is_refused((end, [a, mut b, c], sent, index) in victim()) {
        // Less than two bytes off the end, the next frame's flag makes it whole.
        b.truncate(inside(&b, index).min(b.len() - 2));
        let cut = b.len();
        let (arrived, counters) = received(end, &[a, b, c].concat());
        prop_assert_eq!(words(&arrived), [sent[0], sent[2]]);
        prop_assert_eq!(counters.rejected_total(), u64::from(cut > 1));
        prop_assert_eq!(over_channels(|c| counters.gaps(c)), 1);
    }

    #[test]
    fn a_frame_without_its_beginning_is_refused((end, [a, mut b, c], sent, index) in victim()) {
        let gone = inside(&b, index).min(b.len() - 2);
        // The flag of the frame before opens this one, unless a byte is missing, too.
        b.drain(..=gone);
        let (arrived, counters) = received(end, &[a, b, c].concat());
        prop_assert_eq!(words(&arrived), [sent[0], sent[2]]);
        prop_assert!(counters.rejected_total() <= 1);
        prop_assert_eq!(over_channels(|c| counters.gaps(c)), 1);
    }

    #[test]
    fn missing_bytes_are_noticed((end, [a, mut b, c], sent, index) in victim(), len in 1..8usize) {
        let at = inside(&b, index);
        let to = (at + len).min(b.len() - 1);
        b.drain(at..to);
        let (arrived, _) = received(end, &[a, b, c].concat());
        prop_assert_eq!(words(&arrived), [sent[0], sent[2]]);
    }

    #[test]
    fn inserted_bytes_are_noticed(
        (end, [a, mut b, c], sent, index) in victim(), noise in vec(any::<u8>(), 1..8),
    ) {
        // A run of flags right behind the opening flag or before the closing one changes nothing.
        prop_assume!(noise.iter().any(|&byte| byte != 0x7E));
        let at = inside(&b, index);
        b.splice(at..at, noise);
        let (arrived, counters) = received(end, &[a, b, c].concat());
        // Noise that ends in a flag right behind the opening one leaves the frame as it was.
        let harmless = words(&arrived) == sent;
        prop_assert!(harmless || words(&arrived) == [sent[0], sent[2]], "{arrived:?}");
        prop_assert!(counters.rejected_total() >= 1);
    }

    #[test]
    fn a_repeated_frame_is_refused((end, [a, b, c], sent, _) in victim(), times in 1..5usize) {
        let (arrived, counters) = received(end, &[a, b.repeat(1 + times), c].concat());
        prop_assert_eq!(words(&arrived), sent);
        prop_assert_eq!(counters.rejected(Reject::Sequence), times as u64);
    }

    #[test]
    fn a_frame_out_of_order_is_refused((end, [a, b, c], sent, _) in victim()) {
        let (arrived, counters) = received(end, &[a, c, b].concat());
        prop_assert_eq!(words(&arrived), [sent[0], sent[2]]);
        prop_assert_eq!(counters.rejected(Reject::Sequence), 1);
        prop_assert_eq!(over_channels(|c| counters.gaps(c)), 1);
    }

    #[test]
    fn a_lost_frame_leaves_a_gap((end, [a, _, c], sent, _) in victim()) {
        let (arrived, counters) = received(end, &[a, c].concat());
        prop_assert_eq!(words(&arrived), [sent[0], sent[2]]);
        prop_assert_eq!(counters.rejected_total(), 0);
        prop_assert_eq!(over_channels(|c| counters.gaps(c)), 1);
    }

    #[test]
    fn the_wrong_end_hears_nothing((end, frames, _, _) in victim()) {
        let (arrived, counters) = received(other(end), &frames.concat());
        prop_assert_eq!(arrived.len(), 0);
        prop_assert_eq!(counters.rejected(Reject::Address), 3);
    }

    #[test]
    fn any_bytes_are_borne(stream in vec(any::<u8>(), 0..4000), chunk in 1..300usize) {
        let mut decoder = Decoder::new();
        for piece in stream.chunks(chunk) {
            decoder.push(piece);
            while let Some(next) = decoder.next_frame() {
                prop_assert!(next.is_err() || next.is_ok_and(|(_, payload)| payload.len() < MAX_BODY));
            }
        }
        prop_assert!(decoder.garbage <= stream.len() as u64);
    }

    #[test]
    fn any_payload_is_borne(payload in vec(any::<u8>(), 0..250)) {
        for channel in Channel::ALL {
            if let Ok(message) = Message::decode(channel, &payload) {
                let mut again = Vec::new();
                message.encode(&mut again);
                prop_assert_eq!(&again, &payload);
            }
        }
    }

    #[test]
    fn late_frames_are_refused_however_far_apart_the_clocks(
        sender_ms in 0..1u64 << 33, receiver_ms in 0..1u64 << 33, late_ms in 0..900u64,
    ) {
        let (mut bench, mut unit) = (Link::new(End::Bench), Link::new(End::Unit));
        let (ours, theirs) = (Instant::from_ms(receiver_ms), Instant::from_ms(sender_ms));
        let mut pass = |at_ms, late_ms| {
            let mut bytes = Vec::new();
            bench.send(theirs + Duration::from_ms(at_ms), &Identify {}.into(), &mut bytes);
            unit.push(&bytes);
            unit.poll(ours + Duration::from_ms(at_ms + late_ms)).is_some()
        };
        prop_assert!(pass(0, 0));
        prop_assert_eq!(pass(50, late_ms), late_ms <= 500);
        prop_assert!(pass(950, 0));
    }
}

/// Sends `count` frames a millisecond apart and gives how many of them are accepted.
fn run(bench: &mut Link, unit: &mut Link, from: Instant, count: u64) -> usize {
    let accepted = |i| {
        let now = from + Duration::from_ms(i);
        let mut bytes = Vec::new();
        bench.send(now, &KeepAlive { session: i as u32 }.into(), &mut bytes);
        unit.push(&bytes);
        usize::from(unit.poll(now).is_some())
    };
    (0..count).map(accepted).sum()
}

#[test]
fn the_sequence_number_wraps() {
    let (mut bench, mut unit) = (Link::new(End::Bench), Link::new(End::Unit));
    assert_eq!(run(&mut bench, &mut unit, NOW, 140_000), 140_000);
    assert_eq!(unit.counters().gaps(Channel::Ptu), 0);
}

#[test]
fn a_restarted_tester_is_heard_after_silence() {
    let (mut bench, mut unit) = (Link::new(End::Bench), Link::new(End::Unit));
    run(&mut bench, &mut unit, NOW, 1 + u64::from(MAX_AHEAD));
    let last = NOW + Duration::from_ms(u64::from(MAX_AHEAD));
    assert_eq!(unit.last_heard(Channel::Ptu), Some(last));

    let mut restarted = Link::new(End::Bench);
    let own_clock = Instant::from_ms(3);
    let mut at = |now: Instant, bench: &mut Link| {
        let mut bytes = Vec::new();
        bench.send(own_clock + now.since(last), &Identify {}.into(), &mut bytes);
        unit.push(&bytes);
        unit.poll(now).is_some()
    };
    assert!(!at(last + Duration::from_ms(10), &mut restarted));
    assert!(!at(
        (last + RESYNC).back(Duration::from_us(1)),
        &mut restarted
    ));
    assert!(at(last + RESYNC, &mut restarted));
    assert!(at(last + RESYNC, &mut restarted));
    assert_eq!(unit.last_heard(Channel::Ptu), Some(last + RESYNC));
    let counters = &unit.counters();
    assert_eq!(counters.rejected_on(Channel::Ptu), 2);
    let refused = |channel| counters.rejected_for(Reject::Sequence, channel);
    assert_eq!(
        [Some(Channel::Ptu), Some(Channel::Io), None].map(refused),
        [2, 0, 0]
    );
}

#[test]
fn clocks_that_drift_apart_stay_in_step() {
    for drift_ppm in [-100_i64, 100] {
        let (mut bench, mut unit) = (Link::new(End::Bench), Link::new(End::Unit));
        // Six hours, in which the clocks come 2.2 s apart: four times the delay allowed.
        for i in 0..2 * 6 * 3600_u64 {
            let now = Instant::from_ms(60_000 + 500 * i);
            let theirs = now.as_us() as i64 + now.as_us() as i64 * drift_ppm / 1_000_000;
            let mut bytes = Vec::new();
            bench.send(
                Instant::from_us(theirs as u64),
                &Identify {}.into(),
                &mut bytes,
            );
            unit.push(&bytes);
            assert!(unit.poll(now).is_some(), "{drift_ppm} ppm, {now}");
        }
        // Relaxing forgives drift, not delay.
        let mut bytes = Vec::new();
        let sent = (unit.last_heard(Channel::Ptu).expect("heard")).as_us() as i64 + 1000;
        let theirs = sent + sent * drift_ppm / 1_000_000;
        bench.send(
            Instant::from_us(theirs as u64),
            &Identify {}.into(),
            &mut bytes,
        );
        unit.push(&bytes);
        assert!(
            unit.poll(Instant::from_us(sent as u64 + 510_000)).is_none(),
            "{drift_ppm} ppm"
        );
    }
}

#[test]
fn a_receiver_nobody_reads_keeps_the_newest() {
    let mut link = Link::new(End::Unit);
    let mut bench = Link::new(End::Bench);
    let mut last = 0;
    for _ in 0..100_000 {
        let mut bytes = Vec::new();
        last = bench.send(NOW, &Identify {}.into(), &mut bytes);
        link.push(&bytes);
    }
    let received: Vec<_> = std::iter::from_fn(|| link.poll(NOW)).collect();
    assert_eq!(received.last().map(|r| r.header.seq), Some(last));
    assert!(received.len() < 4200, "{}", received.len());
    assert!(link.counters().garbage() > 1_000_000);
}
