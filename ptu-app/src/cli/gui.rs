//! `ptu gui`: the technician's window.

use clap::Args;

use super::{Database, ScriptsOption};
use crate::failure::{Exit, Failure};
use crate::gui::library::Shelf;
use crate::gui::{Options, Page, Settings, open};
use crate::words::Language;

/// Open the technician's window
///
/// Examples:
///   ptu gui                     as it was left
///   ptu gui --lang ko           in Korean
///   ptu gui --page traces       with the traces in front
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct GuiArguments {
    /// Language, en or ko [default: as it was left]
    #[arg(long, value_name = "LANG")]
    lang: Option<Language>,
    /// Page to show first: bench, procedures, traces, faults, diagnosis or report
    #[arg(long, value_name = "PAGE")]
    page: Option<Page>,
    #[command(flatten)]
    database: Database,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl GuiArguments {
    /// Opens it and stays until it is closed.
    pub fn run(self) -> Result<Exit, Failure> {
        let settings_file = Settings::usual_file();
        let mut settings = settings_file
            .as_deref()
            .map(Settings::load)
            .unwrap_or_default();
        settings.language = self.lang.unwrap_or(settings.language);
        settings.page = self.page.unwrap_or(settings.page);
        let shelf = Shelf {
            database: self.database.path()?,
            scripts: self.scripts.find()?,
        };
        open(Options {
            shelf,
            settings,
            settings_file,
        })?;
        Ok(Exit::Passed)
    }
}
