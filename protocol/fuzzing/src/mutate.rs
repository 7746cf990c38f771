//! Damages inputs: flips bits, changes bytes, drops, repeats and inserts pieces, and splices in pieces of other
//! examples.

use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash as _, Hasher as _};

/// Bytes with a meaning in the formats that are read in this workspace.
const WORDS: [&[u8]; 30] = [
    b"\0",
    b"\xFF",
    b"\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF",
    b"\xFF\xFF\xFF\x7F",
    b"\x7E",
    b"\x7D",
    b"-",
    b"-1",
    b"0",
    b"1e999",
    b"nan",
    b"inf",
    b"-0.0",
    b"9223372036854775807",
    b"18446744073709551616",
    b"1e-320",
    b"\"",
    b"\\",
    b"\n",
    b"\r",
    b"[",
    b"]",
    b"{",
    b"}",
    b"=",
    b",",
    b"..",
    b"null",
    b"\xC3\x28",
    "€".as_bytes(),
];
/// Most times that one input is damaged.
const MOST: usize = 6;

/// Random numbers; one seed always gives the same numbers.
pub struct Dice {
    state: u64,
}

impl Dice {
    pub fn new(seed: u64, name: &str) -> Self {
        let mut hasher = DefaultHasher::new();
        (seed, name).hash(&mut hasher);
        Self {
            state: hasher.finish() | 1,
        }
    }

    /// The next 64 random bits (SplitMix64).
    fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.state;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        bits ^ (bits >> 31)
    }

    /// A random number below `end`; 0 if `end` is 0.
    pub fn below(&mut self, end: usize) -> usize {
        match end {
            0 => 0,
            _ => (self.bits() % end as u64) as usize,
        }
    }

    /// Makes the next input: a damaged copy of an example of the corpus, at most `longest` bytes.
    pub fn damaged(&mut self, corpus: &[Vec<u8>], longest: usize, input: &mut Vec<u8>) {
        input.clone_from(&corpus[self.below(corpus.len())]);
        for _ in 0..1 + self.below(MOST) {
            self.damage(corpus, input);
            input.truncate(longest);
        }
    }

    fn damage(&mut self, corpus: &[Vec<u8>], input: &mut Vec<u8>) {
        let at = self.below(input.len() + 1);
        // Mostly short pieces: after long ones little is left of the example.
        let length = match self.below(4) {
            0 => self.below(input.len() + 1 - at),
            _ => self.below((input.len() + 1 - at).min(16)),
        };
        let piece = at..at + length;
        match self.below(9) {
            0 | 1 => {
                if let Some(byte) = input.get_mut(at) {
                    *byte ^= 1 << self.below(8);
                }
            }
            2 => {
                if let Some(byte) = input.get_mut(at) {
                    *byte = self.bits() as u8;
                }
            }
            3 => drop(input.drain(piece)),
            4 => {
                let copy = input[piece].to_vec();
                let times = 1 + self.below(4);
                input.splice(at..at, copy.repeat(times));
            }
            5 => {
                let word = WORDS[self.below(WORDS.len())];
                let over = (at + word.len() * self.below(2)).min(input.len());
                input.splice(at..over, word.iter().copied());
            }
            6 => {
                let donor = &corpus[self.below(corpus.len())];
                let from = self.below(donor.len() + 1);
                let to = from + self.below((donor.len() - from).min(64) + 1);
                input.splice(piece, donor[from..to].iter().copied());
            }
            7 => {
                let noise: Vec<u8> = (0..self.below(12)).map(|_| self.bits() as u8).collect();
                input.splice(at..at, noise);
            }
            _ => input.truncate(at),
        }
    }
}
