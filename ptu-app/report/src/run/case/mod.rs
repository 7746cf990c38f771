//! The repair sheet of a case: what failed, what was replaced, and what a run afterwards says of it.
//!
//! A case is the faults of a unit that come from one part. Terms: the run *before* saw the fault last before its
//! repair; the run *after* is the one that proves the repair, or else the last that passed since.

mod compare;
mod content;
mod first_page;
mod gather;
mod json;

#[cfg(test)]
mod tests;

use fault_db::{FaultDetail, Id, RepairRecord};

pub use json::case_json;

use super::content::verdict;
use super::paper::across;
use super::{Paper, Printed, Sheet};
use crate::words::Words;
use ptu_runs::symptoms::Symptom;

/// All a repair sheet says, in no language yet.
pub struct CaseSheet {
    /// The fault that names the part of the case, or else the fault that was asked for.
    pub fault: FaultDetail,
    /// Depot of the unit; if empty, the sheet has a line to write the depot on.
    pub depot: String,
    /// The sheet has an annex with all that the two runs say.
    pub with_annex: bool,
    /// The run before the repair, which saw the fault.
    pub before: Sheet,
    /// `index` of each step of the run before that saw a fault of the case.
    pub steps: Vec<u32>,
    /// Symptom reported with the unit, in the run before or in an earlier run of the case.
    pub symptom: Option<Symptom>,
    pub repair: Option<Repair>,
    /// Runs that passed since the repair, oldest first.
    pub passed: Vec<Id>,
    pub after: Option<Sheet>,
    /// Standing of the repair.
    pub standing: Standing,
}

/// A repair as it was recorded.
pub struct Repair {
    pub record: RepairRecord,
    pub who: String,
    /// When, µs UTC.
    pub at_us: i64,
}

/// How far a repair is proved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Standing {
    Proved,
    /// A person says that the repair holds: who, when (µs UTC) and why.
    Vouched(String, i64, String),
    /// The repair is recorded, and no run proves it yet.
    Claimed,
    /// The fault was seen again after the repair.
    CameBack,
    /// No repair is recorded.
    NotRepaired,
}

impl CaseSheet {
    /// Number of the sheet, from the identifiers of fault and runs: while they stay, the number stays.
    pub fn number(&self) -> String {
        let runs = self.sheets().map(|sheet| sheet.run.run.id);
        let ids = std::iter::once(self.fault.fault.id).chain(runs);
        ids.map(|id| id.short()).collect::<Vec<_>>().join("-")
    }

    /// The run before, and the run after if there is one.
    fn sheets(&self) -> impl Iterator<Item = &Sheet> {
        std::iter::once(&self.before).chain(&self.after)
    }

    /// The run that tells the present state of the unit: the run after, or else the run before.
    pub fn last(&self) -> &Sheet {
        self.after.as_ref().unwrap_or(&self.before)
    }

    /// The part that was replaced, or else the one that the case comes from.
    fn part(&self) -> &str {
        match &self.repair {
            Some(repair) => &repair.record.part,
            None => self.fault.fault.cause(),
        }
    }

    fn is_practice(&self) -> bool {
        self.sheets().any(|sheet| sheet.run.run.is_practice())
    }
}

impl Standing {
    /// Word of the standing in JSON.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Proved => "proved",
            Self::Vouched(..) => "vouched",
            Self::Claimed => "claimed",
            Self::CameBack => "came_back",
            Self::NotRepaired => "not_repaired",
        }
    }
}

impl Printed for CaseSheet {
    fn paper(&self, words: &Words) -> Paper {
        let run = &self.last().run.run;
        Paper {
            name: words.report.case_sheet,
            unit: run.unit_serial.clone(),
            short: self.number(),
            number: self.number(),
            program: format!("ptu {}", run.app_version),
            at_us: run.finished_at_us.unwrap_or(run.started_at_us),
            across: self.is_practice().then(|| across(words)),
            blocks: self.blocks(words),
        }
    }
}
