//! `ptu config`: defaults that the depot or the user chose, and where each comes from.

use clap::Args;
use serde_json::json;

use super::Json;
use ptu_options::presets::{self, OPTIONS};
use ptu_report::words::{Language, Words};
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::table::Table;

/// Show the defaults of options that you or the depot chose, and where each comes from
///
/// The files are /etc/ptu/config.toml, of the depot, and config.toml in your folder for configuration, which counts more. A
/// table [host.NAME] in a file is for the computer of this name, and counts more than the rest of the file. A command
/// line counts more than all files.
///
///   who = "Kim"
///   line = "line6"
///   [host.bench-2]
///   unit = "serial:/dev/ttyUSB0"
///
/// unit, line, unit-config and train are for runs, drives and records, not for questions to the history.
///
/// Examples:
///   ptu config
///   ptu config --json
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct ConfigArguments {
    #[command(flatten)]
    json: Json,
}

impl ConfigArguments {
    /// Prints the files and the defaults.
    pub fn run(self) -> Result<Exit, Failure> {
        let presets = presets::presets()?;
        let words = Words::shown();
        let terminal = &words.terminal;
        let chosen = |option: &str| presets.iter().rfind(|preset| preset.option == option);
        let variable = |option: &str| match option {
            "db" => std::env::var("PTU_DB").ok().map(|db| (db, "PTU_DB")),
            _ => None,
        };
        let row = |option: &str| match (variable(option), chosen(option)) {
            (Some((value, variable)), _) => [option.to_owned(), value, variable.to_owned()],
            (None, Some(preset)) => [option.to_owned(), preset.value.clone(), preset.from.clone()],
            (None, None) if option == "lang" => {
                let language = Language::shown().code().to_owned();
                [option.to_owned(), language, terminal.locale.to_owned()]
            }
            (None, None) => [
                option.to_owned(),
                String::new(),
                terminal.program.to_owned(),
            ],
        };
        let files = presets::files();
        let document = || {
            let files: Vec<_> = files
                .iter()
                .map(|file| file.display().to_string())
                .collect();
            json!({ "files": files, "options": presets })
        };
        self.json.answer(document, || {
            let headings = [terminal.option, words.common.value, terminal.from_where];
            let mut table = Table::headed(&headings);
            OPTIONS.iter().for_each(|option| table.row(row(option)));
            let file = |file: &std::path::PathBuf| match file.exists() {
                true => format!("\n{}", file.display()),
                false => format!("\n{} ({})", file.display(), terminal.not_there),
            };
            let files: String = files.iter().map(file).collect();
            format!("{}\n{files}", table.render())
        })
    }
}
