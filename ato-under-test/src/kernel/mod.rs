//! KRN: start-up, self-test, watchdog, event log and run record [S0 §3].

mod log;
mod ring;
mod run_record;
mod self_test;
mod watchdog;

pub use log::{EventLog, LOG_CAPACITY, hundredths, hundredths_of_percent};
pub use ring::Ring;
pub use run_record::{RUN_ROWS, RunRecord};
pub use self_test::{SelfTestInputs, SelfTester};
pub use watchdog::Watchdog;
