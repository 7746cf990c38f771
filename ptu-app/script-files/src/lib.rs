//! The procedures and data files of the program: where they are looked for, and which file counts.
//!
//! A folder that is given, or one beside the program, is used alone. Else several places are laid over each other, file
//! by file: the user's own folder, the system's folders, and the files embedded in the program. This crate finds files
//! on the disk; the caller reads them.

mod place;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

pub use place::{Found, Layer, embed, own_folder};

/// Most files and folders in the places together.
const MOST_ENTRIES: usize = 100_000;
/// Deepest level of folders within folders that is searched.
const DEEPEST_FOLDER: usize = 16;

/// A place or a file that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ScriptsError {
    /// The path that was given is no folder.
    #[error("{} is not a directory", .0.display())]
    NotADirectory(PathBuf),
    /// A file or folder that cannot be read, and why.
    #[error("cannot read {what}: {why}")]
    Unreadable {
        /// Path of the file, or the name of an embedded file and "(embedded)".
        what: String,
        /// The operating system's reason, or one of this crate.
        why: String,
    },
}

impl ScriptsError {
    fn unreadable(what: impl ToString, why: impl ToString) -> Self {
        Self::Unreadable {
            what: what.to_string(),
            why: why.to_string(),
        }
    }
}

/// Where all procedures and data files are: a file is taken from the first place that has it.
#[derive(Clone, Debug)]
pub struct ScriptFiles(Vec<Layer>);

impl ScriptFiles {
    /// Places to look in: the folder `given`, alone; else `./scripts` or `scripts` beside or above the program, alone;
    /// else the user's own folder over the system's folders over the embedded files.
    ///
    /// # Errors
    /// `given` is no folder.
    pub fn find(given: Option<&Path>) -> Result<Self, ScriptsError> {
        if let Some(folder) = given {
            return match folder.is_dir() {
                true => Ok(Self(vec![Layer::Folder(folder.to_owned())])),
                false => Err(ScriptsError::NotADirectory(folder.to_owned())),
            };
        }
        let program = std::env::current_exe().unwrap_or_default();
        let beside = std::iter::once(Path::new("."))
            .chain(program.ancestors())
            .map(|place| place.join("scripts"))
            .find(|folder| folder.join("units").is_dir());
        Ok(match beside {
            Some(folder) => Self(vec![Layer::Folder(folder)]),
            None => Self::layered(own_folder().into_iter().chain(place::system_folders())),
        })
    }

    /// Places in this order: those of `folders` that exist, and last the embedded files.
    pub fn layered(folders: impl IntoIterator<Item = PathBuf>) -> Self {
        let folders = folders.into_iter().filter(|folder| folder.is_dir());
        Self(
            folders
                .map(Layer::Folder)
                .chain([Layer::Embedded])
                .collect(),
        )
    }

    /// The places; the first place that has a file wins.
    pub fn places(&self) -> &[Layer] {
        &self.0
    }

    /// The file of this name, as `units/sg100.toml`, from the first place that has it.
    pub fn file(&self, name: &str) -> Option<Found> {
        self.files(name).next()
    }

    /// Path of the file of this name, to show; if no place has the file, its path in the first place.
    pub fn shown(&self, name: &str) -> String {
        let missing = || self.0[0].shown(name);
        self.file(name).map_or_else(missing, |found| found.shown())
    }

    /// Every file of this name; the file of the first place comes first.
    pub fn files(&self, name: &str) -> impl Iterator<Item = Found> {
        self.0.iter().filter_map(move |place| place.file(name))
    }

    /// Names of the files that make up the fault catalogue: `units/faults.toml` and each `faults/NAME.toml`.
    pub fn catalogue(&self) -> Vec<String> {
        let further = self.names("faults", "toml").into_iter();
        let further = further.map(|name| format!("faults/{name}.toml"));
        std::iter::once("units/faults.toml".to_owned())
            .chain(further)
            .collect()
    }

    /// Names, without folder and ending, of the files `FOLDER/NAME.ENDING` of all places.
    pub fn names(&self, folder: &str, ending: &str) -> BTreeSet<String> {
        let files = self.0.iter().flat_map(|place| place.names(folder));
        let names = files.filter_map(|name| {
            let name = name.strip_suffix(ending)?.strip_suffix('.')?;
            Some(name.to_owned())
        });
        names.collect()
    }

    /// Every procedure and data file by its name, each from the first place that has it.
    ///
    /// # Errors
    /// A folder cannot be read, or holds too many files.
    pub fn all(&self) -> Result<BTreeMap<String, Found>, ScriptsError> {
        let mut all = BTreeMap::new();
        for place in &self.0 {
            for (name, found) in place.all()? {
                all.entry(name).or_insert(found);
            }
            if all.len() > MOST_ENTRIES {
                return Err(place::too_many(&self.0[0].to_string()));
            }
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests;
