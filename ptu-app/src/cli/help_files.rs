//! `ptu help-files`: what a package installs of the command line's own description.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use clap::{Args, Command, CommandFactory as _};
use clap_complete::Shell;

use super::{Cli, help, print_out};
use ptu_bench::failure::{Exit, Failure};

/// Write manual pages (man1/) and shell completions (bash/, zsh/, fish/) into a folder
#[derive(Debug, Args)]
pub struct HelpFilesArguments {
    /// Folder to write into
    folder: PathBuf,
}

impl HelpFilesArguments {
    /// Writes them.
    pub fn run(self) -> Result<Exit, Failure> {
        let folder = &self.folder;
        manuals(&folder.join("man1"))
            .and_then(|()| completions(folder))
            .map_err(|error| {
                Failure::bench(format!("cannot write to {}: {error}", folder.display()))
            })?;
        print_out(&format!("written: {}", folder.display()))
    }
}

fn manuals(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    let mut command = help::flowing(Cli::command()).disable_help_subcommand(true);
    command.build();
    pages(folder, &command)
}

/// The page of a command, and those of its verbs.
fn pages(folder: &Path, command: &Command) -> io::Result<()> {
    let name = command.get_display_name().unwrap_or(command.get_name());
    let mut page = Vec::new();
    clap_mangen::Man::new(command.clone())
        .manual("PTU")
        .render(&mut page)?;
    fs::write(folder.join(format!("{name}.1")), page)?;
    command
        .get_subcommands()
        .filter(|verb| !verb.is_hide_set())
        .try_for_each(|verb| pages(folder, verb))
}

fn completions(folder: &Path) -> io::Result<()> {
    for (shell, name) in [
        (Shell::Bash, "bash"),
        (Shell::Zsh, "zsh"),
        (Shell::Fish, "fish"),
    ] {
        let folder = folder.join(name);
        fs::create_dir_all(&folder)?;
        clap_complete::generate_to(shell, &mut Cli::command(), "ptu", &folder)?;
    }
    Ok(())
}
