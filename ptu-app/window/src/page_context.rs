//! Data that a page reads and changes while it is drawn, and ways to other pages.

use std::collections::BTreeSet;
use std::ops::Range;

use fault_db::Id;

use super::data_watch::DataWatch;
use super::messages::Messages;
use super::parts::UnitFilter;
use super::query_worker::QueryWorker;
use super::settings::Settings;
use super::units::Units;
use ptu_report::words::Words;
use ptu_runs::symptoms::Symptom;

/// Data that a page reads and changes while it is drawn.
pub struct PageContext<'a> {
    pub words: &'static Words,
    /// Queries to the database and the scripts directory.
    pub queries: &'a QueryWorker,
    /// Watch of the database for changes by other programs.
    pub database: &'a DataWatch,
    /// The units under test of this window.
    pub units: &'a mut Units,
    /// Settings, saved when the window closes.
    pub settings: &'a mut Settings,
    pub messages: &'a mut Messages,
    /// Pages to open; done after this page is drawn.
    pub go_to: &'a mut Vec<Destination>,
}

impl PageContext<'_> {
    /// Reason for which nothing can be recorded here: the window reads a server. None if recording
    /// is possible.
    pub fn only_reads(&self) -> Option<&'static str> {
        let reads = self.queries.paths.is_server();
        reads.then_some(self.words.care.is_server)
    }

    /// Version of the data: it changes when a run has ended here, or another program has written.
    pub fn data_version(&self) -> (usize, u64) {
        (self.units.runs_ended(), self.database.changes())
    }
}

/// The faults that a bar of the statistics stands for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FaultsOf {
    /// Part that the faults come from.
    pub cause: Option<String>,
    /// When the faults were first seen, µs since 1970.
    pub first_seen_us: Option<Range<i64>>,
    /// Name of the span `first_seen_us`.
    pub month: String,
    /// Days to look back.
    pub days: Option<i64>,
    pub units: UnitFilter,
}

/// A page to open, and what it is to show.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Destination {
    Trace(Id),
    /// The test sheet of a run.
    Report(Id),
    Diagnosis(Id),
    Fault(Id),
    /// The history of a unit, a train or a part by its serial number.
    Life(String),
    /// The faults that a bar of the statistics stands for.
    Faults(FaultsOf),
    /// A run on the chosen unit.
    Run(Wanted),
    /// The set-up dialog of the chosen unit; the page stays.
    Setup,
    /// The dialog that maintains the fault history; the page stays.
    History,
    /// The dialog that says what this program is; the page stays.
    About,
    /// The procedures, with one step chosen and nothing run.
    ChooseStep {
        /// Procedure, as `atp/overspeed`.
        procedure: String,
        step: String,
    },
}

/// Run that a page asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// One step at once; shows the procedures.
    Step {
        /// Procedure, as `atp/overspeed`.
        procedure: String,
        step: String,
        /// Serial number of the unit the step is meant for.
        unit: String,
    },
    /// Procedures that look for a faulty part; the page Case stays. `adaptive`: as few steps as needed, else all.
    Part {
        /// Symptom with which the unit was brought.
        symptom: Option<Symptom>,
        adaptive: bool,
    },
    /// Rest of a run that broke off with the link, once its unit is connected again; the page stays.
    Rest,
    /// These procedures, and those that suspect the part, to prove its repair; the page Case stays.
    Prove {
        procedures: BTreeSet<String>,
        part: String,
    },
}
