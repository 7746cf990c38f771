//! From a run to the part to replace: what was seen, the dictionary it is held against, the answer.

mod basis;
mod gather;

pub use basis::{LINE, TRAIN, UNIT_CONFIG, basis, settings};
pub use gather::{Gatherer, of_run};
