//! A disk whose power is cut: what was not synced is dropped, in part or as a whole, in any order, and torn anywhere.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use fuzzing::{amount, seed};
use protocol::Random;

use super::histories::{Base, Victim, victims};
use super::system_calls::{Deed, traced};

/// Bytes that a disk writes as a whole.
const SECTOR: usize = 512;

/// A file: what the disk has for sure, and what was asked of it since.
#[derive(Default)]
struct OnDisk {
    synced: Vec<u8>,
    asked: Vec<Asked>,
}

enum Asked {
    Write(usize, Vec<u8>),
    Length(usize),
}

impl Asked {
    fn apply(&self, content: &mut Vec<u8>) {
        match self {
            Self::Write(at, bytes) => {
                let end = at + bytes.len();
                content.resize(content.len().max(end), 0);
                content[*at..end].copy_from_slice(bytes);
            }
            Self::Length(bytes) => content.resize(*bytes, 0),
        }
    }
}

impl OnDisk {
    fn sync(&mut self) {
        let asked = std::mem::take(&mut self.asked);
        asked.iter().for_each(|asked| asked.apply(&mut self.synced));
    }

    /// Content after a power cut, if each sector and each length was written by this chance.
    fn after_cut(&self, chance: f64, random: &mut Random) -> Vec<u8> {
        let mut content = self.synced.clone();
        for asked in &self.asked {
            match asked {
                Asked::Write(at, bytes) => {
                    for (place, sector) in (*at..).step_by(SECTOR).zip(bytes.chunks(SECTOR)) {
                        let part = match random.unit() {
                            drawn if drawn < 0.9 * chance || chance == 1.0 => sector.len(),
                            drawn if drawn < chance => random.below(sector.len()),
                            _ => continue,
                        };
                        Asked::Write(place, sector[..part].to_vec()).apply(&mut content);
                    }
                }
                Asked::Length(_) if random.chance(chance) => asked.apply(&mut content),
                Asked::Length(_) => {}
            }
        }
        content
    }
}

/// Changes of a folder, whose order a file system keeps.
enum Entry {
    Named(PathBuf, usize),
    Gone(PathBuf),
    Renamed(PathBuf, PathBuf),
}

type Names = BTreeMap<PathBuf, usize>;

impl Entry {
    fn apply(&self, names: &mut Names) {
        match self {
            Self::Named(name, file) => {
                names.insert(name.clone(), *file);
            }
            Self::Gone(name) => {
                names.remove(name);
            }
            Self::Renamed(from, to) => {
                if let Some(file) = names.remove(from) {
                    names.insert(to.clone(), file);
                }
            }
        }
    }
}

/// A folder on a disk, and what the program said so far.
struct Disk {
    folder: PathBuf,
    files: Vec<OnDisk>,
    /// Files as the program sees them, and as the disk has them for sure.
    names: Names,
    synced: Names,
    asked: Vec<Entry>,
    said: Vec<u8>,
    noted: Vec<u8>,
}

impl Disk {
    fn of(folder: &Path) -> Self {
        let mut disk = Self {
            folder: folder.to_path_buf(),
            files: Vec::new(),
            names: Names::new(),
            synced: Names::new(),
            asked: Vec::new(),
            said: Vec::new(),
            noted: Vec::new(),
        };
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let name = entry.expect("an entry").path();
            if name.is_file() {
                disk.names.insert(name.clone(), disk.files.len());
                disk.files.push(OnDisk {
                    synced: std::fs::read(name).expect("a file"),
                    asked: Vec::new(),
                });
            }
        }
        disk.synced = disk.names.clone();
        disk
    }

    fn does(&mut self, deed: Deed) {
        match deed {
            Deed::Says(bytes) => self.said.extend(bytes),
            Deed::Notes(bytes) => self.noted.extend(bytes),
            Deed::Sync { file } if file == self.folder => {
                let synced = &mut self.synced;
                self.asked.drain(..).for_each(|entry| entry.apply(synced));
            }
            Deed::Sync { file } => {
                if let Some(at) = self.names.get(&file) {
                    self.files[*at].sync();
                    // A file that was made is there with its content; another name of it may not be.
                    let made = |entry: &Entry| matches!(entry, Entry::Named(_, of) if of == at);
                    if let Some(made) = self.asked.iter().position(made) {
                        self.asked.remove(made).apply(&mut self.synced);
                    }
                }
            }
            Deed::Write { file, at, bytes } => self.file(&file).asked.push(Asked::Write(at, bytes)),
            Deed::Length { file, bytes } => self.file(&file).asked.push(Asked::Length(bytes)),
            Deed::Remove { file } => self.names(Entry::Gone(file)),
            Deed::Rename { file, to } => self.names(Entry::Renamed(file, to)),
            Deed::Link { file, to } => {
                let at = self.names.get(&file).copied();
                at.into_iter()
                    .for_each(|at| self.names(Entry::Named(to.clone(), at)));
            }
        }
    }

    fn names(&mut self, entry: Entry) {
        entry.apply(&mut self.names);
        self.asked.push(entry);
    }

    fn file(&mut self, name: &Path) -> &mut OnDisk {
        let at = match self.names.get(name) {
            Some(at) => *at,
            None => {
                self.files.push(OnDisk::default());
                self.names(Entry::Named(name.to_path_buf(), self.files.len() - 1));
                self.files.len() - 1
            }
        };
        &mut self.files[at]
    }

    /// Writes what is left after a power cut into another folder.
    fn cut(&self, folder: &Path, chance: f64, random: &mut Random) {
        let _ = std::fs::remove_dir_all(folder);
        std::fs::create_dir(folder).expect("a folder");
        let mut names = self.synced.clone();
        for entry in self.asked.iter().take_while(|_| random.chance(chance)) {
            entry.apply(&mut names);
        }
        for (name, at) in names {
            let name = name.file_name().expect("a name");
            // In it processes that run find each other: nobody runs after a power cut.
            if name.to_string_lossy().ends_with("-shm") {
                continue;
            }
            let content = self.files[at].after_cut(chance, random);
            std::fs::write(folder.join(name), content).expect("written");
        }
    }
}

/// Goal: whenever the power is cut, the history opens, passes its checks, and holds all that the program told. Method: what
/// the program asks of its disk is recorded; before each sync, disks are made of what was synced until then and of none, all
/// and a random part of the rest.
#[test]
#[ignore = "long suite: a campaign of power cuts"]
fn a_power_cut_at_any_sync_loses_nothing_that_was_told() {
    let base = Base::new();
    let mut random = Random::new(seed());
    println!("program    syncs  states, each opened, checked and complete");
    for victim in victims(&base) {
        let place = base.copy();
        let mut disk = Disk::of(&place.path(""));
        let (status, deeds) = traced(&victim.command(&place), &base.path(""));
        assert_eq!(status.code(), Some(victim.exit_code), "{}", victim.name);
        let deeds = deeds.into_iter().filter(|deed| deed.is_in(&disk.folder));
        let deeds: Vec<_> = deeds.collect();
        let is_sync = |deed: &Deed| matches!(deed, Deed::Sync { .. });
        let syncs = deeds.iter().filter(|deed| is_sync(deed)).count();
        assert!(syncs > 0, "{}", victim.name);
        let every = (syncs / amount(2) as usize).max(1);
        let (mut sync, mut states) = (0, 0);
        for deed in deeds {
            sync += usize::from(is_sync(&deed));
            if is_sync(&deed) && sync % every == 0 {
                states += judge(&victim, &disk, &base, &mut random);
            }
            disk.does(deed);
        }
        states += judge(&victim, &disk, &base, &mut random);
        println!("{:10} {syncs:>5}  {states}", victim.name);
    }
}

/// Opens what is left after power cuts now; how many states that were.
fn judge(victim: &Victim, disk: &Disk, base: &Base, random: &mut Random) -> u64 {
    let chances = [0.0, 1.0, 0.1, 0.5, 0.9];
    let text = |bytes: &Vec<u8>| String::from_utf8_lossy(bytes).into_owned();
    let (said, noted) = (text(&disk.said), text(&disk.noted));
    for chance in chances {
        let left = base.path("left");
        disk.cut(&left, chance, random);
        let found = victim.judge(&left, &said, &noted);
        assert!(
            found.is_empty(),
            "{}: {found:#?}\nof what was not synced {chance} was written; told: {said}{noted}",
            victim.name
        );
    }
    chances.len() as u64
}
