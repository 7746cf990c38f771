//! `ptu key`: keys that runs are signed with, and the list of those that are trusted.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use serde_json::json;

use super::signing::PinOption;
use super::{Json, print_out};
use ptu_report::words::{Words, fill};
use ptu_runs::clock;
use ptu_runs::failure::{Asked, Exit, Failure, KeyTrouble, Unknown, did_you_mean};
use ptu_runs::keys::{
    KeyEntry, KeyFile, KeyList, NewKey, Standing, TRUSTED, day_argument, day_of, day_text, located,
    name_argument, own_folder, public_name, sought,
};
use ptu_runs::owner_only;
use ptu_runs::table::Table;
use ptu_runs::whole_file;

/// Years for which a new key holds.
const YEARS: u32 = 2;

/// Make keys that runs are signed with, and keep the list of those that are trusted
///
/// Examples:
///   ptu key new --who Kim                       a technician's key, protected by a PIN
///   ptu key new --who "bench 3" --for-bench --pin-file pin.txt
///   ptu key trust kim.pub                       puts a public key into this computer's list
///   ptu key revoke Kim --note "laptop lost"     from today on the key signs nothing more
///   ptu key list                                lists the trusted keys and their files
///
/// A file that is named without a folder is looked up in the current folder, then in the folder `keys` of the user's data
/// directory, where `ptu key new` writes.
///
/// Exit codes: 0 done, 2 no such key, or a key that is there already, 3 a file that cannot be read.
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct KeyArguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Make a key: a private key file, protected by a PIN, and beside it a `.pub` file to hand to others
    New {
        /// Name under which the key signs
        #[arg(long, value_name = "TEXT", value_parser = name_argument)]
        who: String,
        /// The key belongs to a bench, not to a technician
        #[arg(long)]
        for_bench: bool,
        /// The private key's file [default: in the folder `keys` of the user's data directory]
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
        /// First day on which the key is no longer valid, as 2028-11-26 [default: in two years]
        #[arg(long, value_name = "DAY", value_parser = day_argument)]
        until: Option<String>,
        #[command(flatten)]
        pin: PinOption,
    },
    /// List the trusted keys, how each stands today, and the files that hold it
    List {
        #[command(flatten)]
        keys: KeysOption,
        #[command(flatten)]
        json: Json,
    },
    /// Put the public keys of a file into the list of those that are trusted
    Trust {
        /// A `.pub` file, or another list
        #[arg(value_name = "FILE")]
        file: PathBuf,
        #[command(flatten)]
        keys: KeysOption,
    },
    /// Revoke a key from today on; what the key signed before stays valid
    Revoke {
        /// Whose key, or the beginning of the key (at least 4 digits)
        #[arg(value_name = "NAME|KEY")]
        key: String,
        /// Why the key is revoked
        #[arg(long, value_name = "TEXT", default_value = "")]
        note: String,
        #[command(flatten)]
        keys: KeysOption,
    },
}

/// Option that names the list of trusted public keys.
#[derive(Debug, Default, Args)]
pub struct KeysOption {
    /// List of trusted public keys: a file, or a folder with `.pub` and `.keys` files [default: the folder `keys` of the
    /// user's data directory]
    #[arg(long, value_name = "FILE|DIR", env = "PTU_KEYS")]
    keys: Option<PathBuf>,
}

impl KeysOption {
    fn place(&self) -> Result<PathBuf, Failure> {
        self.keys
            .as_deref()
            .map_or_else(own_folder, |named| Ok(located(named)))
    }

    /// The list of trusted keys; empty where nobody has made one.
    ///
    /// # Errors
    /// The list that was named does not exist, or a list cannot be read.
    pub fn read(&self) -> Result<KeyList, Failure> {
        let place = self.place()?;
        match (place.exists(), self.keys.is_some()) {
            (false, false) => Ok(KeyList::default()),
            (false, true) => Err(Failure::usage(KeyTrouble::NoList(sought(&place)))),
            (true, _) => KeyList::read(&place),
        }
    }

    /// Adds or changes a key in the list's file (in a folder `trusted.keys`). Returns the key's entry, and the file.
    fn change(&self, entry: KeyEntry) -> Result<(KeyEntry, PathBuf), Failure> {
        let place = self.place()?;
        let is_folder = place.is_dir() || self.keys.is_none();
        let file = match is_folder {
            true => place.join(TRUSTED),
            false => place,
        };
        owner_only::folder_of(&file)?;
        let mut list = match file.exists() {
            true => KeyList::read(&file)?,
            false => KeyList::default(),
        };
        let stands = list.add(entry).map_err(Failure::usage)?;
        whole_file::write_text(&file, list.text())?;
        Ok((stands, file))
    }
}

impl KeyArguments {
    pub fn run(self) -> Result<Exit, Failure> {
        match self.verb {
            Verb::New {
                who,
                for_bench,
                out,
                until,
                pin,
            } => new(&who, for_bench, out, until, &pin),
            Verb::List { keys, json } => list(&keys, json),
            Verb::Trust { file, keys } => trust(&file, &keys),
            Verb::Revoke { key, note, keys } => revoke(&key, note.trim(), &keys),
        }
    }
}

fn new(
    who: &str,
    bench: bool,
    out: Option<PathBuf>,
    until: Option<String>,
    pin: &PinOption,
) -> Result<Exit, Failure> {
    let path = match out {
        Some(path) => path,
        None => own_folder()?.join(format!("{}.key", file_name(who))),
    };
    owner_only::folder_of(&path)?;
    for there in [path.clone(), public_name(&path)] {
        if there.exists() {
            return Err(Failure::usage(Asked::KeyStays(there.display().to_string())));
        }
    }
    let now = clock::now_us();
    let key = NewKey {
        who,
        kind: if bench { "bench" } else { "technician" },
        from: day_of(now),
        until: until.or_else(|| Some(day_text(now, YEARS))),
    };
    let entry = key.write(&path, &pin.choose()?)?;
    print_out(&format!(
        "key {} of {who} ({}), valid {}\n  private: {}; keep it and its PIN to yourself, and keep a copy\n  public:  {}; \
         hand it to whoever keeps the list: `ptu key trust`\nto sign: ptu run --key {}",
        entry.short(),
        entry.kind,
        span(&entry),
        path.display(),
        public_name(&path).display(),
        path.display(),
    ))
}

/// Name of a key's file: lower-case letters and digits of the person's name, all else a hyphen.
fn file_name(who: &str) -> String {
    let letter = |c: char| if c.is_alphanumeric() { c } else { '-' };
    who.to_lowercase().chars().map(letter).collect()
}

fn span(entry: &KeyEntry) -> String {
    let terminal = &Words::shown().terminal;
    match &entry.until {
        Some(until) => fill(
            terminal.key_until,
            &[("from", &entry.from), ("until", until)],
        ),
        None => fill(terminal.key_from, &[("from", &entry.from)]),
    }
}

fn list(keys: &KeysOption, json: Json) -> Result<Exit, Failure> {
    let list = keys.read()?;
    let files = FilesOfKeys::of(&keys.place()?)?;
    let now = clock::now_us();
    let document = || {
        let entry = |entry: &KeyEntry| {
            json!({
                "who": entry.who, "kind": entry.kind, "key": entry.key, "from": entry.from, "until": entry.until,
                "revoked": entry.revoked, "reason": entry.reason, "valid": entry.standing(now).is_good(),
                "files": files.paths(entry),
            })
        };
        list.keys.iter().map(entry).collect::<Vec<_>>()
    };
    json.answer(document, || table(&list, &files, now))
}

/// Files that hold each key, by the key; the file of the private key comes first.
struct FilesOfKeys(BTreeMap<String, Vec<String>>);

impl FilesOfKeys {
    fn of(place: &Path) -> Result<Self, Failure> {
        let mut files: BTreeMap<String, Vec<String>> = BTreeMap::new();
        let there = place.exists().then(|| KeyList::files(place)).transpose()?;
        for file in there.unwrap_or_default() {
            let private = file.with_extension("key");
            let own = (private.is_file().then(|| KeyFile::read(&private).ok())).flatten();
            for entry in KeyList::read(&file)?.keys {
                let of_key = files.entry(entry.key.clone()).or_default();
                if (own.as_ref()).is_some_and(|own| own.entry().key == entry.key) {
                    of_key.insert(0, private.display().to_string());
                }
                of_key.push(file.display().to_string());
            }
        }
        Ok(Self(files))
    }

    fn paths(&self, entry: &KeyEntry) -> &[String] {
        self.0.get(&entry.key).map_or(&[], Vec::as_slice)
    }
}

fn table(list: &KeyList, files: &FilesOfKeys, now: i64) -> String {
    let words = Words::shown();
    let (terminal, life) = (&words.terminal, &words.life);
    if list.keys.is_empty() {
        return terminal.no_keys.into();
    }
    let mut table = Table::headed(&[
        terminal.who,
        terminal.kind,
        terminal.key,
        life.from,
        life.until,
        terminal.today,
    ]);
    for entry in &list.keys {
        let today = match entry.standing(now) {
            Standing::Held => terminal.valid.to_owned(),
            standing => standing.text(),
        };
        table.row([
            entry.who.clone(),
            entry.kind.clone(),
            entry.short().to_owned(),
            entry.from.clone(),
            entry.until.clone().unwrap_or_default(),
            match &entry.reason {
                Some(reason) if !reason.is_empty() => format!("{today}: {reason}"),
                _ => today,
            },
        ]);
    }
    let mut text = table.render();
    for entry in &list.keys {
        let of = [("key", &entry.short() as _), ("who", &entry.who as _)];
        text += &format!("\n\n{}", fill(terminal.key_of, &of));
        for path in files.paths(entry) {
            text += &format!("\n  {path}");
        }
    }
    text
}

fn trust(file: &Path, keys: &KeysOption) -> Result<Exit, Failure> {
    let found = located(file);
    if !found.exists() {
        return Err(Failure::usage(KeyTrouble::NoPublicFile(sought(file))));
    }
    let new = KeyList::read(&found)?;
    if new.keys.is_empty() {
        return Err(Failure::usage(Asked::NoKeyIn(file.display().to_string())));
    }
    let mut said = Vec::new();
    for entry in new.keys {
        let (entry, to) = keys.change(entry)?;
        said.push(fill(
            Words::shown().terminal.key_trusted,
            &[
                ("who", &entry.name()),
                ("key", &entry.short()),
                ("span", &span(&entry)),
                ("file", &to.display()),
            ],
        ));
    }
    print_out(&said.join("\n"))
}

fn revoke(asked: &str, note: &str, keys: &KeysOption) -> Result<Exit, Failure> {
    let list = keys.read()?;
    let found: Vec<&KeyEntry> = list.named(asked).collect();
    let entry = match found[..] {
        [entry] => entry.clone(),
        [] => {
            let hint = did_you_mean(asked, list.keys.iter().map(|entry| entry.who.as_str()));
            return Err(Failure::usage(Unknown::Key(asked.to_owned(), hint)));
        }
        _ => {
            return Err(Failure::usage(Asked::KeysAlike(
                found.len(),
                asked.to_string(),
            )));
        }
    };
    let (who, key) = (entry.who.clone(), entry.short().to_owned());
    let today = day_of(clock::now_us());
    let (_, to) = keys.change(KeyEntry {
        revoked: Some(entry.revoked.clone().unwrap_or(today.clone())),
        reason: Some(note.to_owned()).filter(|note| !note.is_empty()),
        ..entry
    })?;
    print_out(&fill(
        Words::shown().terminal.key_revoked,
        &[
            ("day", &today),
            ("key", &key),
            ("who", &who),
            ("file", &to.display()),
        ],
    ))
}
