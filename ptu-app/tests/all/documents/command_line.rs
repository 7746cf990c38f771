//! Command lines of documents: their words, and what is wrong with them by the programs' own arguments.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Parser;
use clap::error::ErrorKind;
use ptu_app::cli::Cli;

use super::root;

/// A command line of a document, and the exit code it is to end with.
#[derive(Debug)]
pub(super) struct CommandLine {
    pub(super) words: Vec<String>,
    pub(super) exit: i32,
}

/// Shell words of a line without its comment. Quotes keep what they enclose together.
pub(super) fn words(line: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut quote = None;
    let mut begins = true;
    for c in line.trim().chars() {
        match quote {
            Some(open) if c == open => quote = None,
            None if c == '\'' || c == '"' => {
                quote = Some(c);
                if std::mem::replace(&mut begins, false) {
                    words.push(String::new());
                }
            }
            None if c == ' ' => begins = true,
            None if c == '#' && begins => break,
            _ => {
                if std::mem::replace(&mut begins, false) {
                    words.push(String::new());
                }
                words.last_mut().expect("just pushed").push(c);
            }
        }
    }
    assert!(quote.is_none(), "a quote has no end in: {line}");
    words
}

impl CommandLine {
    pub(super) fn of(line: &str) -> Self {
        let exit = line
            .split_once("# exit ")
            .map_or(0, |(_, rest)| leading_number(rest));
        Self {
            words: words(line),
            exit,
        }
    }

    /// Why no program of the project takes it, if so. `whole`: nothing that it needs may be missing.
    pub(super) fn wrong(&self, whole: bool) -> Option<String> {
        let is_setting = |word: &&String| word.contains('=') && !word.starts_with('-');
        let settings = self.words.iter().take_while(is_setting).count();
        let (program, arguments) = self.words.get(settings..)?.split_first()?;
        match program.as_str() {
            "ptu" => wrong_ptu(arguments, whole),
            "ato-under-test" => wrong_unit(arguments),
            "cargo" => wrong_cargo(arguments),
            _ => None,
        }
    }
}

pub(super) fn leading_number(text: &str) -> i32 {
    let digits: String = text.chars().take_while(char::is_ascii_digit).collect();
    digits.parse().expect("an exit code")
}

pub(super) fn wrong_ptu(arguments: &[String], whole: bool) -> Option<String> {
    let all = ["ptu"]
        .into_iter()
        .chain(arguments.iter().map(String::as_str));
    let error = Cli::try_parse_from(all).err()?;
    let option_named = arguments.last().is_some_and(|word| word.starts_with("--"));
    let only_named = match error.kind() {
        ErrorKind::MissingRequiredArgument
        | ErrorKind::MissingSubcommand
        | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => true,
        ErrorKind::InvalidValue => option_named,
        _ => false,
    };
    let is_help = matches!(
        error.kind(),
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion
    );
    (!is_help && (whole || !only_named)).then(|| error.to_string())
}

/// The served unit's options are fields of one structure.
pub(super) fn wrong_unit(arguments: &[String]) -> Option<String> {
    let source = root().join("ato-under-test/src/program/mod.rs");
    let source = fs::read_to_string(source).expect("its arguments");
    let options = arguments.iter().filter_map(|word| word.strip_prefix("--"));
    let mut unknown = options.filter(|option| {
        let field = format!("    {}: ", option.replace('-', "_"));
        !source.contains(&field)
    });
    unknown
        .next()
        .map(|option| format!("ato-under-test has no --{option}"))
}

/// Package and target exist; what is to be run of the tests is the name of one.
pub(super) fn wrong_cargo(arguments: &[String]) -> Option<String> {
    let after = |option: &str| {
        let at = arguments.iter().position(|word| word == option)?;
        arguments.get(at + 1).map(String::as_str)
    };
    let package = after("-p")?;
    let Some((folder, manifest)) = find_package(package) else {
        return Some(format!("there is no package {package}"));
    };
    for (option, place) in [
        ("--test", "tests"),
        ("--bench", "benches"),
        ("--example", "examples"),
    ] {
        let Some(target) = after(option) else {
            continue;
        };
        let file = folder.join(place).join(format!("{target}.rs"));
        let main = folder.join(place).join(target).join("main.rs");
        let declared = manifest.contains(&format!("name = \"{target}\""));
        if !file.is_file() && !main.is_file() && !declared {
            return Some(format!("{package} has no target {option} {target}"));
        }
    }
    let filter = (arguments[0] == "test")
        .then(|| test_filter(arguments))
        .flatten()?;
    let name = filter.rsplit("::").next()?;
    (!has_test(&folder, name)).then(|| format!("{package} has no test called {filter}"))
}

/// The folder and manifest of a package; a package lies in the top folder or in another package's.
pub(super) fn find_package(name: &str) -> Option<(PathBuf, String)> {
    let folders = |within: &Path| {
        let entries = fs::read_dir(within).into_iter().flatten();
        entries.map(|entry| entry.expect("an entry").path())
    };
    let top: Vec<_> = folders(&root()).collect();
    let nested: Vec<_> = top.iter().flat_map(|folder| folders(folder)).collect();
    top.into_iter().chain(nested).find_map(|folder| {
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).ok()?;
        let named = manifest.contains(&format!("[package]\nname = \"{name}\""));
        named.then_some((folder, manifest))
    })
}

/// The word that says which tests are run.
pub(super) fn test_filter(arguments: &[String]) -> Option<&str> {
    let with_value = ["-p", "--test", "--bench"];
    let mut before = "test";
    arguments.iter().skip(1).map(String::as_str).find(|word| {
        let is_value = with_value.contains(&std::mem::replace(&mut before, word));
        !word.starts_with('-') && !is_value
    })
}

/// A function or file of the package has this in its name.
pub(super) fn has_test(folder: &Path, filter: &str) -> bool {
    let mut folders = vec![folder.join("src"), folder.join("tests")];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = fs::read_dir(&folder) else {
            continue;
        };
        for path in entries.map(|entry| entry.expect("an entry").path()) {
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            let text = fs::read_to_string(&path).unwrap_or_default();
            let mut functions = text.lines().filter_map(|line| line.split_once("fn "));
            if stem.contains(filter) || functions.any(|(_, name)| name.contains(filter)) {
                return true;
            }
        }
    }
    false
}
