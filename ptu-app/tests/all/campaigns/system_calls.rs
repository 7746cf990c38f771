//! Acts of a program on its files and its output, in their order, as `strace` shows them.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};

/// Calls that change a file or a folder: SQLite writes with the second, all else with the first.
pub const CALLS: &str = "write,pwrite64,ftruncate,fsync,fdatasync,\
     unlink,unlinkat,link,linkat,rename,renameat,renameat2";
/// Longest text of a call that is shown whole, bytes.
const LONGEST: &str = "4000000";

/// One call of a program, ended.
#[derive(Debug)]
pub enum Deed {
    Write {
        file: PathBuf,
        at: usize,
        bytes: Vec<u8>,
    },
    Length {
        file: PathBuf,
        bytes: usize,
    },
    Sync {
        file: PathBuf,
    },
    Remove {
        file: PathBuf,
    },
    /// Another name for a file.
    Link {
        file: PathBuf,
        to: PathBuf,
    },
    Rename {
        file: PathBuf,
        to: PathBuf,
    },
    /// Writes to standard output.
    Says(Vec<u8>),
    /// Writes to standard error.
    Notes(Vec<u8>),
}

impl Deed {
    /// Whether it is something said, or acts on this folder.
    pub fn is_in(&self, folder: &Path) -> bool {
        match self {
            Self::Says(_) | Self::Notes(_) => true,
            Self::Write { file, .. }
            | Self::Length { file, .. }
            | Self::Sync { file }
            | Self::Remove { file }
            | Self::Link { file, .. }
            | Self::Rename { file, .. } => file.starts_with(folder),
        }
    }
}

/// `strace` of these calls with more options, and behind them a program as it would be started.
pub fn strace(options: &[&str], program: &Command) -> Command {
    let mut command = Command::new("strace");
    let calls = format!("trace={CALLS}");
    command.args(["-f", "-e", "signal=none", "-e", &calls]);
    command.args(options).arg("--");
    command.arg(program.get_program()).args(program.get_args());
    command.envs(
        program
            .get_envs()
            .filter_map(|(key, value)| Some((key, value?))),
    );
    command.current_dir(program.get_current_dir().expect("a folder"));
    command
}

/// Runs a program and gives how it ended and what it did; `folder` takes what it says and what strace writes.
pub fn traced(program: &Command, folder: &Path) -> (ExitStatus, Vec<Deed>) {
    // Named files, so that what its own children say is told from what it says.
    let [log, out, err] = ["calls", "out", "err"].map(|name| folder.join(name));
    let into = log.display().to_string();
    let options = ["-y", "-xx", "-s", LONGEST, "-o", &into];
    let made = |path| File::create(path).expect("a file");
    let mut traced = strace(&options, program);
    let status = traced.stdout(made(&out)).stderr(made(&err)).status();
    let status = status.expect("strace (Debian package strace) runs");
    let text = std::fs::read_to_string(log).expect("what strace wrote");
    let deeds = deeds(&text).into_iter().map(|deed| match deed {
        Deed::Write { file, bytes, .. } if file == out => Deed::Says(bytes),
        Deed::Write { file, bytes, .. } if file == err => Deed::Notes(bytes),
        deed => deed,
    });
    (status, deeds.collect())
}

fn deeds(log: &str) -> Vec<Deed> {
    let mut deeds = Vec::new();
    // First halves of calls that another thread interrupted, by thread.
    let mut begun = BTreeMap::new();
    // Where the next `write` to a file goes.
    let mut places = BTreeMap::new();
    for line in log.lines() {
        let Some((thread, call)) = line.split_once(' ') else {
            continue;
        };
        let call = call.trim_start();
        let whole = if let Some(first) = call.strip_suffix(" <unfinished ...>") {
            begun.insert(thread, first);
            continue;
        } else if let Some((_, second)) = call.split_once(" resumed>") {
            let Some(first) = begun.remove(thread) else {
                continue;
            };
            format!("{first}{second}")
        } else {
            call.to_owned()
        };
        deeds.extend(deed(&whole, &mut places));
    }
    deeds
}

/// One call with its arguments and result, as `write(5</a/b>, "\x41", 1) = 1`.
fn deed(call: &str, places: &mut BTreeMap<PathBuf, usize>) -> Option<Deed> {
    let (name, rest) = call.split_once('(')?;
    let (arguments, result) = rest.rsplit_once(" = ")?;
    let arguments = arguments.trim_end().strip_suffix(')')?;
    let result: usize = result.split_whitespace().next()?.parse().ok()?;
    let mut arguments = arguments.split(", ");
    if let kind @ ("unlink" | "link" | "rename") =
        name.trim_end_matches("at").trim_end_matches("at2")
    {
        let mut paths = arguments.filter(|text| text.starts_with('"'));
        let mut path = || Some(PathBuf::from(String::from_utf8(unhex(paths.next()?)).ok()?));
        let file = path()?;
        return Some(match kind {
            "unlink" => Deed::Remove { file },
            "link" => Deed::Link { file, to: path()? },
            _ => Deed::Rename { file, to: path()? },
        });
    }
    let first = arguments.next()?;
    let (_, file) = first.split_once('<')?;
    let file = PathBuf::from(String::from_utf8(unhex(file)).ok()?);
    match name {
        "write" | "pwrite64" => {
            let mut bytes = unhex(arguments.next()?);
            bytes.truncate(result);
            let at = match name {
                "write" => {
                    let place = places.entry(file.clone()).or_default();
                    std::mem::replace(place, *place + result)
                }
                _ => arguments.nth(1)?.parse().ok()?,
            };
            Some(Deed::Write { file, at, bytes })
        }
        "ftruncate" => {
            let bytes = arguments.next()?.parse().ok()?;
            Some(Deed::Length { file, bytes })
        }
        "fsync" | "fdatasync" => Some(Deed::Sync { file }),
        _ => None,
    }
}

/// Bytes of `"\x41\x42"`, also with dots behind it.
fn unhex(text: &str) -> Vec<u8> {
    let digits = text
        .split("\\x")
        .skip(1)
        .filter_map(|digits| digits.get(..2));
    let bytes = digits.map(|digits| u8::from_str_radix(digits, 16));
    bytes.collect::<Result<_, _>>().expect("hexadecimal digits")
}

#[test]
fn calls_are_read_as_they_are_shown() {
    let log = "\
7 write(5<\\x2f\\x61>, \"\\x41\\x42\", 2 <unfinished ...>
8 write(2<\\x70>, \"\\x68\\x69\", 2) = 2
7 <... write resumed>)              = 2
7 write(5<\\x2f\\x61>, \"\\x43\", 1)      = 1
8 fdatasync(5<\\x2f\\x61>)                = 0
8 ftruncate(5<\\x2f\\x61>, 10)            = 0
8 unlink(\"\\x2f\\x61\")            = 0
8 unlink(\"\\x2f\\x62\")            = -1 ENOENT (No such file or directory)
7 pwrite64(5<\\x2f\\x61>, \"\\x44\", 1, 7) = 1
7 linkat(AT_FDCWD, \"\\x2f\\x61\", AT_FDCWD, \"\\x2f\\x62\", 0) = 0
7 +++ exited with 0 +++
";
    let shown = format!("{:?}", deeds(log));
    let expected = "[Write { file: \"p\", at: 0, bytes: [104, 105] }, Write { file: \"/a\", at: 0, bytes: [65, 66] }, \
        Write { file: \"/a\", at: 2, bytes: [67] }, Sync { file: \"/a\" }, Length { file: \"/a\", bytes: 10 }, \
        Remove { file: \"/a\" }, Write { file: \"/a\", at: 7, bytes: [68] }, Link { file: \"/a\", to: \"/b\" }]";
    assert_eq!(shown, expected);
}
