//! Defaults of options that a depot or a user chose, in files: the depot's file is read first, then the user's. In each
//! file the table of this computer is read last; the last value counts. The command line counts before all files.
//!
//! ```toml
//! who = "Kim"
//! line = "line6"
//! [host.bench-2]
//! unit = "serial:/dev/ttyUSB0"
//! ```

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::{ColorChoice, Command, ValueEnum as _};
use serde::Serialize;
use toml::{Table, Value};

use ptu_report::words::Language;
use ptu_runs::failure::{Failure, FileTrouble, did_you_mean};
use ptu_runs::platform::computer_name;

/// Options for which a default can be chosen.
pub const OPTIONS: [&str; 8] = [
    "who",
    "unit",
    "line",
    "unit-config",
    "train",
    "db",
    "lang",
    "color",
];
/// Table of a file that holds a table for each computer.
const HOST: &str = "host";

/// A default that a depot or user chose for an option.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Preset {
    /// The option, without its hyphens.
    pub option: String,
    /// The default value of the option.
    pub value: String,
    /// The file, and the table of this computer if the value stands there.
    pub from: String,
}

/// Files of defaults, whether they exist or not; a later file counts more.
pub fn files() -> Vec<PathBuf> {
    let depot = PathBuf::from("/etc/ptu/config.toml");
    [depot]
        .into_iter()
        .chain(crate::settings_file("config.toml"))
        .collect()
}

/// All defaults chosen for this computer; of several for one option the last counts.
///
/// # Errors
/// A file cannot be read, or holds a key or value that cannot be a default.
pub fn presets() -> Result<Vec<Preset>, Failure> {
    let mut presets = Vec::new();
    for file in files().iter().filter(|file| file.exists()) {
        let text = std::fs::read_to_string(file).map_err(|error| FileTrouble::unread(file, error));
        let table = text.and_then(|text| {
            toml::from_str(&text).map_err(|error| FileTrouble::wrong(file.display(), error))
        });
        let found = table.and_then(|table| of_table(&table, file, &computer_name()));
        presets.extend(found.map_err(Failure::usage)?);
    }
    Ok(presets)
}

fn of_table(table: &Table, file: &Path, computer: &str) -> Result<Vec<Preset>, FileTrouble> {
    let mut presets = Vec::new();
    let file = file.display();
    let mut take = |table: &Table, from: String| -> Result<(), FileTrouble> {
        for (option, value) in table.iter().filter(|(option, _)| *option != HOST) {
            let Value::String(value) = value else {
                return Err(FileTrouble::PresetNoText(from, option.clone()));
            };
            let why = match option.as_str() {
                "lang" => value.parse::<Language>().err(),
                "color" => ColorChoice::from_str(value, false).err(),
                _ => None,
            };
            if let Some(why) = why {
                return Err(FileTrouble::wrong(from, why));
            }
            if !OPTIONS.contains(&option.as_str()) {
                let near = did_you_mean(option, OPTIONS);
                return Err(FileTrouble::NoPreset(from, option.clone(), near));
            }
            presets.push(Preset {
                option: option.clone(),
                value: value.clone(),
                from: from.clone(),
            });
        }
        Ok(())
    };
    take(table, file.to_string())?;
    let hosts = table.get(HOST).and_then(Value::as_table);
    if let Some(own) = hosts.and_then(|hosts| hosts.get(computer)?.as_table()) {
        take(own, format!("{file} [{HOST}.{computer}]"))?;
    }
    Ok(presets)
}

/// Sets the presets as defaults of the command's options. `words` is the command line: a run that continues an earlier
/// run (`--resume`, `--retry-errors`) takes no preset for unit, line, unit configuration and train.
pub fn applied(command: Command, presets: &[Preset], words: &[OsString]) -> Command {
    let goes_on = words.iter().any(|word| {
        let word = word.to_string_lossy();
        ["--resume", "--retry-errors"].contains(&word.split('=').next().unwrap_or_default())
    });
    let of_run = |option: &str| matches!(option, "unit" | "line" | "unit-config" | "train");
    let kept = presets.iter().filter(|preset| {
        let option = preset.option.as_str();
        // A variable counts more than a file; `Database` reads the variable itself.
        let by_variable = option == "db" && std::env::var_os("PTU_DB").is_some();
        !(by_variable || goes_on && of_run(option))
    });
    set(command, &kept.collect::<Vec<_>>(), &mut Vec::new())
}

fn set(command: Command, presets: &[&Preset], verbs: &mut Vec<String>) -> Command {
    verbs.push(command.get_name().to_owned());
    let at = verbs.iter().map(String::as_str).skip(1).collect::<Vec<_>>();
    let command = presets.iter().fold(command, |command, preset| {
        let is_there = |command: &Command| {
            let mut options = command.get_arguments();
            options.any(|option| option.get_long() == Some(&preset.option))
        };
        if !is_there(&command) || !suits(&preset.option, &at) {
            return command;
        }
        command.mut_args(|option| match option.get_long() == Some(&preset.option) {
            // Leaked on purpose: the value lives as long as the program, which reads its command line once.
            true => option.default_value(&*preset.value.clone().leak()),
            false => option,
        })
    });
    let command = command.mut_subcommands(|below| set(below, presets, verbs));
    verbs.pop();
    command
}

/// Whether a preset counts for a verb. Where line or unit only narrow what is shown, they have to be given each time;
/// the window connects only when it is told to.
fn suits(option: &str, verbs: &[&str]) -> bool {
    match (option, verbs) {
        ("who" | "db" | "lang" | "color", _) => true,
        (_, ["faults", "import"] | ["record", ..] | ["run"]) => true,
        ("unit", _) => matches!(verbs, ["trace", "replay"]),
        (_, [verb]) => matches!(*verb, "drive" | "train" | "catalog"),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Arg;

    fn of(text: &str) -> Result<Vec<Preset>, String> {
        let table = toml::from_str(text).expect("TOML");
        let told = of_table(&table, Path::new("config.toml"), "bench-2");
        told.map_err(|why| why.to_string())
    }

    #[test]
    fn what_this_computer_has_comes_last() {
        let text = "who = \"Kim\"\nline = \"line6\"\n[host.bench-2]\nline = \"line8\"\n[host.other]\nwho = \"Lee\"\n";
        let told: Vec<_> = (of(text).expect("presets").into_iter())
            .map(|preset| [preset.option, preset.value, preset.from].join(" "))
            .collect();
        let own = "line line8 config.toml [host.bench-2]";
        assert_eq!(told, ["line line6 config.toml", "who Kim config.toml", own]);
    }

    #[test]
    fn presets_are_the_defaults_of_what_drives_and_narrow_no_question() {
        let with = |name: &'static str| {
            let options = ["line", "who"].map(|option| Arg::new(option).long(option));
            Command::new(name).args(options)
        };
        let verbs = || [with("run"), Command::new("faults").subcommand(with("list"))];
        let presets = of("who = \"Kim\"\nline = \"line6\"").expect("presets");
        let asked = |line: &str| {
            let words: Vec<_> = line.split(' ').map(OsString::from).collect();
            let command = Command::new("ptu").subcommands(verbs());
            let matches = applied(command, &presets, &words).get_matches_from(words);
            let mut at = &matches;
            while let Some((_, below)) = at.subcommand() {
                at = below;
            }
            ["who", "line"].map(|option| at.get_one::<String>(option).cloned())
        };
        let [kim, line6] = ["Kim", "line6"].map(|text| Some(text.to_owned()));
        assert_eq!(asked("ptu run"), [kim.clone(), line6.clone()]);
        assert_eq!(asked("ptu run --who Lee"), [Some("Lee".into()), line6]);
        assert_eq!(asked("ptu faults list"), [kim.clone(), None]);
        let resumed = ["ptu", "run", "--resume=7"].map(OsString::from);
        let command = applied(with("run"), &presets, &resumed);
        let line = command.get_matches_from(["run"]);
        assert_eq!(line.get_one::<String>("line"), None);
    }

    #[test]
    fn what_is_no_preset_is_refused_with_what_is_near() {
        let wrong = [
            (
                "lnie = \"line6\"",
                "config.toml: no option \"lnie\" has a default here (did you mean \"line\"?)",
            ),
            (
                "who = 3",
                "config.toml: write the default of who in quotation marks",
            ),
            (
                "[host.bench-2]\nunits = \"sim\"",
                "config.toml [host.bench-2]: no option \"units\" has a default here (did you mean \"unit\"?)",
            ),
        ];
        for (text, why) in wrong {
            assert_eq!(of(text).expect_err(text), why);
        }
    }
}
