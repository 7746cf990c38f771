//! Wraps help texts to the width of the terminal.

use clap::Command;
use clap::builder::StyledStr;

/// The same commands, their texts without the line ends of the source: those within a paragraph, where the
/// next line does not begin with spaces, as an example does.
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
    use super::*;

    #[test]
    fn lines_of_a_paragraph_are_one_and_examples_stay() {
        let text = "One\nparagraph\n\nExamples:\n  ptu a\n  ptu b\n\nExit codes:\n0 done";
        assert_eq!(
            joined(&text.to_owned().into()),
            "One paragraph\n\nExamples:\n  ptu a\n  ptu b\n\nExit codes: 0 done"
        );
    }
}
