//! Runs of campaigns kept in a file, so that another campaign of the same program and scripts need not make them again:
//! one that was stopped, one with more seeds, or one with other settings of the diagnosis.
//!
//! The file is a row of records: the basis, then one for each run, appended when the run is over. A record is
//! [`MARK`], the length of its content (4 bytes, least first), CRC-32 over length and content (4 bytes), and its
//! content, JSON compressed with zstd. A damaged record is left out and told by its number; the next one is found by
//! its mark. So a file gives the runs that were put into it, or fewer, and what is missing is made again.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use diagnosis::Basis;
use fault_db::open_regular_file;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::samples::Sample;
use super::suite::SuiteRun;
use crate::data::sha256;
use crate::failure::Failure;
use crate::stdio;

/// Begins a record.
const MARK: &[u8; 8] = b"\x89PTURUN1";
/// Mark, length and check sum.
const HEAD: usize = 16;
/// A file has at most this many bytes: some twenty thousand runs.
const MOST_BYTES: u64 = 1 << 30;
/// A record unpacks to at most this many bytes.
const MOST_UNPACKED: u64 = 64 << 20;
/// Compression level: written often, and read as often.
const ZSTD_LEVEL: i32 = 3;

/// Runs by what decides them, and the file that keeps them, if one does.
#[derive(Default)]
pub(super) struct KeptRuns {
    runs: BTreeMap<String, SuiteRun>,
    file: Option<RunsFile>,
}

/// The file, open at its end.
pub(super) struct RunsFile {
    path: PathBuf,
    /// And the first error of writing.
    state: Mutex<(File, Option<Failure>)>,
}

#[derive(Serialize, Deserialize)]
struct KeptRun<R> {
    sample: String,
    run: R,
}

impl KeptRuns {
    /// Reads a file, which is made if it is not there, and opens it for more runs. What is damaged in it is told.
    ///
    /// # Errors
    /// It cannot be read or written, another campaign writes it, it is another file, or it holds runs of another
    /// program or other scripts.
    pub fn open(path: &Path, basis: &Basis) -> Result<Self, Failure> {
        let wrong = |why: &dyn Display| {
            Failure::usage(format!(
                "cannot use {}: {why}; name another file",
                path.display()
            ))
        };
        if path.exists() {
            // No device or pipe.
            open_regular_file(path).map_err(|error| wrong(&error))?;
        }
        let mut options = OpenOptions::new();
        let options = options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(path).map_err(|error| wrong(&error))?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => return Err(wrong(&"another campaign writes it")),
            // A file system without locks.
            Err(TryLockError::Error(_)) | Ok(()) => {}
        }
        let mut bytes = Vec::new();
        let read = Read::by_ref(&mut file)
            .take(MOST_BYTES + 1)
            .read_to_end(&mut bytes);
        read.map_err(|error| wrong(&error))?;
        if bytes.len() as u64 > MOST_BYTES {
            return Err(wrong(&format!("it has more than {MOST_BYTES} bytes")));
        }
        let found = Found::read(&bytes, basis).map_err(|why| wrong(&why))?;
        for told in &found.told {
            stdio::note(&format!("{}: {told}", path.display()));
        }
        let ready = file
            .set_len(found.end as u64)
            .and_then(|()| file.seek(SeekFrom::End(0)));
        ready.map_err(|error| wrong(&error))?;
        if found.end == 0 {
            (file.write_all(&record(basis))).map_err(|error| wrong(&error))?;
        }
        Ok(Self {
            runs: found.runs,
            file: Some(RunsFile {
                path: path.to_owned(),
                state: Mutex::new((file, None)),
            }),
        })
    }

    /// Whether the sample's run is among them.
    pub fn has(&self, sample: &Sample) -> bool {
        self.runs.contains_key(&key(sample))
    }

    /// Adds a run that was made now.
    pub fn put(&mut self, sample: &Sample, run: SuiteRun) {
        self.runs.insert(key(sample), run);
    }

    /// Takes a run out.
    pub fn take(&mut self, sample: &Sample) -> Option<SuiteRun> {
        self.runs.remove(&key(sample))
    }

    /// The file that keeps them.
    pub fn file(&self) -> Option<&RunsFile> {
        self.file.as_ref()
    }
}

impl RunsFile {
    /// Appends a run: a program that is killed loses no other. False once the file takes none.
    pub fn append(&self, sample: &Sample, run: &SuiteRun) -> bool {
        let sample = key(sample);
        let bytes = record(&KeptRun { sample, run });
        let Ok(mut state) = self.state.lock() else {
            return false;
        };
        let (file, failure) = &mut *state;
        if failure.is_none()
            && let Err(error) = file.write_all(&bytes)
        {
            *failure = Some(Failure::bench(format!(
                "cannot write {}: {error}; it keeps the runs before, and the campaign goes on with the same command",
                self.path.display()
            )));
        }
        failure.is_none()
    }

    /// The first error of writing, if there was one.
    pub fn take_failure(&self) -> Option<Failure> {
        self.state.lock().ok()?.1.take()
    }
}

/// A record of the file.
fn record(content: &impl Serialize) -> Vec<u8> {
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

/// What a file holds.
#[derive(Default)]
struct Found {
    runs: BTreeMap<String, SuiteRun>,
    /// Where the last whole record ends.
    end: usize,
    /// What is to be said of damage.
    told: Vec<String>,
}

impl Found {
    fn read(bytes: &[u8], basis: &Basis) -> Result<Self, String> {
        let mut found = Self::default();
        // Killed while it wrote its first record.
        if record(basis).starts_with(bytes) {
            found.end = if bytes == record(basis) {
                bytes.len()
            } else {
                0
            };
            return Ok(found);
        }
        let (first, mut at) = content(bytes).ok_or_else(|| match bytes.starts_with(MARK) {
            true => "its record 1, which says what its runs were made by, is damaged".to_owned(),
            false => "it does not begin as a file of runs".to_owned(),
        })?;
        if unpacked::<Basis>(first).as_ref() != Some(basis) {
            return Err("its runs were made by another program or with other scripts".into());
        }
        found.end = at;
        for number in 2u64.. {
            let Some(rest) = bytes.get(at..).filter(|rest| !rest.is_empty()) else {
                break;
            };
            if let Some((packed, length)) = content(rest) {
                at += length;
                found.end = at;
                match unpacked::<KeptRun<SuiteRun>>(packed) {
                    Some(KeptRun { sample, run }) => drop(found.runs.insert(sample, run)),
                    None => found.damaged(number),
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

/// SHA-256 of all that decides a run beside the scripts.
fn key(sample: &Sample) -> String {
    let Sample {
        faults,
        sets_in_s,
        seed,
        purpose: _,
        cause: _,
        level: _,
    } = sample;
    sha256(&json!({ "faults": faults, "sets_in_s": sets_in_s, "seed": seed }).to_string())
}

#[cfg(test)]
mod tests;
