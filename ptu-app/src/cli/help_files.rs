//! `ptu help-files`: writes the files that a package installs and that the program itself can make best.

mod documents;
mod manual_page;

use std::path::{Path, PathBuf};

use clap::{Args, Command, CommandFactory as _};

use super::{Cli, WindowOptions, help, print_out};
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::new_file::cannot_write;
use ptu_runs::whole_file::write_text;

/// File type of a history for the desktop, with `@ID@` for the number that marks a history.
const FILE_TYPES: &str = include_str!("../../../packaging/ptu.xml");

/// Write manual pages (man1/), shell completions (bash/, zsh/, fish/) and file types (ptu.xml) into a folder
#[derive(Debug, Args)]
pub struct HelpFilesArguments {
    /// Folder to write into
    folder: PathBuf,
    /// Also write the manuals and all that they link to, as pages for a browser (html/), from this folder of the
    /// sources
    #[arg(long, value_name = "FOLDER")]
    documents: Option<PathBuf>,
}

impl HelpFilesArguments {
    pub fn run(self) -> Result<Exit, Failure> {
        let folder = &self.folder;
        manuals(&folder.join("man1"))?;
        completions(folder)?;
        write_text(&folder.join("ptu.xml"), file_types())?;
        if let Some(sources) = &self.documents {
            documents::write(sources, &folder.join("html"))?;
        }
        print_out(&format!("written: {}", folder.display()))
    }
}

fn manuals(folder: &Path) -> Result<(), Failure> {
    let mut command = help::flowing(Cli::command()).disable_help_subcommand(true);
    command.build();
    pages(folder, &command)?;
    let window = Command::new("ptu-window").version(env!("CARGO_PKG_VERSION"));
    pages(folder, &WindowOptions::augment_args(window))
}

/// Writes the manual page of a command, and the pages of its verbs.
fn pages(folder: &Path, command: &Command) -> Result<(), Failure> {
    let name = command.get_display_name().unwrap_or(command.get_name());
    let file = folder.join(format!("{name}.1"));
    let page = manual_page::page(command).map_err(|error| cannot_write(&file, &error))?;
    write_text(&file, page)?;
    command
        .get_subcommands()
        .filter(|verb| !verb.is_hide_set())
        .try_for_each(|verb| pages(folder, verb))
}

fn completions(folder: &Path) -> Result<(), Failure> {
    for (shell, file) in [
        ("bash", "bash/ptu.bash"),
        ("zsh", "zsh/_ptu"),
        ("fish", "fish/ptu.fish"),
    ] {
        write_text(&folder.join(file), super::completions::script(shell))?;
    }
    Ok(())
}

/// File types for the desktop: SQLite files with the number of a history are histories.
fn file_types() -> String {
    FILE_TYPES.replace("@ID@", &format!("0x{:08x}", fault_db::APPLICATION_ID))
}
