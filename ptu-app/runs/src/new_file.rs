//! Writes all files that commands are told to write: each under a temporary name, renamed when it is complete, and never
//! over a database or over what this program did not write as that kind.

use std::fs::{File, OpenOptions};
use std::io::{BufWriter, ErrorKind, Read as _, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use fault_db::{AtomicFile, is_of_database, open_regular_file};

use crate::failure::{Failure, FileTrouble, Why};
use crate::platform;

/// Numbers tried for a free name beside one that is taken.
const BESIDE: u32 = 1000;

/// Bytes that tell what a file is.
const HEAD: u64 = 64;

/// Beginnings by which a file of one kind is known, spaces left out. A file of this kind replaces only a file that
/// begins so, or an empty one.
pub type Kind<'a> = &'a [&'a str];

/// The kinds of files that the program writes.
pub mod kind {
    use super::Kind;

    /// Pages.
    pub const HTML: Kind<'_> = &["<!DOCTYPEhtml"];
    /// Sheets of paper.
    pub const PDF: Kind<'_> = &["%PDF-"];
    /// Tables of runs, drives and traces.
    pub const CSV: Kind<'_> = &[
        "run,unit_serial,",
        "section,controller,",
        "t_s,x_m,",
        "time_s",
    ];
    /// Documents of runs, cases, comparisons and drives.
    pub const JSON: Kind<'_> = &[
        "{\"run\":{",
        "{\"document\":",
        "{\"run_a\":{",
        "{\"runs\":",
        "{\"line\":",
        "{\"cases\":",
    ];
    /// Results of tests.
    pub const JUNIT: Kind<'_> = &["<?xmlversion=\"1.0\"encoding=\"UTF-8\"?><testsuites"];
    /// Events of a run.
    pub const EVENTS: Kind<'_> = &["{\"seq\":0,\"event\":"];
    /// Signals and events of a run.
    pub const MCAP: Kind<'_> = &["\u{fffd}MCAP0"];
    /// Tables of columns.
    pub const PARQUET: Kind<'_> = &["PAR1"];
    /// Waveforms.
    pub const WAV: Kind<'_> = &["RIFF"];
    /// Pictures.
    pub const PNG: Kind<'_> = &["\u{fffd}PNG"];
    /// Dictionaries, compressed.
    pub const DICTIONARY: Kind<'_> = &["(\u{fffd}/\u{fffd}"];
    /// Runs that are kept.
    pub const RUNS: Kind<'_> = &["\u{fffd}PTURUN1"];
    /// Files that the program keeps for itself, at a place of its own.
    pub const OWN: Kind<'_> = &[""];
}

/// Beginning of a text, by which the kind of file is known: without byte-order mark and spaces.
pub fn head(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(&text[..text.len().min(HEAD as usize)]);
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    text.split_whitespace().collect()
}

/// A file being written beside its place: whatever stands there stays until the new one is whole. Dropped
/// before it is finished it leaves nothing behind.
#[derive(Debug)]
pub struct NewFile {
    file: BufWriter<File>,
    /// The temporary file; `None` once it has its own name.
    part: Option<AtomicFile>,
    place: PathBuf,
    heads: Vec<String>,
}

impl NewFile {
    /// Begins a file that is to stand at `place`, or beside what stands there: [`NewFile::finish_beside`].
    ///
    /// # Errors
    /// No file can be made in that folder.
    pub fn begin_beside(place: &Path) -> Result<Self, Failure> {
        match place.is_file() {
            true => Self::begin(&free_beside(place), kind::OWN),
            false => Self::begin(place, kind::OWN),
        }
        .map(|file| Self {
            place: place.to_path_buf(),
            ..file
        })
    }

    /// Begins a file of a kind that is to stand at `place`.
    ///
    /// # Errors
    /// The file at `place` cannot be replaced, or no file can be made in that folder.
    pub fn begin(place: &Path, kind: Kind<'_>) -> Result<Self, Failure> {
        let cannot = |why| Failure::usage(FileTrouble::Unwritten(place.display().to_string(), why));
        place.file_name().ok_or_else(|| cannot(Why::NoFileName))?;
        let folder = place
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty());
        if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
            return Err(cannot(Why::NoFolder(folder.display().to_string())));
        }
        let about = std::fs::metadata(place).ok();
        match &about {
            Some(about) if about.is_dir() => return Err(cannot(Why::Folder)),
            Some(about) if !about.is_file() => return Err(cannot(Why::NoFile)),
            _ => {}
        }
        // What a link leads to is replaced, not the link.
        let place = platform::real_path(place).unwrap_or_else(|_| place.to_path_buf());
        let heads: Vec<_> = kind.iter().map(|head| (*head).to_owned()).collect();
        may_replace(&place, &heads).map_err(cannot)?;
        if about.is_some() {
            // A file without write permission is not replaced either.
            let opened = OpenOptions::new().append(true).open(&place);
            opened.map_err(|error| cannot(Why::of(error)))?;
        }
        let part = AtomicFile::begin(&place).map_err(|error| cannot(Why::of(error)))?;
        let file = part.file().try_clone();
        let file = file.map_err(|error| cannot(Why::of(error)))?;
        if let Some(about) = about {
            file.set_permissions(about.permissions())
                .map_err(|error| cannot(Why::of(error)))?;
        }
        Ok(Self {
            file: BufWriter::new(file),
            part: Some(part),
            place,
            heads,
        })
    }

    /// As [`NewFile::begin`], where no file may exist yet.
    ///
    /// # Errors
    /// As [`NewFile::begin`]; or a file exists.
    pub fn begin_new(place: &Path, kind: Kind<'_>) -> Result<Self, Failure> {
        if place.exists() {
            return Err(Failure::usage(FileTrouble::Exists(
                place.display().to_string(),
            )));
        }
        Self::begin(place, kind)
    }

    /// Makes the file readable and writable by its owner only.
    ///
    /// # Errors
    /// The disk's.
    pub fn keep_to_owner(&self) -> Result<(), Failure> {
        platform::keep_to_owner(self.file.get_ref())
            .map_err(|error| cannot_write(&self.place, &error))
    }

    /// Makes sure that what was written so far is on the disk: only the file's name is missing then.
    ///
    /// # Errors
    /// The disk is full or gone.
    pub fn settle(&mut self) -> Result<(), Failure> {
        let done = (self.file.flush()).and_then(|()| self.file.get_ref().sync_all());
        done.map_err(|error| cannot_write(&self.place, &error))
    }

    /// Another writer at the same place in the file.
    ///
    /// # Errors
    /// The system gives none.
    pub fn writer(&self) -> Result<BufWriter<File>, Failure> {
        let file = self.file.get_ref().try_clone();
        file.map(BufWriter::new)
            .map_err(|error| cannot_write(&self.place, &error))
    }

    /// Puts the file in its place now, to grow there: for what is read while it is written, and what a kill must not lose.
    ///
    /// # Errors
    /// The disk is full or gone, or what stands there by now cannot be replaced.
    pub fn appear(&mut self) -> Result<(), Failure> {
        self.settle()?;
        let cannot = |why: &dyn std::fmt::Display| cannot_write(&self.place, why);
        let Some(part) = self.part.take() else {
            return Ok(());
        };
        may_replace(&self.place, &self.heads).map_err(|why| cannot(&why))?;
        part.replace().map_err(|error| cannot(&error))
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// As [`NewFile::appear`].
    pub fn finish(mut self) -> Result<(), Failure> {
        self.appear()
    }

    /// Puts the file in its place, or under a name beside it that is free (`sheet.pdf`, `sheet-2.pdf` …):
    /// nothing is replaced. Tells which it was.
    ///
    /// # Errors
    /// The disk is full or gone, or all names are taken.
    pub fn finish_beside(mut self) -> Result<PathBuf, Failure> {
        self.settle()?;
        let beside = (2..BESIDE).map(|number| numbered(&self.place, number));
        for name in std::iter::once(self.place.clone()).chain(beside) {
            let Some(part) = self.part.take() else {
                return Ok(name);
            };
            match part.publish_as(&name) {
                Ok(()) => return Ok(name),
                Err((error, part)) if error.kind() == ErrorKind::AlreadyExists => {
                    self.part = Some(part);
                }
                Err((error, _)) => return Err(cannot_write(&name, &error)),
            }
        }
        Err(not_written(&self.place, Why::Taken))
    }
}

impl Write for NewFile {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.file.flush()
    }
}

impl Seek for NewFile {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.file.seek(to)
    }
}

/// Finds out whether the file at `place`, if there is one, may be replaced by a file of the kind with these beginnings.
fn may_replace(place: &Path, heads: &[String]) -> Result<(), Why> {
    if is_of_database(place) {
        return Err(Why::History);
    }
    let mut found = Vec::new();
    if let Ok(file) = open_regular_file(place) {
        let read = file.take(HEAD).read_to_end(&mut found);
        read.map_err(Why::of)?;
    }
    let begins = head(&found);
    match found.is_empty() || heads.iter().any(|head| begins.starts_with(head)) {
        true => Ok(()),
        false => Err(Why::OtherKind),
    }
}

/// A free name: `place`, or `place` with a number as in [`NewFile::finish_beside`], for a file that appears while it is
/// written.
pub fn free_beside(place: &Path) -> PathBuf {
    let beside = (2..BESIDE).map(|number| numbered(place, number));
    let mut names = std::iter::once(place.to_path_buf()).chain(beside);
    let free = names.find(|name| !name.exists());
    free.unwrap_or_else(|| place.to_path_buf())
}

/// The failure of a file that broke off.
pub fn cannot_write(place: &Path, error: &dyn std::fmt::Display) -> Failure {
    not_written(place, Why::of(error))
}

fn not_written(place: &Path, why: Why) -> Failure {
    Failure::bench(FileTrouble::Unwritten(place.display().to_string(), why))
}

/// The name with a number before its ending.
fn numbered(path: &Path, number: u32) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_os_string();
    name.push(format!("-{number}"));
    if let Some(ending) = path.extension() {
        name.push(".");
        name.push(ending);
    }
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(place: &Path, text: &str) -> NewFile {
        let mut file = NewFile::begin(place, &["old", "new", "1"]).expect("begun");
        file.write_all(text.as_bytes()).expect("written");
        file
    }

    #[test]
    fn the_old_file_stays_until_the_new_one_is_complete() {
        let folder = tempfile::tempdir().expect("folder");
        let names = || std::fs::read_dir(folder.path()).expect("read").count();
        let (place, link) = (folder.path().join("a.json"), folder.path().join("b.json"));
        std::fs::write(&place, "old").expect("written");
        std::os::unix::fs::symlink(&place, &link).expect("linked");
        let mut mode = std::fs::metadata(&place).expect("there").permissions();
        std::os::unix::fs::PermissionsExt::set_mode(&mut mode, 0o640);
        std::fs::set_permissions(&place, mode).expect("set");
        let read = || std::fs::read_to_string(&place).expect("there");
        let mut given_up = written(&link, "half");
        given_up.settle().expect("on the disk");
        assert_eq!(read(), "old");
        drop(given_up);
        assert_eq!((read(), names()), ("old".to_owned(), 2));
        written(&link, "new").finish().expect("finished");
        assert_eq!((read(), names()), ("new".to_owned(), 2));
        assert!(link.is_symlink(), "a link is not replaced");
        let after = std::fs::metadata(&place).expect("there").permissions();
        let after = std::os::unix::fs::PermissionsExt::mode(&after) & 0o777;
        assert_eq!(after, 0o640, "who may read it is as before");
    }

    #[test]
    fn a_file_that_cannot_be_replaced_is_reported_before_writing() {
        let folder = tempfile::tempdir().expect("folder");
        let told = |place: &Path| {
            NewFile::begin(place, kind::OWN)
                .expect_err("refused")
                .to_string()
        };
        assert!(told(folder.path()).ends_with("it is a folder"));
        assert!(told(&folder.path().join("no/where.csv")).contains("there is no folder"));
        assert!(told(Path::new("/dev/full")).ends_with("it is no regular file"));
        let place = folder.path().join("a.csv");
        written(&place, "1").finish().expect("finished");
        let failure = NewFile::begin_new(&place, kind::CSV).expect_err("there already");
        assert!(failure.to_string().contains("--force"), "{failure}");
    }

    #[test]
    fn an_existing_file_is_not_overwritten_if_another_name_is_free() {
        let folder = tempfile::tempdir().expect("folder");
        let wanted = folder.path().join("trace.v2.csv");
        std::fs::write(&wanted, "of another kind").expect("written");
        let names: Vec<_> = (0..3)
            .map(|_| NewFile::begin_beside(&wanted).expect("begun"))
            .map(|file| file.finish_beside().expect("made"))
            .map(|path| path.file_name().expect("named").to_owned())
            .collect();
        assert_eq!(
            names,
            ["trace.v2-2.csv", "trace.v2-3.csv", "trace.v2-4.csv"]
        );
        assert_eq!(std::fs::read_dir(folder.path()).expect("read").count(), 4);
    }
}
