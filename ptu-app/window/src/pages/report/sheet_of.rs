//! The subject of a sheet.

use fault_db::Id;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SheetOf {
    Run(Id),
    /// A fault's case, after this run.
    Case {
        fault: Id,
        run: Id,
    },
    /// Two runs of a unit; with what passed in both, if wanted.
    Compared {
        before: Id,
        after: Id,
        all: bool,
    },
}

impl SheetOf {
    /// The run it ends with.
    pub fn run(self) -> Id {
        match self {
            Self::Run(run) | Self::Case { run, .. } | Self::Compared { after: run, .. } => run,
        }
    }
}
