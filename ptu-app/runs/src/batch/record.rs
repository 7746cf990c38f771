//! The format of a file of runs: a row of records, first a head, then one for each run, appended when the run is over,
//! and another head where another plan went on with the file.
//!
//! A record is [`MARK`], the length of its content (4 bytes, least first), CRC-32 over length and content (4 bytes),
//! and its content, JSON compressed with zstd. A damaged record is left out and reported by its number; the next one is
//! found by its mark. So a file gives the runs that were put into it, or fewer, and what is missing is made again.
//!
//! A file whose runs are all there is in order: one head, and the runs by their names. So its bytes depend on the
//! runs alone, not on who made them when.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::ops::Range;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::Head;

/// Begins a record.
const MARK: &[u8; 8] = b"\x89PTURUN1";
/// Mark, length and check sum.
const HEAD: usize = 16;
/// A record unpacks to at most this many bytes.
const MOST_UNPACKED: u64 = 64 << 20;
/// Compression level: written often, and read as often.
const ZSTD_LEVEL: i32 = 3;

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Content<R> {
    Head(Head),
    Run { name: String, run: R },
}

pub(super) fn head_record(head: &Head) -> Vec<u8> {
    record(&Content::<()>::Head(head.clone()))
}

/// The record of a run.
pub(super) fn of_run(name: String, run: &impl Serialize) -> Vec<u8> {
    record(&Content::Run { name, run })
}

/// A record of the file.
fn record(content: &Content<impl Serialize>) -> Vec<u8> {
    // Maps with texts for keys, numbers and texts, packed in memory: neither can fail.
    let json = serde_json::to_vec(content).unwrap_or_default();
    let packed = zstd::encode_all(json.as_slice(), ZSTD_LEVEL).unwrap_or_default();
    let length = u32::try_from(packed.len())
        .unwrap_or(u32::MAX)
        .to_le_bytes();
    let check = crc(length, &packed).to_le_bytes();
    [MARK.as_slice(), &length, &check, &packed].concat()
}

fn crc(length: [u8; 4], packed: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&length);
    hasher.update(packed);
    hasher.finalize()
}

/// The content of the record that begins here, if it is whole, and its length with its head.
fn content(bytes: &[u8]) -> Option<(&[u8], usize)> {
    let (head, rest) = bytes.split_first_chunk::<HEAD>()?;
    let [mark @ .., l0, l1, l2, l3, c0, c1, c2, c3] = head;
    let length = [*l0, *l1, *l2, *l3];
    let packed = rest.get(..u32::from_le_bytes(length) as usize)?;
    let is_whole = mark == MARK && crc(length, packed) == u32::from_le_bytes([*c0, *c1, *c2, *c3]);
    is_whole.then_some((packed, HEAD + packed.len()))
}

fn unpacked<T: DeserializeOwned>(packed: &[u8]) -> Option<T> {
    let unpacked = zstd::Decoder::new(packed).ok()?.take(MOST_UNPACKED);
    serde_json::from_reader(std::io::BufReader::new(unpacked)).ok()
}

#[derive(Debug)]
pub(super) struct Found<R> {
    /// The last head; what the runs were made by is equal in all heads.
    pub head: Head,
    /// Each run, and where its record is.
    pub runs: BTreeMap<String, (R, Range<usize>)>,
    /// Where the last whole record ends.
    pub end: usize,
    /// Sentences on damage.
    pub told: Vec<String>,
}

impl<R: DeserializeOwned> Found<R> {
    /// Reads a file's bytes.
    ///
    /// # Errors
    /// The file does not say what its runs were made by.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        let (first, length) = content(bytes).ok_or_else(|| match bytes.starts_with(MARK) {
            true => "its record 1, which says what its runs were made by, is damaged".to_owned(),
            false if bytes.is_empty() => "it is empty".to_owned(),
            false => "it does not begin as a file of runs".to_owned(),
        })?;
        let Some(Content::<R>::Head(head)) = unpacked(first) else {
            return Err("its runs were made by another version of the program".into());
        };
        let mut found = Self {
            head,
            runs: BTreeMap::new(),
            end: length,
            told: Vec::new(),
        };
        let mut at = length;
        for number in 2u64.. {
            let Some(rest) = bytes.get(at..).filter(|rest| !rest.is_empty()) else {
                break;
            };
            if let Some((packed, length)) = content(rest) {
                let place = at..at + length;
                at += length;
                found.end = at;
                match unpacked(packed) {
                    Some(Content::Run { name, run }) => {
                        found.runs.insert(name, (run, place));
                    }
                    Some(Content::Head(head)) if found.head.other_maker(&head).is_none() => {
                        found.head = head;
                    }
                    _ => found.damaged(number),
                }
                continue;
            }
            let next = rest
                .windows(MARK.len())
                .skip(1)
                .position(|mark| mark == MARK);
            let Some(next) = next else {
                found.told.push(format!(
                    "record {number}, the last, is not whole; its run is made again"
                ));
                break;
            };
            found.damaged(number);
            at += next + 1;
        }
        Ok(found)
    }

    fn damaged(&mut self, number: u64) {
        (self.told).push(format!("record {number} is damaged; its run is made again"));
    }
}

/// A file with one head and the runs in order, their records unchanged.
pub(super) fn in_order<'a>(
    head: &Head,
    records: impl Iterator<Item = (&'a String, &'a [u8])>,
) -> Vec<u8> {
    let mut records: Vec<_> = records.collect();
    records.sort();
    let mut bytes = head_record(head);
    for (_, record) in records {
        bytes.extend_from_slice(record);
    }
    bytes
}
