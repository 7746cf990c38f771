//! `ptu saved`: queries saved under a name.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::{Args, CommandFactory, FromArgMatches};
use fault_db::{limits, read_regular_file};

use super::{Cli, print_out, quoted};
use ptu_report::words::{Words, fill};
use ptu_runs::failure::{Exit, Failure, FileTrouble, KeepTrouble, Unknown, Why, did_you_mean};
use ptu_runs::table::Table;
use ptu_runs::whole_file;
use ptu_runs::whole_file::LONGEST_FILE;

/// Ask a saved question again, or list them all
///
/// Questions of `ptu faults list|stats|trend` and `ptu db query` are saved with --save NAME. Each is asked
/// of the database in use. Options after its name are added to it, or replace its own.
///
/// Examples:
///   ptu faults stats --by part --when 90d --save worst
///   ptu saved worst
///   ptu saved worst --csv
///   ptu saved --forget worst
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct SavedArguments {
    /// The question's name; none = list all
    name: Option<String>,
    /// Remove the question of this name
    #[arg(long, value_name = "NAME", conflicts_with = "name")]
    forget: Option<String>,
    /// Options to add or to replace
    #[arg(
        trailing_var_arg = true,
        allow_hyphen_values = true,
        value_name = "OPTIONS"
    )]
    more: Vec<String>,
}

/// Questions by name: the words after `ptu`.
type Questions = BTreeMap<String, Vec<String>>;

impl SavedArguments {
    /// Asks, lists or forgets.
    pub fn run(mut self) -> Result<Exit, Failure> {
        let file = usual_file()?;
        let mut questions = load(&file)?;
        // Questions on the way to the one that is asked: whoever writes the file may have one ask another.
        let mut way: Vec<String> = Vec::new();
        loop {
            if let Some(name) = self.forget.take() {
                let known = question(&questions, &name)?.0.to_owned();
                questions.remove(&known);
                store(&file, &questions)?;
                let said = Words::shown().terminal.forgotten;
                return print_out(&fill(said, &[("name", &name)]));
            }
            let Some(name) = self.name.take() else {
                return print_out(&list(&questions));
            };
            if let Some(circle) = way.iter().position(|before| *before == name) {
                return Err(Failure::usage(KeepTrouble::Circle(
                    name,
                    way[circle..].join(" → "),
                    file.display().to_string(),
                )));
            }
            let cli = asked_for(&questions, &name, self.more)?;
            way.push(name);
            match cli.saved() {
                Ok(next) => self = next,
                Err(other) => return other.run(),
            }
        }
    }
}

/// The command line that a question stands for, with the options that were added.
fn asked_for(questions: &Questions, name: &str, more: Vec<String>) -> Result<Cli, Failure> {
    if more
        .iter()
        .any(|word| word == "--save" || word.starts_with("--save="))
    {
        return Err(Failure::usage(KeepTrouble::SavedAlready(name.to_owned())));
    }
    let (_, words) = question(questions, name)?;
    let words = ["ptu".to_owned()]
        .into_iter()
        .chain(without_rivals(words, &more))
        .chain(more);
    let matches = Cli::command()
        .args_override_self(true)
        .try_get_matches_from(words);
    matches
        .and_then(|matches| Cli::from_arg_matches(&matches))
        .map_err(|error| Failure::usage(KeepTrouble::NotAsked(name.to_owned(), error.to_string())))
}

/// Keeps the question of this command line under a name.
///
/// # Errors
/// The file of questions cannot be read or written.
pub fn save(name: &str, words: impl Iterator<Item = OsString>) -> Result<(), Failure> {
    if name.trim().is_empty() || name.starts_with('-') {
        return Err(Failure::usage(KeepTrouble::NoName(name.to_owned())));
    }
    limits::name("the question's name", name)?;
    let readable = words
        .map(OsString::into_string)
        .collect::<Result<Vec<_>, _>>();
    let words =
        readable.map_err(|word| Failure::usage(KeepTrouble::NoText(word.display().to_string())))?;
    let words = asked(words.into_iter());
    limits::list("the question", &words.join(" "))?;
    let file = usual_file()?;
    let mut questions = load(&file)?;
    questions.insert(name.to_owned(), words);
    store(&file, &questions)
}

/// The words without those that say under which name to save it, of which database it is asked, and in which language it
/// is answered.
fn asked(words: impl Iterator<Item = String>) -> Vec<String> {
    without(words.skip(1), &["--save", "--db", "--lang"], &[])
}

/// The words without the options that cannot stand beside one of these: that one replaces them.
fn without_rivals(words: &[String], more: &[String]) -> Vec<String> {
    let is_given = |options: &[&str]| {
        let mut names = more.iter().map(|word| word.split('=').next());
        names.any(|name| name.is_some_and(|name| options.contains(&name)))
    };
    let drop_if_given = |options| match is_given(options) {
        true => options,
        false => &[],
    };
    let spans = drop_if_given(&["--when", "--since-repair"]);
    // Several states are one question: given now, they are another.
    let states = drop_if_given(&["--state"]);
    let forms = drop_if_given(&["--json", "--csv"]);
    let with_value = [spans, states].concat();
    without(words.iter().cloned(), &with_value, forms)
}

/// The words without these options, those with a value, which goes with them, and those without.
fn without(
    mut words: impl Iterator<Item = String>,
    with_value: &[&str],
    plain: &[&str],
) -> Vec<String> {
    let mut kept = Vec::new();
    while let Some(word) = words.next() {
        let name = word.split('=').next().unwrap_or_default();
        match with_value.contains(&name) {
            true if name == word => drop(words.next()),
            true => {}
            false if plain.contains(&name) => {}
            false => kept.push(word),
        }
    }
    kept
}

fn question<'a>(
    questions: &'a Questions,
    name: &str,
) -> Result<(&'a str, &'a Vec<String>), Failure> {
    let known = questions
        .get_key_value(name)
        .map(|(name, words)| (name.as_str(), words));
    known.ok_or_else(|| {
        let near = did_you_mean(name, questions.keys().map(String::as_str));
        Failure::usage(Unknown::Question(name.to_owned(), near))
    })
}

fn list(questions: &Questions) -> String {
    let terminal = &Words::shown().terminal;
    if questions.is_empty() {
        return terminal.no_question.to_owned();
    }
    let mut table = Table::headed(&[terminal.name, terminal.question]);
    for (name, words) in questions {
        let words: Vec<_> = words.iter().map(|word| quoted(word)).collect();
        table.row([name.clone(), format!("ptu {}", words.join(" "))]);
    }
    table.render()
}

fn usual_file() -> Result<PathBuf, Failure> {
    directories::ProjectDirs::from("", "", "ptu")
        .map(|directories| directories.config_dir().join("questions.json"))
        .ok_or_else(|| Failure::usage(FileTrouble::NoSettingsFolder))
}

fn load(file: &Path) -> Result<Questions, Failure> {
    let text = match read_regular_file(file, LONGEST_FILE) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Questions::new()),
        other => other.map_err(|error| Failure::bench(FileTrouble::unread(file, error)))?,
    };
    serde_json::from_slice(&text).map_err(|error| {
        Failure::bench(FileTrouble::Damaged(
            file.display().to_string(),
            Why::of(error),
        ))
    })
}

fn store(file: &Path, questions: &Questions) -> Result<(), Failure> {
    whole_file::keep(file, questions)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_question_is_kept_without_its_name_and_database() {
        let words =
            "ptu faults --db a.db stats --save worst --by part --db=b.db --save=x --when 90d";
        let kept = asked(words.split(' ').map(str::to_owned));
        assert_eq!(kept.join(" "), "faults stats --by part --when 90d");
    }

    #[test]
    fn an_option_given_now_replaces_those_it_cannot_stand_beside() {
        let words = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
        let saved = words("faults list --state open --when=90d --json");
        for (more, kept) in [
            ("--limit 2", "faults list --state open --when=90d --json"),
            ("--csv", "faults list --state open --when=90d"),
            ("--when=7d", "faults list --state open --json"),
            ("--when 7d --json", "faults list --state open"),
            ("--state closed", "faults list --when=90d --json"),
        ] {
            assert_eq!(
                without_rivals(&saved, &words(more)).join(" "),
                kept,
                "{more}"
            );
        }
    }

    #[test]
    fn a_damaged_file_of_saved_queries_is_reported() {
        let folder = tempfile::tempdir().expect("folder");
        let file = folder.path().join("questions.json");
        let kept = r#"{"worst":["faults","stats","--by=part","--when","90d"],"a b":[]}"#;
        let fuzz = fuzzing::Fuzz::new("questions", env!("CARGO_MANIFEST_DIR"), [kept]);
        fuzz.run(5_000, |bytes| {
            std::fs::write(&file, bytes).expect("written");
            if let Ok(questions) = load(&file) {
                list(&questions);
                for words in questions.values() {
                    without_rivals(words, &["--when=7d".to_owned(), "--csv".to_owned()]);
                }
            }
        });
    }
}
