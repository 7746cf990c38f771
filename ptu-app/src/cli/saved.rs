//! `ptu saved`: questions saved under a name.

use clap::{Args, CommandFactory, FromArgMatches};

use super::questions::{Questions, load, question, store, usual_file, without};
use super::{Cli, print_out, quoted};
use ptu_report::words::{Words, fill};
use ptu_runs::failure::{Exit, Failure, KeepTrouble};
use ptu_runs::table::Table;

/// Ask a saved question again, or list them all
///
/// Questions of `ptu faults list|stats|trend` and `ptu db query` are saved with --save NAME. A question is asked of the
/// database in use. Options after the question's name are added to its own options, or replace them.
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

impl SavedArguments {
    /// Asks a question, lists all questions, or removes one.
    pub fn run(mut self) -> Result<Exit, Failure> {
        let file = usual_file()?;
        let mut questions = load(&file)?;
        // Questions asked on the way here: a file edited by hand may have one question ask another, or go in a circle.
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

/// The command line of a question, with the options `more` added.
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

/// The words of a question without the options that an option of `more` replaces or excludes.
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
    // `--state` takes several states: states given now replace all saved states.
    let states = drop_if_given(&["--state"]);
    let forms = drop_if_given(&["--json", "--csv"]);
    let with_value = [spans, states].concat();
    without(words.iter().cloned(), &with_value, forms)
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

#[cfg(test)]
mod tests {
    use super::*;

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
