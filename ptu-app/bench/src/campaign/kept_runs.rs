//! Runs of campaigns kept in a file, so that another campaign of the same program and scripts need not make them again:
//! one that was stopped, one with more seeds, or one with other settings of the diagnosis.
//!
//! The file is JSON, compressed with zstd: the basis, then one value for each run.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::io::{BufReader, BufWriter, Read as _, Write as _};
use std::path::Path;

use diagnosis::Basis;
use fault_db::open_regular_file;
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::samples::Sample;
use super::suite::SuiteRun;
use crate::data::sha256;
use crate::failure::Failure;
use crate::new_file::NewFile;

/// A file unpacks to at most this many bytes: some twenty thousand runs.
const MOST_BYTES: u64 = 4 << 30;
/// Compression level: written often, and read as often.
const ZSTD_LEVEL: i32 = 3;

/// Runs by what decides them.
#[derive(Default)]
pub(super) struct KeptRuns(BTreeMap<String, SuiteRun>);

#[derive(Serialize, Deserialize)]
struct KeptRun<R> {
    sample: String,
    run: R,
}

impl KeptRuns {
    /// Reads a file; none if it is not there yet.
    ///
    /// # Errors
    /// It cannot be read, or holds runs of another program or other scripts.
    pub fn read(file: &Path, basis: &Basis) -> Result<Self, Failure> {
        if !file.exists() {
            return Ok(Self::default());
        }
        let wrong = |why: &dyn Display| {
            Failure::usage(format!(
                "cannot use {}: {why}; name another file",
                file.display()
            ))
        };
        let opened = open_regular_file(file).map_err(|error| wrong(&error))?;
        let unpacked = zstd::Decoder::new(opened).map_err(|error| wrong(&error))?;
        let mut values =
            serde_json::Deserializer::from_reader(BufReader::new(unpacked.take(MOST_BYTES)));
        let made_of = Basis::deserialize(&mut values).map_err(|error| wrong(&error))?;
        if made_of != *basis {
            return Err(wrong(
                &"its runs were made by another program or with other scripts",
            ));
        }
        let mut kept = BTreeMap::new();
        for read in values.into_iter::<KeptRun<SuiteRun>>() {
            let KeptRun { sample, run } = read.map_err(|error| wrong(&error))?;
            kept.insert(sample, run);
        }
        Ok(Self(kept))
    }

    /// Whether the sample's run is among them.
    pub fn has(&self, sample: &Sample) -> bool {
        self.0.contains_key(&key(sample))
    }

    /// Adds a run.
    pub fn put(&mut self, sample: &Sample, run: SuiteRun) {
        self.0.insert(key(sample), run);
    }

    /// Takes a run out.
    pub fn take(&mut self, sample: &Sample) -> Option<SuiteRun> {
        self.0.remove(&key(sample))
    }

    /// Writes all of them.
    ///
    /// # Errors
    /// The file cannot be written; what stood there stays.
    pub fn write(&self, file: &Path, basis: &Basis) -> Result<(), Failure> {
        let mut new = NewFile::begin(file)?;
        let written = self.write_to(&mut new, basis);
        written
            .map_err(|error| Failure::bench(format!("cannot write {}: {error}", file.display())))?;
        new.finish()
    }

    fn write_to(&self, to: &mut NewFile, basis: &Basis) -> std::io::Result<()> {
        let mut packed = BufWriter::new(zstd::Encoder::new(to, ZSTD_LEVEL)?);
        serde_json::to_writer(&mut packed, basis)?;
        for (sample, run) in &self.0 {
            let sample = sample.clone();
            packed.write_all(b"\n")?;
            serde_json::to_writer(&mut packed, &KeptRun { sample, run })?;
        }
        let packed = packed
            .into_inner()
            .map_err(std::io::IntoInnerError::into_error)?;
        packed.finish().map(drop)
    }
}

/// SHA-256 of all that decides a run beside the scripts.
fn key(sample: &Sample) -> String {
    let Sample {
        faults,
        sets_in_s,
        seed,
        purpose: _,
        level: _,
    } = sample;
    sha256(&json!({ "faults": faults, "sets_in_s": sets_in_s, "seed": seed }).to_string())
}

#[cfg(test)]
mod tests {
    use protocol::injection::FaultMode;

    use super::super::{Purpose, Request, samples};
    use super::*;
    use crate::test_support::scripts;

    fn drawn(modes: &[FaultMode], units: u32) -> Vec<Sample> {
        let asked = Request {
            faults: None,
            seeds: 1,
            held_out: 1,
            good: 2,
            leave_out: None,
            pairs: 40,
            other_spells: true,
            units,
            jobs: 1,
            kept: None,
        };
        samples(&modes.iter().collect::<Vec<_>>(), &asked)
    }

    #[test]
    fn a_run_is_kept_for_its_sample_alone_and_for_its_scripts_alone() {
        let folder = tempfile::tempdir().expect("a folder for the test");
        let file = folder.path().join("runs.zst");
        let modes = scripts().faults().expect("fault modes").faults;
        let all = drawn(&modes, 0);
        let basis = Basis {
            sha256: "a".into(),
            ..Basis::default()
        };
        let mut kept = KeptRuns::read(&file, &basis).expect("no file yet");
        let run = |number: usize| SuiteRun {
            not_passed: vec![number.to_string()],
            ..SuiteRun::default()
        };
        for (number, sample) in all.iter().enumerate().skip(1) {
            kept.put(sample, run(number));
        }
        kept.write(&file, &basis).expect("written");
        let mut read = KeptRuns::read(&file, &basis).expect("read");
        assert!(drawn(&modes, 1).iter().all(|other| !read.has(other)));
        assert_eq!(read.take(&all[0]), None);
        for (number, sample) in all.iter().enumerate().skip(1) {
            assert_eq!(read.take(sample), Some(run(number)), "{sample:?}");
        }
        assert!(KeptRuns::read(&file, &Basis::default()).is_err());
        let cut = std::fs::read(&file).expect("its bytes");
        std::fs::write(&file, &cut[..cut.len() / 2]).expect("cut short");
        assert!(KeptRuns::read(&file, &basis).is_err());
    }

    #[test]
    fn two_faults_of_a_unit_are_of_different_parts_and_assess_only() {
        let modes = scripts().faults().expect("fault modes").faults;
        let drawn = drawn(&modes, 0);
        let pairs: Vec<_> = drawn.iter().filter(|s| s.faults.len() == 2).collect();
        assert_eq!(pairs.len(), 40);
        for pair in pairs {
            assert_eq!(pair.purpose, Purpose::Assessment);
            assert_ne!(pair.faults[0].lru, pair.faults[1].lru);
        }
    }
}
