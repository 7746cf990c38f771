//! Chooses procedures by path or glob, and steps by glob.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use btu_rig::procedure::Procedure;
use btu_rig::procedure::loader::is_library;
use glob::Pattern;

use script_files::Layer;

use protocol::Random;

use crate::data::ScriptsDirectory;
use crate::failure::{Failure, RunTrouble, Unknown, did_you_mean};
use crate::whole_file;

/// Keeps the drawn order independent of what else is drawn by the same seed.
const ORDER_SEQUENCE: u64 = 0x0D1C_E0F5_7E95_A3C1;

/// Puts the items into an order drawn by the seed.
pub fn shuffle<T>(items: &mut [T], seed: u64) {
    let mut random = Random::new(seed ^ ORDER_SEQUENCE);
    for last in (1..items.len()).rev() {
        items.swap(last, random.below(last + 1));
    }
}

/// Puts procedures into the order in which their files were asked for; procedures of one file stay in theirs.
pub fn in_order(order: &[String], procedures: &mut [Arc<Procedure>]) {
    procedures.sort_by_key(|procedure| order.iter().position(|path| *path == procedure.path));
}

/// Texts of the scripts that were asked for, with all libraries, and the paths of these scripts in the order in which they
/// were asked for; no paths where all scripts are.
///
/// # Errors
/// A path or glob that names nothing, or a file that cannot be read.
pub fn scripts(
    directory: &ScriptsDirectory,
    asked: &[String],
) -> Result<(BTreeMap<String, String>, Vec<String>), Failure> {
    let all = directory.procedures()?;
    let mut order = Vec::new();
    if asked.is_empty() {
        return Ok((all, order));
    }
    let mut chosen: BTreeMap<_, _> = all
        .iter()
        .filter(|(path, _)| is_library(path))
        .map(clone_pair)
        .collect();
    for name in asked {
        let mut found = matching(directory, &all, name)?;
        if found.is_empty() {
            found.extend([outside(name, &all)?]);
        }
        order.extend(found.keys().cloned());
        chosen.extend(found);
    }
    Ok((chosen, order))
}

fn clone_pair((path, text): (&String, &String)) -> (String, String) {
    (path.clone(), text.clone())
}

fn matching(
    directory: &ScriptsDirectory,
    all: &BTreeMap<String, String>,
    name: &str,
) -> Result<BTreeMap<String, String>, Failure> {
    let wanted = under(directory, name);
    let pattern = Pattern::new(&wanted)
        .map_err(|error| Failure::usage(RunTrouble::Glob(name.to_owned(), error.to_string())))?;
    let matches = |path: &String| {
        let id = path.strip_suffix(".star").unwrap_or(path);
        !is_library(path)
            && (id == wanted || pattern.matches(id) || id.starts_with(&format!("{wanted}/")))
    };
    Ok(all
        .iter()
        .filter(|(path, _)| matches(path))
        .map(clone_pair)
        .collect())
}

/// The name without the scripts directory before it and `.star` behind it.
fn under(directory: &ScriptsDirectory, name: &str) -> String {
    let path = Path::new(name);
    let folders = directory.places().iter().filter_map(|place| match place {
        Layer::Folder(folder) => Some(folder.as_path()),
        Layer::Embedded => None,
    });
    let path = folders
        .chain([Path::new("scripts")])
        .find_map(|folder| path.strip_prefix(folder).ok())
        .unwrap_or(path);
    let text = path.to_string_lossy().replace('\\', "/");
    let text = text.trim_start_matches("./").trim_end_matches('/');
    text.strip_suffix(".star").unwrap_or(text).to_owned()
}

/// A script file outside the scripts directory.
fn outside(name: &str, all: &BTreeMap<String, String>) -> Result<(String, String), Failure> {
    let path = Path::new(name);
    if path.exists() {
        return Ok((name.to_owned(), whole_file::read(path)?));
    }
    let known: Vec<_> = all
        .keys()
        .filter(|p| !is_library(p))
        .map(|p| p.trim_end_matches(".star"))
        .collect();
    Err(Failure::usage(Unknown::Procedure(
        name.to_owned(),
        did_you_mean(name, known),
    )))
}

/// A glob over step names.
///
/// # Errors
/// The text is no glob.
pub fn step_pattern(glob: Option<&str>) -> Result<Option<Pattern>, Failure> {
    glob.map(Pattern::new).transpose().map_err(|error| {
        Failure::usage(RunTrouble::Glob(
            glob.unwrap_or_default().to_owned(),
            error.to_string(),
        ))
    })
}
