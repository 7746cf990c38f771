//! The tester at the unit's maintenance port: its session and requests, the unit's identity, log, stores and clock,
//! and a tester that only listens.

mod exchange;
mod identity;
mod log_reader;
mod log_session;
mod request;
mod store_reader;
mod subscription;
pub mod test_signals;
mod tester;
mod unit_clock;

pub use identity::{ExpectedIdentity, IdentityCheck, UnitRecord, version};
pub use log_reader::MAX_EVENTS;
pub use log_session::LogSession;
pub use request::Request;
pub use store_reader::StoredData;
pub use subscription::Subscription;
pub use tester::Tester;
pub use unit_clock::TimeOfDay;
