//! `ptu gui`: the technician's window.

use btu_rig::rig::Harness;
use clap::{Args, Parser};
use fault_db::Store;

use super::{Database, ScriptsOption};
use crate::gui::DataPaths;
use crate::gui::{Options, Page, Settings, open};
use ptu_bench::failure::{Exit, Failure};
use ptu_bench::link::Endpoint;
use ptu_bench::platform::leave_own_console;
use ptu_bench::stop::Stop;
use ptu_report::words::Language;

/// Open the technician's window
///
/// Examples:
///   ptu gui                     as it was left
///   ptu gui --lang ko           in Korean
///   ptu gui --page traces       with the traces in front
///   ptu gui --unit sim          connected to the simulated unit at once
///   ptu gui --create --db b.db     with a database that is made
///   ptu gui --db postgres://kim@depot/history   reads the history of a server
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct GuiArguments {
    /// Language, en or ko [default: as it was left]
    #[arg(long, value_name = "LANGUAGE")]
    lang: Option<Language>,
    #[arg(long, value_name = "PAGE", help = format!("Page to show first: {}", Page::one_of()))]
    page: Option<Page>,
    /// Connect at once: sim, serial:PATH[@BAUD], tcp:HOST:PORT or lockstep:PATH
    #[arg(long, value_name = "UNIT")]
    unit: Option<Endpoint>,
    /// Whether the bench harness is connected: auto, none or bench [default: as it was left]
    #[arg(long, value_name = "WHICH")]
    harness: Option<Harness>,
    /// Faults to inject into the simulated unit, see `ptu catalog faults`
    #[arg(
        long,
        value_name = "FAULT[,FAULT]",
        value_delimiter = ',',
        requires = "unit"
    )]
    inject: Vec<String>,
    /// Make the database that --db names if it is not there
    #[arg(long)]
    create: bool,
    #[command(flatten)]
    database: Database,
    #[command(flatten)]
    scripts: ScriptsOption,
}

#[derive(Debug, Parser)]
struct NoVerb {
    #[command(flatten)]
    gui: GuiArguments,
}

impl GuiArguments {
    /// Those of `ptu gui` with nothing after it; the environment counts.
    pub fn usual() -> Result<Self, Failure> {
        let no_verb = NoVerb::try_parse_from(["ptu"]);
        let usual = no_verb.map_err(|error| Failure::usage(error.to_string()))?;
        Ok(usual.gui)
    }

    /// Opens it and stays until it is closed.
    pub fn run(self) -> Result<Exit, Failure> {
        if !self.create {
            self.database.check_named().map_err(|failure| {
                Failure::bench(format!("{failure}; `ptu gui --create` makes it"))
            })?;
        }
        let settings_file = Settings::usual_file();
        let mut settings = settings_file
            .as_deref()
            .map(Settings::load)
            .unwrap_or_default();
        settings.language = self.lang.unwrap_or(settings.language);
        settings.page = self.page.unwrap_or(settings.page);
        let scripts = self.scripts.find()?;
        let paths = match self.database.server()? {
            Some(_) if self.unit.is_some() => {
                return Err(Failure::usage(
                    "a server's history is only read: without --unit, or with --db FILE",
                ));
            }
            Some(server) => {
                // Before there is a window to say it in.
                Store::connect_read_only(&server)?;
                DataPaths::of_server(server, scripts)
            }
            None => DataPaths::new(self.database.file()?, scripts),
        };
        settings.unit.harness = self.harness.unwrap_or(settings.unit.harness);
        if let Some(unit) = &self.unit {
            settings.unit.endpoint = unit.to_string();
            settings.unit.faults = self.inject;
            // Before there is a window to say it in.
            settings
                .unit
                .clone()
                .with_offered_faults()
                .setup(&paths.scripts)?;
        }
        leave_own_console();
        open(Options {
            paths,
            settings,
            settings_file,
            connect: self.unit.is_some(),
            interrupted: Stop::default(),
        })?;
        Ok(Exit::Passed)
    }
}
