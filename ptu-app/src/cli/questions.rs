//! Questions that are kept under a name, in a file of this user.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use fault_db::{limits, read_regular_file};

use ptu_runs::failure::{Failure, FileTrouble, KeepTrouble, Unknown, Why, did_you_mean};
use ptu_runs::whole_file::{self, LONGEST_FILE};

/// Saved questions by name: the words of the command line after `ptu`.
pub type Questions = BTreeMap<String, Vec<String>>;

/// Saves the question of this command line under a name.
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

/// The words of a question without the options `--save`, `--db` and `--lang`, whose values may differ each time it is
/// asked.
fn asked(words: impl Iterator<Item = String>) -> Vec<String> {
    without(words.skip(1), &["--save", "--db", "--lang"], &[])
}

/// The words without some options: those of `with_value` go with their value, those of `plain` alone.
pub fn without(
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

pub fn question<'a>(
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

pub fn usual_file() -> Result<PathBuf, Failure> {
    ptu_options::settings_file("questions.json")
}

pub fn load(file: &Path) -> Result<Questions, Failure> {
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

pub fn store(file: &Path, questions: &Questions) -> Result<(), Failure> {
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
}
