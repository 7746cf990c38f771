//! From a run to the part to replace: what was seen, the dictionary it is held against, the answer.

mod answer;
mod attribution;
mod basis;
mod cars;
mod confirmed;
mod dictionary;
mod history;
mod proof;
mod repairs;
mod stored_run;

pub use answer::{Answer, Bench, Question, adaptive, diagnose, diagnose_run};
pub use basis::{LINE, TRAIN, UNIT_CONFIG, basis, settings};
pub use dictionary::{Chosen, Origin, choose};
pub use history::OwnHistory;
pub use proof::{RepairProof, prove_repairs};
