//! Hostile streams: seeded mutations of sound frames and plain noise, fed to both ends.
//!
//! Goal: nothing is accepted that was not sent, nothing panics, memory stays bounded. Method: frames
//! of the vector files are cut, joined, repeated, flipped and mixed with noise; whatever a receiver
//! accepts must be, byte for byte, a frame of the corpus.

use std::collections::BTreeSet;

use protocol::frame::{self, Decoder, MAX_PENDING};
use protocol::link::{End, Link};
use protocol::{Instant, Random};

use crate::common::corpus;

const SEEDS: u64 = 400;
const MUTATIONS: usize = 60;

fn damaged(random: &mut Random, corpus: &[Vec<u8>]) -> Vec<u8> {
    let mut stream = Vec::new();
    for _ in 0..MUTATIONS {
        let mut piece = corpus[random.below(corpus.len())].clone();
        for _ in 0..random.below(3) {
            mutate(random, &mut piece, corpus);
        }
        stream.extend(piece);
    }
    stream
}

fn mutate(random: &mut Random, piece: &mut Vec<u8>, corpus: &[Vec<u8>]) {
    let at = random.below(piece.len());
    let to = at + random.below(piece.len() - at);
    match random.below(9) {
        0 => piece[at] ^= 1 << random.below(8),
        1 => piece[at] = random.bits() as u8,
        2 => piece[at] = [0x7E, 0x7D, 0x5E, 0x5D][random.below(4)],
        3 => drop(piece.drain(at..to)),
        4 => piece.truncate(at.max(1)),
        5 => {
            let copy = piece[at..to].to_vec();
            piece.splice(at..at, copy);
        }
        6 => {
            let donor = &corpus[random.below(corpus.len())];
            let from = random.below(donor.len());
            piece.splice(at..to, donor[from..].iter().copied());
        }
        7 => {
            let noise = (0..random.below(400))
                .map(|_| random.bits() as u8)
                .collect::<Vec<_>>();
            piece.splice(at..at, noise);
        }
        _ => piece.swap(at, to),
    }
}

#[test]
fn nothing_is_accepted_that_nobody_sent() {
    let corpus: Vec<Vec<u8>> = corpus().into_iter().map(|(_, frame)| frame).collect();
    let sound: BTreeSet<&[u8]> = corpus.iter().map(|frame| &frame[..]).collect();
    let (mut accepted, mut refused) = (0, 0);
    for seed in 0..SEEDS {
        let mut random = Random::new(seed);
        let stream = damaged(&mut random, &corpus);
        for end in [End::Unit, End::Bench] {
            let mut link = Link::new(end);
            let mut rest = &stream[..];
            let mut now = Instant::ZERO;
            while !rest.is_empty() {
                let (chunk, later) = rest.split_at(1 + random.below(rest.len().min(300)));
                rest = later;
                link.push(chunk);
                now += protocol::Duration::from_ms(random.below(400) as u64);
                while let Some(received) = link.poll(now) {
                    let (mut payload, mut again) = (Vec::new(), Vec::new());
                    received.message.encode(&mut payload);
                    frame::encode(&received.header, &payload, &mut again);
                    assert!(sound.contains(&again[..]), "seed {seed}, {received:?}");
                    accepted += 1;
                }
            }
            refused += link.counters().rejected_total();
        }
    }
    // The streams are neither all rubbish nor all sound.
    assert!(
        accepted > 1000 && refused > 10_000,
        "{accepted} accepted, {refused} refused"
    );
}

#[test]
fn noise_is_never_a_frame() {
    for seed in 0..20 {
        let mut random = Random::new(seed);
        let mut decoder = Decoder::new();
        for _ in 0..200 {
            // Noise rich in flags and escapes, so that many frames begin and end.
            let byte = |bits: u64| [bits as u8, 0x7E, 0x7D, 0x5E][(bits >> 32) as usize % 16 / 4];
            let noise: Vec<u8> = (0..1000).map(|_| byte(random.bits())).collect();
            decoder.push(&noise);
            while let Some(next) = decoder.next_frame() {
                assert!(next.is_err(), "seed {seed}");
            }
        }
    }
}

#[test]
fn a_flood_is_bounded() {
    let mut random = Random::new(1);
    for flagless in [true, false] {
        let mut decoder = Decoder::new();
        let flood: Vec<u8> = (0..100_000)
            .map(|_| random.bits() as u8)
            .filter(|&byte| !flagless || byte != 0x7E)
            .collect();
        for _ in 0..50 {
            decoder.push(&flood);
            assert!(decoder.pending_len() <= MAX_PENDING);
        }
        while decoder.next_frame().is_some() {}
        assert_eq!(decoder.pending_len(), 0);
    }
}

/// Bytes that arrived before a restart belong to no frame after it, and each byte is counted once.
#[test]
fn a_restart_counts_every_byte_that_it_forgets() {
    let mut decoder = Decoder::new();
    decoder.push(&[0x7E, 1, 2, 3]);
    assert!(decoder.next_frame().is_none());
    decoder.push(&[4, 5]);
    assert_eq!(decoder.pending_len(), 2);
    decoder.restart();
    assert_eq!(decoder.garbage, 5);
    assert_eq!(decoder.pending_len(), 0);
    decoder.push(&[6, 7, 0x7E]);
    assert!(decoder.next_frame().is_none());
    assert_eq!(decoder.garbage, 7);
}
