//! KRN: start-up, self-test and the event log [S0 §3].

mod log;
mod self_test;

pub use log::{EventLog, FreezeFrame, LOG_CAPACITY};
pub use self_test::{SelfTestInputs, SelfTester};
