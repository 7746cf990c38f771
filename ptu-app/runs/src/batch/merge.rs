//! Shards put together, and what they lack.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use fault_db::read_regular_file;
use serde::Serialize;
use serde::de::IgnoredAny;

use super::file::MOST_BYTES;
use super::record::{Found, in_order};
use super::{Head, Shard};
use crate::failure::{Failure, FileTrouble, KeepTrouble, Why};

/// The runs of several files as one file.
pub struct Merged {
    /// The file's bytes: those of one process that made these runs alone.
    pub bytes: Vec<u8>,
    pub runs: usize,
    /// Runs of the plan.
    pub all: usize,
}

#[derive(Debug, PartialEq, Eq, Serialize)]
pub struct Missing {
    /// Description of the runs' plan, for people.
    pub what: String,
    /// Runs of the plan.
    pub runs: usize,
    /// Runs that no file has.
    pub missing: usize,
    pub shards: u32,
    /// The shards that lack runs.
    pub of_shards: Vec<ShardMissing>,
    /// Damage that was found.
    pub damage: Vec<String>,
}

#[derive(Debug, PartialEq, Eq, Serialize)]
pub struct ShardMissing {
    /// Number of the shard, from 1.
    pub shard: u32,
    pub runs: usize,
    /// Runs of the shard that no file has.
    pub missing: usize,
}

/// One file that was read.
struct Read {
    path: PathBuf,
    bytes: Vec<u8>,
    found: Found<IgnoredAny>,
}

impl Read {
    fn of(path: &Path) -> Result<Self, Failure> {
        let bytes = read_regular_file(path, MOST_BYTES)
            .map_err(|error| Failure::usage(FileTrouble::unread(path, error)))?;
        let found = Found::read(&bytes)
            .map_err(|why| Failure::usage(KeepTrouble::Again(path.display().to_string(), why)))?;
        Ok(Self {
            path: path.to_owned(),
            bytes,
            found,
        })
    }

    /// Refuses a file whose runs are of another maker or plan than the first file's.
    fn check(&self, first: &Path, head: &Head) -> Result<(), Failure> {
        let own = &self.found.head;
        let why = match head.other_maker(own) {
            Some(why) => Why::Said(why),
            None if own.plan == head.plan => return Ok(()),
            None => Why::OtherCampaign(own.plan.len(), own.plan.what.clone()),
        };
        Err(Failure::usage(KeepTrouble::Unlike(
            self.path.display().to_string(),
            why,
            first.display().to_string(),
            head.plan.what.clone(),
        )))
    }
}

/// Reads all files, whose runs have to be of one maker and plan.
fn read_all(files: &[PathBuf]) -> Result<(Head, Vec<Read>), Failure> {
    let mut all: Vec<Read> = Vec::with_capacity(files.len());
    for path in files {
        let read = Read::of(path)?;
        if let Some(first) = all.first() {
            read.check(&first.path, &first.found.head)?;
        }
        all.push(read);
    }
    let head = all
        .first()
        .map(|read| read.found.head.of_all())
        .ok_or_else(|| Failure::usage(KeepTrouble::NoFile))?;
    Ok((head, all))
}

/// Puts the runs of several files together. The order of the files, and files named twice, make no difference.
///
/// # Errors
/// A file cannot be read, is damaged, is of other runs than the first, or has another result for a run.
pub fn merge(files: &[PathBuf]) -> Result<Merged, Failure> {
    let (head, all) = read_all(files)?;
    let mut of_plan = BTreeMap::<String, Option<(&Path, &[u8])>>::new();
    for i in 0..head.plan.len() {
        of_plan.insert(head.plan.name(i), None);
    }
    for read in &all {
        if let Some(told) = read.found.told.first() {
            let file = read.path.display().to_string();
            return Err(Failure::usage(KeepTrouble::Cut(file, told.to_string())));
        }
        for (name, (_, at)) in &read.found.runs {
            let record = &read.bytes[at.clone()];
            match of_plan.get_mut(name) {
                Some(place @ None) => *place = Some((&read.path, record)),
                Some(Some((other, same))) if *same != record => {
                    return Err(Failure::usage(KeepTrouble::OtherResult(
                        read.path.display().to_string(),
                        name.clone(),
                        other.display().to_string(),
                    )));
                }
                _ => {}
            }
        }
    }
    let there = of_plan.iter();
    let there = there.filter_map(|(name, found)| found.map(|(_, record)| (name, record)));
    Ok(Merged {
        runs: there.clone().count(),
        bytes: in_order(&head, there),
        all: head.plan.len(),
    })
}

/// Runs that the files lack, by shard; `shards` = number of shards, none = as the files say.
///
/// # Errors
/// A file cannot be read, or is of other runs than the first.
pub fn missing(files: &[PathBuf], shards: Option<u32>) -> Result<Missing, Failure> {
    let (head, all) = read_all(files)?;
    let made_with = |read: &Read| read.found.head.shard.map(|shard| shard.of);
    let shards = shards
        .or_else(|| all.iter().find_map(made_with))
        .unwrap_or(1);
    let mut of_shards = BTreeMap::<u32, ShardMissing>::new();
    for i in 0..head.plan.len() {
        let name = head.plan.name(i);
        let is_there = all.iter().any(|read| read.found.runs.contains_key(&name));
        let shard = Shard::of_run(i, shards).number;
        let of_shard = of_shards.entry(shard).or_insert(ShardMissing {
            shard,
            runs: 0,
            missing: 0,
        });
        of_shard.runs += 1;
        of_shard.missing += usize::from(!is_there);
    }
    let damage = all.iter().flat_map(|read| {
        let told = |told: &String| format!("{}: {told}", read.path.display());
        read.found.told.iter().map(told)
    });
    Ok(Missing {
        what: head.plan.what.clone(),
        runs: head.plan.len(),
        missing: of_shards.values().map(|of_shard| of_shard.missing).sum(),
        shards,
        damage: damage.collect(),
        of_shards: of_shards
            .into_values()
            .filter(|of_shard| of_shard.missing > 0)
            .collect(),
    })
}
