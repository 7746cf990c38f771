//! One place with procedures and data files: a folder, or the program itself.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use crate::{DEEPEST_FOLDER, MOST_ENTRIES, ScriptsError};

/// Files of the program: name, with `/` between folders, and content.
type Embedded = &'static [(&'static str, &'static [u8])];

static EMBEDDED: OnceLock<Embedded> = OnceLock::new();

/// Takes the files embedded in the program, `FILES` of `scripts/embedded.rs`; every `main` begins with this call. No
/// library holds the files, so that no library is compiled again after an edit of a script.
pub fn embed(files: Embedded) {
    EMBEDDED.get_or_init(|| files);
}

/// The embedded files. Panics before [`embed`]: without files the program would say that each procedure is missing, and
/// not why.
fn embedded() -> Embedded {
    let files = EMBEDDED.get();
    files.expect("main calls script_files::embed before files are looked for")
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Layer {
    /// A folder on the disk.
    Folder(PathBuf),
    /// The files embedded in the program.
    Embedded,
}

/// A procedure or data file, on the disk or embedded.
#[derive(Clone, Debug)]
pub enum Found {
    /// A file on the disk.
    File(PathBuf),
    Embedded(&'static str, &'static [u8]),
}

/// Folder of the user's own procedures and data files; it may not exist. `None` for a user without a home.
pub fn own_folder() -> Option<PathBuf> {
    directories::ProjectDirs::from("", "", "ptu")
        .map(|directories| directories.data_dir().join("scripts"))
}

/// Folders for all users of this computer: first the depot's own, then those that a package installed.
pub(crate) fn system_folders() -> Vec<PathBuf> {
    if cfg!(windows) {
        let programs = std::env::var_os("ProgramData").map(PathBuf::from);
        return programs
            .map(|folder| folder.join("ptu").join("scripts"))
            .into_iter()
            .collect();
    }
    ["/etc/ptu/scripts", "/usr/share/ptu/scripts"]
        .map(PathBuf::from)
        .into()
}

impl Layer {
    pub(crate) fn file(&self, name: &str) -> Option<Found> {
        match self {
            Self::Folder(folder) => {
                let path = folder.join(name);
                path.exists().then_some(Found::File(path))
            }
            Self::Embedded => {
                let mut files = embedded().iter();
                let file = files.find(|(known, _)| *known == name);
                file.map(|&(name, bytes)| Found::Embedded(name, bytes))
            }
        }
    }

    /// Path that a file of this name has or would have in this place, to show.
    pub(crate) fn shown(&self, name: &str) -> String {
        match self {
            Self::Folder(folder) => folder.join(name).display().to_string(),
            Self::Embedded => format!("{name} (embedded)"),
        }
    }

    /// Names of the entries of a folder of this place, without those in its subfolders.
    pub(crate) fn names(&self, folder: &str) -> Vec<String> {
        match self {
            Self::Folder(root) => {
                let entries = std::fs::read_dir(root.join(folder)).into_iter();
                let entries = entries.flatten().flatten();
                entries
                    .filter_map(|entry| entry.file_name().into_string().ok())
                    .collect()
            }
            Self::Embedded => {
                let names = embedded().iter().filter_map(|(name, _)| {
                    let name = name.strip_prefix(folder)?.strip_prefix('/')?;
                    (!name.contains('/')).then(|| name.to_owned())
                });
                names.collect()
            }
        }
    }

    /// Every procedure and data file of this place, with its name.
    pub(crate) fn all(&self) -> Result<Vec<(String, Found)>, ScriptsError> {
        match self {
            Self::Folder(root) => {
                let mut collecting = Collecting {
                    root,
                    found: Vec::new(),
                    entries: 0,
                };
                collecting.collect(root, 0)?;
                Ok(collecting.found)
            }
            Self::Embedded => {
                let all = embedded().iter();
                let all = all.map(|&(name, bytes)| (name.to_owned(), Found::Embedded(name, bytes)));
                Ok(all.collect())
            }
        }
    }
}

impl fmt::Display for Layer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Folder(folder) => folder.display().fmt(f),
            Self::Embedded => f.write_str("embedded in the program"),
        }
    }
}

impl Found {
    /// Path of the file, or name of the embedded file, to show.
    pub fn shown(&self) -> String {
        match self {
            Self::File(path) => path.display().to_string(),
            Self::Embedded(name, _) => Layer::Embedded.shown(name),
        }
    }
}

pub(crate) fn too_many(place: &str) -> ScriptsError {
    ScriptsError::unreadable(
        place,
        format!("the scripts directory holds more than {MOST_ENTRIES} files and folders"),
    )
}

/// Search for the procedure and data files under a folder.
struct Collecting<'a> {
    root: &'a Path,
    found: Vec<(String, Found)>,
    entries: usize,
}

impl Collecting<'_> {
    fn collect(&mut self, folder: &Path, depth: usize) -> Result<(), ScriptsError> {
        let cannot = |why: &dyn fmt::Display| ScriptsError::unreadable(folder.display(), why);
        if depth > DEEPEST_FOLDER {
            return Err(cannot(
                &"too many folders within folders; does a link lead back?",
            ));
        }
        for entry in std::fs::read_dir(folder).map_err(|error| cannot(&error))? {
            let path = entry.map_err(|error| cannot(&error))?.path();
            self.entries += 1;
            if self.entries > MOST_ENTRIES {
                return Err(too_many(&folder.display().to_string()));
            }
            let ending = path.extension().and_then(|ending| ending.to_str());
            if path.is_dir() {
                self.collect(&path, depth + 1)?;
            } else if matches!(ending, Some("star" | "toml" | "zst"))
                || (ending == Some("json") && folder.ends_with("matrices"))
            {
                let name = path.strip_prefix(self.root).unwrap_or(&path);
                let name = name.to_string_lossy().replace('\\', "/");
                self.found.push((name, Found::File(path)));
            }
        }
        Ok(())
    }
}
