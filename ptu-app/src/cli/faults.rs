//! `ptu faults`: the fault history.

mod change;
mod filter;
mod import;
mod life;
mod list;
mod part;
mod show;
mod stats;
mod trend;
mod trend_plot;
mod trend_text;
mod undo;

use clap::{Args, Subcommand};
pub use import::read_of;

use super::signing::Signed;
use super::{Database, Json, ScriptsOption};
use ptu_report::naming::PartNames;
use ptu_runs::failure::{Exit, Failure};

/// Query and keep the fault history
#[derive(Debug, Args)]
pub struct FaultsArguments {
    #[command(subcommand)]
    verb: Verb,
    #[command(flatten)]
    database: Database,
}

#[derive(Debug, Subcommand)]
enum Verb {
    List(Box<list::ListArguments>),
    /// Show one fault with its occurrences and freeze frame
    Show {
        /// The fault: an id, its beginning or end (at least 4 digits), or `latest`
        id: String,
        #[command(flatten)]
        json: Json,
        #[command(flatten)]
        scripts: ScriptsOption,
    },
    Life(life::LifeArguments),
    Stats(Box<stats::StatsArguments>),
    Trend(trend::TrendArguments),
    State(Signed<change::StateArguments>),
    Repair(Signed<change::RepairArguments>),
    Cause(Signed<change::CauseArguments>),
    Note(Signed<change::NoteArguments>),
    Undo(Signed<undo::UndoArguments>),
    Import(Signed<import::ImportArguments>),
}

impl FaultsArguments {
    pub fn run(self) -> Result<Exit, Failure> {
        let reads = matches!(
            self.verb,
            Verb::List(_) | Verb::Show { .. } | Verb::Life(_) | Verb::Stats(_) | Verb::Trend(_)
        );
        let store = match reads {
            true => self.database.open_read_only()?,
            // A unit's log is stored as a run, and runs are recorded in a file, not on a server.
            false if matches!(self.verb, Verb::Import(_)) => self.database.open_file()?,
            false => self.database.open()?,
        };
        match self.verb {
            Verb::List(arguments) => arguments.list(&store),
            Verb::Show { id, json, scripts } => {
                show::show(&store, &id, json, &PartNames::of(&scripts.find()?))
            }
            Verb::Life(arguments) => arguments.tell(&store),
            Verb::Stats(arguments) => arguments.stats(&store),
            Verb::Trend(arguments) => arguments.trend(&store),
            Verb::State(arguments) => arguments.by_its_key(&store)?.change(&store),
            Verb::Repair(arguments) => arguments.by_its_key(&store)?.record(&store),
            Verb::Cause(arguments) => arguments.by_its_key(&store)?.attribute(&store),
            Verb::Note(arguments) => arguments.by_its_key(&store)?.note(&store),
            Verb::Undo(arguments) => arguments.by_its_key(&store)?.undo(&store),
            Verb::Import(arguments) => arguments.by_its_key(&store)?.import(store),
        }
    }
}
