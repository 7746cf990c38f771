//! The subject of a sheet.

use fault_db::Id;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SheetOf {
    Run(Id),
    /// The case of a fault, up to this run.
    Case {
        fault: Id,
        run: Id,
    },
    /// Comparison of two runs of a unit; `all` = with the steps that passed in both.
    Compared {
        before: Id,
        after: Id,
        all: bool,
    },
}

impl SheetOf {
    /// The run of the sheet; of several the last.
    pub fn run(self) -> Id {
        match self {
            Self::Run(run) | Self::Case { run, .. } | Self::Compared { after: run, .. } => run,
        }
    }
}
