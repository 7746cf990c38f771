//! Parts shared by end-to-end tests: a place of its own for each test, and the program run in it.

#![allow(dead_code, reason = "each of the test programs uses its part")]

pub mod made_elsewhere;
pub mod made_plans;
pub mod made_runs;
pub mod proxy;
pub mod served;
pub mod terminal;
pub mod told;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use ptu_runs::data::ScriptsDirectory;
use serde_json::Value;
use tempfile::TempDir;

/// Keys that differ between two runs of one seed: identities, times of day, and wall time.
#[rustfmt::skip]
const OF_ONE_RUN: [&str; 8] = [
    "id", "trace_id", "seal", "started_at", "finished_at", "first_at", "last_at", "wall_time_s",
];

/// The history of [`record_bad_unit`].
static BAD_UNIT: OnceLock<Vec<u8>> = OnceLock::new();

/// A folder of its own with a database of its own; the user's data are never touched.
pub struct Place {
    folder: TempDir,
}

/// Text behind the name of a program.
pub trait Typed {
    /// The arguments, one by one.
    fn words(&self) -> Vec<String>;
}

/// One line, in which `'…'` is one word.
impl Typed for str {
    fn words(&self) -> Vec<String> {
        shlex::split(self).expect("each quote has its end")
    }
}

impl Typed for String {
    fn words(&self) -> Vec<String> {
        self.as_str().words()
    }
}

impl Typed for [&str] {
    fn words(&self) -> Vec<String> {
        self.iter().map(|&word| word.to_owned()).collect()
    }
}

impl<const N: usize> Typed for [&str; N] {
    fn words(&self) -> Vec<String> {
        self.as_slice().words()
    }
}

impl<T: AsRef<str>> Typed for Vec<T> {
    fn words(&self) -> Vec<String> {
        let each = self.iter();
        each.map(|word| word.as_ref().to_owned()).collect()
    }
}

/// Output of a program, and its exit code.
pub struct Said {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl Place {
    pub fn new() -> Self {
        Self {
            folder: TempDir::with_prefix("ptu-test-").expect("a folder for the test"),
        }
    }

    /// One with the history of a bad unit.
    pub fn with_bad_unit() -> Self {
        let place = Self::new();
        record_bad_unit(&place);
        place
    }

    /// One with a database in which nothing is recorded.
    pub fn with_database() -> Self {
        let place = Self::new();
        place.make_history();
        place
    }

    /// Makes a history in which nothing is recorded.
    pub fn make_history(&self) {
        let made = fault_db::Store::open(&self.path("history.db"), ptu_runs::clock::open_options());
        made.and_then(fault_db::Store::close).expect("a database");
    }

    /// Changes a history behind the program's back.
    #[track_caller]
    pub fn change(&self, file: &str, sql: &str) {
        let opened = rusqlite::Connection::open(self.path(file)).expect("a database");
        opened.execute_batch(sql).expect("a change");
    }

    /// A file or folder of this name in the place.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn text_path(&self, name: &str) -> String {
        self.path(name).display().to_string()
    }

    /// A scripts directory that holds no procedure and no data: sheets have no diagnosis.
    pub fn no_scripts(&self) -> ScriptsDirectory {
        let empty = self.path("empty");
        std::fs::create_dir(&empty).expect("a folder");
        ScriptsDirectory::find(Some(&empty)).expect("a folder")
    }

    /// Writes a file, for its owner alone, and gives its path.
    pub fn write(&self, name: &str, text: &str) -> String {
        std::fs::write(self.path(name), text).expect("a file for the test");
        keep_to_owner(&self.path(name));
        self.text_path(name)
    }

    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).expect("a file the program wrote")
    }

    pub fn read_json(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).expect("JSON")
    }

    /// `ptu` with these arguments, not started yet.
    pub fn command(&self, arguments: &(impl Typed + ?Sized)) -> Command {
        let mut command = Command::new(program("ptu"));
        command
            .args(arguments.words())
            .current_dir(self.folder.path())
            .env("PTU_SCRIPTS", scripts())
            .env("PTU_DB", self.path("history.db"))
            .env("HOME", self.folder.path())
            .env("XDG_DATA_HOME", self.folder.path())
            .env("LC_ALL", "C.UTF-8")
            .env("RUST_BACKTRACE", "1");
        command
    }

    pub fn ptu(&self, arguments: &(impl Typed + ?Sized)) -> Said {
        let output = self.command(arguments).output().expect("ptu starts");
        Said::from(output)
    }

    /// Answer of `ptu` where a variable of the environment is set.
    pub fn ptu_where(
        &self,
        (name, value): (&str, &(impl AsRef<OsStr> + ?Sized)),
        arguments: &(impl Typed + ?Sized),
    ) -> Said {
        let output = self.command(arguments).env(name, value).output();
        output.expect("ptu starts").into()
    }

    /// Steps of the latest run that are recorded so far; none while there is no run.
    pub fn steps_so_far(&self) -> Vec<Value> {
        let shown = self.ptu("runs show latest --json");
        let run: Value = serde_json::from_str(&shown.out).unwrap_or_default();
        run["steps"].as_array().cloned().unwrap_or_default()
    }

    /// Answer of the place's shell to this line, in which `ptu` is the program.
    pub fn shell(&self, line: &str) -> Said {
        let ptu = self.command("");
        let envs = ptu.get_envs();
        let mut paths = vec![program("ptu").parent().expect("its folder").to_owned()];
        let path = std::env::var_os("PATH").expect("a path");
        paths.extend(std::env::split_paths(&path));
        let mut shell = Command::new("sh");
        let said = shell
            .args(["-c", line])
            .current_dir(self.folder.path())
            .envs(envs.filter_map(|(name, value)| Some((name, value?))))
            .env("PATH", std::env::join_paths(paths).expect("folders"))
            .output();
        said.expect("sh starts").into()
    }

    /// The one JSON document a question is answered with.
    pub fn json(&self, arguments: &(impl Typed + ?Sized)) -> Value {
        let said = self.ptu(arguments).exits(0);
        serde_json::from_str(&said.out).expect("one JSON document on stdout")
    }

    /// Runs procedures and gives exit code and report.
    pub fn run(&self, arguments: &(impl Typed + ?Sized)) -> (Said, Value) {
        let mut all = ["run", "--report", "report.json"].words();
        all.extend(arguments.words());
        let said = self.ptu(&all);
        assert!(
            self.path("report.json").is_file(),
            "no report was written\n{}",
            said.all()
        );
        (said, self.read_json("report.json"))
    }

    /// Records a short run and gives its id.
    pub fn recorded_run(&self) -> String {
        self.ptu("run tcms/link").exits(0);
        text(&self.json("runs show latest --json")["run"]["id"]).to_owned()
    }

    /// Ids of all recorded runs, newest first.
    pub fn run_ids(&self) -> Vec<String> {
        let runs = self.json("runs list --json");
        list(&runs)
            .iter()
            .map(|run| text(&run["id"]).to_owned())
            .collect()
    }
}

impl From<Output> for Said {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).expect("UTF-8 on stdout"),
            err: String::from_utf8(output.stderr).expect("UTF-8 on stderr"),
        }
    }
}

impl Said {
    /// Everything, for a message.
    pub fn all(&self) -> String {
        let Self { code, out, err } = self;
        format!("exit {code:?}\n--- stdout\n{out}--- stderr\n{err}")
    }

    /// Holds the program to an exit code, and to never panicking.
    #[track_caller]
    pub fn exits(self, code: i32) -> Self {
        for word in ["panicked", "RUST_BACKTRACE", "stack backtrace"] {
            assert!(!self.err.contains(word), "{}", self.all());
        }
        assert_eq!(self.code, Some(code), "{}", self.all());
        self
    }

    /// Holds the program to words on stdout.
    #[track_caller]
    pub fn prints(self, words: &[&str]) -> Self {
        self.holds(&self.out, words);
        self
    }

    /// Holds the program to words on stderr: the thing that is wrong, and the next move.
    #[track_caller]
    pub fn explains(self, words: &[&str]) -> Self {
        self.holds(&self.err, words);
        self
    }

    #[track_caller]
    fn holds(&self, text: &str, words: &[&str]) {
        if let Some(word) = words.iter().find(|word| !text.contains(**word)) {
            panic!("\"{word}\" is not said\n{}", self.all());
        }
    }
}

/// A unit with a slow relay, tested by someone. The first history of a place is a copy of one that is recorded once
/// per test program, so that its identities are the same in all places.
pub fn record_bad_unit(place: &Place) {
    let path = place.path("history.db");
    if path.exists() {
        return record_bad_unit_anew(place);
    }
    let history = BAD_UNIT.get_or_init(|| {
        let place = Place::new();
        record_bad_unit_anew(&place);
        let whole = place.path("history.db-wal").metadata();
        assert!(whole.map_or(true, |wal| wal.len() == 0), "it is closed");
        std::fs::read(place.path("history.db")).expect("a history")
    });
    std::fs::write(&path, history).expect("copied");
    keep_to_owner(&path);
}

fn keep_to_owner(_path: &Path) {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        let of_owner = std::fs::Permissions::from_mode(0o600);
        std::fs::set_permissions(_path, of_owner).expect("its owner's alone");
    }
}

/// Records the bad unit in a run of its own, for tests that compare or join the histories of two
/// places.
pub fn record_bad_unit_anew(place: &Place) {
    let who = ["--serial-no", "BAD-1", "--who", "Kim"];
    let arguments = [
        &["run", "atp/overspeed", "--inject", "eb_relay.slow"],
        &who[..],
    ]
    .concat();
    place.ptu(&arguments).exits(1);
}

/// The fault of the relay in this database.
pub fn relay_fault(place: &Place) -> Value {
    let faults = place.json("faults list --part eb_relay --json");
    assert_eq!(list(&faults).len(), 1, "{faults}");
    faults[0].clone()
}

/// The scripts directory of the workspace.
pub fn scripts() -> PathBuf {
    workspace().join("scripts")
}

/// The folder of the repository: this one, whichever crate's tests run.
pub fn workspace() -> &'static Path {
    let mut above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let top = above.find(|folder| folder.join("Cargo.lock").is_file());
    top.expect("the workspace")
}

/// A program of the workspace, built beside the running test program.
pub fn program(name: &str) -> PathBuf {
    let test = std::env::current_exe().expect("a test program");
    let built = test.ancestors().nth(2).expect("the folder of the build");
    let program = built
        .join(name)
        .with_extension(std::env::consts::EXE_EXTENSION);
    assert!(
        program.is_file(),
        "{} is not built: build the workspace",
        program.display()
    );
    program
}

/// Puts `ptu` somewhere else: the same file by another name, or, on another disk, a copy that another process makes. A
/// program that this process has open to write cannot start, and what another test starts meanwhile has all that is
/// open here.
pub fn install(to: &Path) {
    let built = program("ptu");
    if std::fs::hard_link(&built, to).is_err() {
        let copied = Command::new("cp").arg(&built).arg(to).status();
        assert!(copied.expect("cp starts").success());
    }
}

/// Copies a folder with all in it over another.
pub fn copy_folder(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a folder");
    for entry in std::fs::read_dir(from).expect("a folder") {
        let entry = entry.expect("an entry");
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy_folder(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).expect("copied");
        }
    }
}

/// The report without what may differ between two runs of one seed.
pub fn normalised(mut report: Value) -> Value {
    fn strip(value: &mut Value) {
        match value {
            Value::Object(entries) => {
                for key in &OF_ONE_RUN {
                    entries.remove(*key);
                }
                entries.values_mut().for_each(strip);
            }
            Value::Array(items) => items.iter_mut().for_each(strip),
            _ => {}
        }
    }
    strip(&mut report);
    report
}

/// Holds a text to words.
#[track_caller]
pub fn has(text: &str, words: &[&str]) {
    for word in words {
        assert!(text.contains(word), "no \"{word}\"\n{text}");
    }
}

#[track_caller]
pub fn list(value: &Value) -> &[Value] {
    let Some(items) = value.as_array() else {
        panic!("not a list: {value}")
    };
    items
}

#[track_caller]
pub fn text(value: &Value) -> &str {
    let Some(text) = value.as_str() else {
        panic!("not a text: {value}")
    };
    text
}

#[track_caller]
pub fn number(value: &Value) -> f64 {
    let Some(number) = value.as_f64() else {
        panic!("not a number: {value}")
    };
    number
}

/// Holds an object to keys and the kinds of their values: `text`, `number`, `list`, `bool`, with
/// `?` behind where it may be null.
#[track_caller]
pub fn has_shape(value: &Value, keys: &[(&str, &str)]) {
    for (key, kind) in keys {
        let Some(found) = value.get(key) else {
            panic!("no key \"{key}\" in {value}")
        };
        let fits = match kind.trim_end_matches('?') {
            "text" => found.is_string(),
            "number" => found.is_number(),
            "list" => found.is_array(),
            "bool" => found.is_boolean(),
            other => panic!("no kind \"{other}\""),
        };
        assert!(
            fits || (kind.ends_with('?') && found.is_null()),
            "\"{key}\" is no {kind} in {value}"
        );
    }
}

/// Three plain words in a row, but for the signs of a condition: `lamps without failure`.
pub fn is_english(text: &str) -> bool {
    let is_plain = |word: &str| {
        let word = word
            .trim_end_matches([',', '.', ':', ';', ')'])
            .trim_start_matches('(');
        word.len() > 1
            && !["with", "without"].contains(&word)
            && word
                .chars()
                .all(|c| c.is_ascii_lowercase() || c == '\'' || c == '-')
    };
    let words: Vec<_> = text.split_whitespace().collect();
    words
        .windows(3)
        .any(|words| words.iter().all(|word| is_plain(word)))
}
