//! A manual page: the help of a verb in the sections that readers of manual pages look for.

use std::io::{Result, Write as _};

use clap::Command;
use clap_mangen::Man;

/// Exit codes of a verb whose help names no exit codes.
const EXITS: &str = "0 done or passed, 1 a check failed, 2 wrong command or script, 3 bench, link or database, 130 stopped";
/// An option, the environment variable that stands for it, and what the variable holds.
const VARIABLES: [[&str; 3]; 11] = [
    ["db", "PTU_DB", "The history, in place of --db"],
    [
        "scripts",
        "PTU_SCRIPTS",
        "Folder with procedures and data files, in place of --scripts",
    ],
    ["key", "PTU_KEY", "Key file to sign with, in place of --key"],
    [
        "pin-file",
        "PTU_PIN_FILE",
        "File with the PIN of the key, in place of --pin-file",
    ],
    ["pin-file", "PTU_PIN", "The PIN itself"],
    [
        "keys",
        "PTU_KEYS",
        "List of trusted keys, in place of --keys",
    ],
    [
        "depot",
        "PTU_DEPOT",
        "The depot on sheets, in place of --depot",
    ],
    ["color", "NO_COLOR", "Not empty: without colours"],
    [
        "color",
        "CLICOLOR_FORCE",
        "Not 0: colours also where no terminal is",
    ],
    [
        "lang",
        "LC_ALL, LC_MESSAGES, LANG",
        "Locale; answers are in Korean where it begins with ko",
    ],
    ["no-pager", "PAGER", "Pager of long answers [default: less]"],
];
/// An option, the file that is used without it, and what the file is.
const FILES: [[&str; 3]; 5] = [
    ["db", "~/.local/share/ptu/history.db", "The user's history"],
    [
        "scripts",
        "~/.local/share/ptu/scripts, /etc/ptu/scripts, /usr/share/ptu/scripts",
        "Procedures and data: of the user, of the depot, of the package; each before the next",
    ],
    [
        "key",
        "~/.local/share/ptu/keys",
        "The user's keys, and the list of those that are trusted",
    ],
    ["save", "~/.config/ptu/questions.json", "Saved questions"],
    [
        "lang",
        "~/.config/ptu/config.toml, /etc/ptu/config.toml",
        "Defaults of options: of the user, of the depot; each before the next",
    ],
];

/// The manual page of a command, as roff.
pub(super) fn page(command: &Command) -> Result<Vec<u8>> {
    let about = command.get_long_about().or(command.get_about());
    let about = about.map(ToString::to_string).unwrap_or_default();
    let (mut description, mut examples, mut exits) = (Vec::new(), Vec::new(), EXITS);
    for paragraph in about.split("\n\n") {
        if let Some(lines) = paragraph.strip_prefix("Examples:\n") {
            examples.extend(lines.lines());
        } else if let Some(text) = paragraph.strip_prefix("Exit codes: ") {
            exits = text;
        } else {
            description.push(paragraph);
        }
    }
    let mut page = Vec::new();
    let described = command.clone().long_about(description.join("\n\n"));
    let man = Man::new(described).manual("PTU");
    man.render_title(&mut page)?;
    man.render_name_section(&mut page)?;
    man.render_synopsis_section(&mut page)?;
    man.render_description_section(&mut page)?;
    man.render_options_section(&mut page)?;
    if command.has_subcommands() {
        man.render_subcommands_section(&mut page)?;
    }
    writeln!(page, ".SH \"EXIT STATUS\"\n{}", text(exits))?;
    let takes = |option: &str| {
        let mut taken = command
            .get_arguments()
            .filter_map(|argument| argument.get_long());
        taken.any(|long| long == option)
    };
    for (heading, all) in [("ENVIRONMENT", &VARIABLES[..]), ("FILES", &FILES[..])] {
        let mut listed = all.iter().filter(|[option, ..]| takes(option)).peekable();
        if listed.peek().is_some() {
            writeln!(page, ".SH {heading}")?;
        }
        for [_, name, about] in listed {
            writeln!(page, ".TP\n{}\n{}", text(name), text(about))?;
        }
    }
    if !examples.is_empty() {
        // Without filling, each example stays on a line of its own.
        writeln!(
            page,
            ".SH EXAMPLES\n.nf\n{}\n.fi",
            text(&examples.join("\n"))
        )?;
    }
    if command.get_version().is_some() {
        man.render_version_section(&mut page)?;
    }
    Ok(page)
}

/// Text for a manual page (roff): its hyphens can be copied, and no line is taken for a request.
fn text(text: &str) -> String {
    let text = text.replace('\\', "\\e").replace('-', "\\-");
    let lines = text
        .lines()
        .map(|line| match line.starts_with(['.', '\'']) {
            true => format!("\\&{line}"),
            false => line.to_owned(),
        });
    lines.collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;
    use crate::cli::Cli;

    /// Goal: the manual page lists the variable of each option. Method: each variable that the program's options read
    /// is in `VARIABLES`.
    #[test]
    fn each_variable_of_an_option_is_listed() {
        fn check(command: &Command) {
            for argument in command.get_arguments() {
                let (long, variable) = (argument.get_long(), argument.get_env());
                let Some((long, variable)) = long.zip(variable) else {
                    continue;
                };
                let listed = VARIABLES
                    .iter()
                    .any(|[option, name, _]| *option == long && variable == *name);
                assert!(listed, "--{long}: {variable:?}");
            }
            command.get_subcommands().for_each(check);
        }
        check(&Cli::command());
    }

    #[test]
    fn a_page_has_examples_as_written_and_the_usual_sections() {
        let mut command = crate::cli::help::flowing(Cli::command());
        command.build();
        let run = command.find_subcommand("diagnose").expect("a verb");
        let page = String::from_utf8(page(run).expect("memory")).expect("UTF-8");
        for part in [
            ".SH \"EXIT STATUS\"\n0 answered, 2 no such run, or no dictionary.\n",
            ".SH ENVIRONMENT\n.TP\nPTU_DB\n",
            ".SH FILES\n.TP\n~/.local/share/ptu/history.db\n",
            ".SH EXAMPLES\n.nf\n  ptu diagnose latest",
        ] {
            assert!(page.contains(part), "{part}: {page}");
        }
    }
}
