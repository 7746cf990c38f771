//! The options of `ptu gui`, which `ptu-window` takes as they are.

use btu_rig::rig::Harness;
use clap::Args;

use super::{Database, Page, ScriptsOption};
use ptu_report::words::Language;
use ptu_runs::link::Endpoint;

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
pub struct WindowOptions {
    /// Language, en or ko [default: as the window was left, at first the language of the locale]
    #[arg(long, value_name = "LANGUAGE")]
    pub lang: Option<Language>,
    // No doc comment: clap would take it as the help in place of `help`, which names the pages.
    #[arg(long, value_name = "PAGE", help = format!("Page to show first: {}", Page::one_of()))]
    pub page: Option<Page>,
    #[allow(
        rustdoc::broken_intra_doc_links,
        reason = "help, whose brackets are no link"
    )]
    /// Connect at once: sim, serial:PATH[@BAUD], tcp:HOST:PORT or lockstep:PATH
    #[arg(long, value_name = "UNIT")]
    pub unit: Option<Endpoint>,
    /// Whether the bench harness is connected: auto, none or bench [default: as the window was left]
    #[arg(long, value_name = "WHICH")]
    pub harness: Option<Harness>,
    /// Faults to inject into the simulated unit, see `ptu catalog faults`
    #[arg(
        long,
        value_name = "FAULT[,FAULT]",
        value_delimiter = ',',
        requires = "unit"
    )]
    pub inject: Vec<String>,
    /// Make the database that --db names if it is not there
    #[arg(long)]
    pub create: bool,
    // A documentation comment would be part of the help.
    #[command(flatten)]
    pub database: Database,
    // A documentation comment would be part of the help.
    #[command(flatten)]
    pub scripts: ScriptsOption,
}
