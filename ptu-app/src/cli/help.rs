//! Help texts: wrapped to the width of the terminal, and in two sections on the first screen.

use clap::Command;
use clap::builder::StyledStr;

/// Verbs that a technician never needs, each with a short text: the help shows them in a section after the options.
const MAKERS: [(&str, &str); 5] = [
    (
        "campaign",
        "Make a fault dictionary, and say what it is worth",
    ),
    ("drive", "Drive from station to station, or by hand"),
    (
        "matrix",
        "Find the cheapest order of tests of a dependency matrix",
    ),
    (
        "new",
        "Begin a procedure, unit configuration, line or fault mode",
    ),
    ("train", "Serve a unit aboard a simulated train on a port"),
];

/// The commands, with the verbs of `MAKERS` in a section of their own; only their place in the help differs.
pub fn sectioned(mut command: Command) -> Command {
    let mut section = "For makers of procedures, dictionaries and controllers:".to_owned();
    for (name, about) in MAKERS {
        section += &format!("\n  {name:<9} {about}");
        command = command.mut_subcommand(name, |verb| verb.hide(true));
    }
    command.after_help(section)
}

/// The commands with help texts whose paragraphs flow, without the line ends of the source. A line that begins with
/// spaces, as an example does, stays a line.
pub fn flowing(command: Command) -> Command {
    let about = command.get_about().map(joined);
    let long_about = command.get_long_about().map(joined);
    let mut command = command.mut_subcommands(flowing);
    if let Some(about) = about {
        command = command.about(about);
    }
    match long_about {
        Some(long_about) => command.long_about(long_about),
        None => command,
    }
}

fn joined(text: &StyledStr) -> String {
    let mut joined = String::new();
    let mut goes_on = false;
    for line in text.to_string().lines() {
        let stands_alone = line.is_empty() || line.starts_with(' ');
        if !joined.is_empty() {
            joined.push(if goes_on && !stands_alone { ' ' } else { '\n' });
        }
        joined.push_str(line);
        goes_on = !stands_alone;
    }
    joined
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;
    use crate::cli::Cli;

    /// Goal: the first screen shows a technician what he uses, and hides no verb from those who make procedures. Method:
    /// each verb stands there once, and those of makers after the options.
    #[test]
    fn each_verb_is_on_the_first_screen_once() {
        let command = flowing(Cli::command());
        let shown: Vec<_> = (command.get_subcommands())
            .filter(|verb| !verb.is_hide_set())
            .map(|verb| verb.get_name().to_owned())
            .collect();
        assert!(shown.len() > 15, "{shown:?}");
        let screen = sectioned(command).render_help().to_string();
        let options = screen.find("Options:").expect("options");
        for verb in shown {
            let place = format!("\n  {verb:<9}");
            assert_eq!(screen.matches(&place).count(), 1, "{verb}: {screen}");
            let is_makers = MAKERS.iter().any(|(name, _)| *name == verb);
            assert_eq!(screen.find(&place) > Some(options), is_makers, "{verb}");
        }
    }

    #[test]
    fn lines_of_a_paragraph_are_one_and_examples_stay() {
        let text = "One\nparagraph\n\nExamples:\n  ptu a\n  ptu b\n\nExit codes:\n0 done";
        assert_eq!(
            joined(&text.to_owned().into()),
            "One paragraph\n\nExamples:\n  ptu a\n  ptu b\n\nExit codes: 0 done"
        );
    }
}
