//! Tests of the command line's words: an option has one meaning in all verbs, and each example of the help can be
//! typed.

use std::collections::{BTreeMap, BTreeSet};

use clap::{Command, CommandFactory as _, Parser as _};

use super::Cli;

/// Collects the options of a command and its verbs, each with the kinds of value it takes and the verbs that take it.
fn options(command: &Command, verb: &str, found: &mut BTreeMap<String, BTreeMap<String, String>>) {
    for option in command.get_arguments() {
        let Some(word) = option.get_long() else {
            continue;
        };
        let value = match option.get_action().takes_values() {
            true => option.get_value_names().map_or_else(String::new, |names| {
                names.iter().map(|name| name.as_str()).collect()
            }),
            false => "nothing".to_owned(),
        };
        let verbs = found.entry(word.to_owned()).or_default();
        verbs.entry(value).or_insert_with(|| verb.to_owned());
    }
    for below in command.get_subcommands() {
        options(below, &format!("{verb} {}", below.get_name()), found);
    }
}

/// Goal: an option means the same in all verbs, so that nobody has to look it up twice. Method: where two verbs have an
/// option of one name, both take the same kind of value.
#[test]
fn an_option_takes_the_same_in_every_verb() {
    let mut found = BTreeMap::new();
    options(&Cli::command(), "ptu", &mut found);
    assert!(found.len() > 80, "{} options", found.len());
    let differ: Vec<_> = (found.iter())
        .filter(|(_, values)| values.len() > 1)
        .map(|(word, values)| format!("--{word}: {values:?}"))
        .collect();
    assert!(differ.is_empty(), "{differ:#?}");
}

/// Goal: the table of words in `docs/commands.md` is right. Method: each option that the table names exists, and none
/// is in the table twice.
#[test]
fn the_table_of_words_names_options_that_exist() {
    let mut found = BTreeMap::new();
    options(&Cli::command(), "ptu", &mut found);
    let page = include_str!("../../../docs/commands.md");
    let (_, table) = page
        .split_once("| Word | Meaning")
        .expect("a table of words");
    let rows = table.lines().skip(2).take_while(|row| row.starts_with('|'));
    let mut seen = BTreeSet::new();
    for row in rows {
        let words = row.split('|').nth(1).unwrap_or_default();
        for word in words.split('`').filter_map(|word| word.strip_prefix("--")) {
            let word = word.split([' ', '=']).next().unwrap_or_default();
            assert!(found.contains_key(word), "no option --{word}: {row}");
            assert!(seen.insert(word.to_owned()), "--{word} stands there twice");
        }
    }
    assert!(seen.len() > 15, "{seen:?}");
}

/// The examples in the help of a command and of its verbs.
fn examples(command: &Command, found: &mut Vec<String>) {
    let about = command.get_long_about().or(command.get_about());
    let text = about.map(ToString::to_string).unwrap_or_default();
    let lines = text.lines().filter_map(|line| line.strip_prefix("  "));
    found.extend(
        lines
            .filter(|line| line.starts_with("ptu"))
            .map(str::to_owned),
    );
    for below in command.get_subcommands() {
        examples(below, found);
    }
}

/// Splits an example into words as a shell does; two spaces end the command and begin its explanation.
fn shell_words(example: &str) -> Vec<String> {
    let command = example.split("  ").next().unwrap_or_default();
    let command = command.split(" && ").next().unwrap_or_default();
    let mut words = vec![String::new()];
    let mut quote = None;
    for letter in command.chars() {
        match (letter, quote) {
            (_, Some(open)) if open == letter => quote = None,
            ('\'' | '"', None) => quote = Some(letter),
            (' ', None) => words.push(String::new()),
            _ => words.last_mut().expect("the first").push(letter),
        }
    }
    words
}

/// Goal: what the help shows can be typed. Method: every example of every verb is read by the program's own arguments.
#[test]
fn every_example_of_the_help_is_a_command_that_is_taken() {
    let mut found = Vec::new();
    examples(&Cli::command(), &mut found);
    assert!(found.len() > 50, "{} examples", found.len());
    let wrong: Vec<_> = (found.iter())
        .filter_map(|example| {
            let error = Cli::try_parse_from(shell_words(example)).err()?;
            Some(format!("{example}\n{error}"))
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
