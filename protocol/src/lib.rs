//! Wire protocol between a tester and an on-board ATC unit, and the data that both share.
//!
//! Layers, bottom up:
//! * [`frame`]: async-HDLC framing with FCS-32 and a streaming decoder that counts what it rejects;
//! * [`link`]: sequence, time stamp, time-out and address checks for each peer;
//! * [`message`]: the typed messages of the four channels, with declared field layouts;
//! * [`signal`], [`event`]: the catalogue of recorded signals and of unit events;
//! * [`Backlog`]: spreads bytes that waited over the scans that are made up;
//! * [`config`], [`mod@line`], [`injection`]: unit configuration, track database and fault modes as
//!   checked data;
//! * [`lru`], [`Verdict`]: identifiers of replaceable parts and the verdict of a test, for the crates that
//!   test and diagnose;
//! * [`Random`]: the seeded generator of random numbers;
//! * [`display_text`]: makes text from outside safe to display.
//!
//! Integers cross the wire, SI `f64` is used inside; [`Speed`], [`Instant`] and [`Duration`] keep
//! units straight. `no_std` with `alloc`: no clock, no thread, no file.
#![no_std]
#![warn(missing_docs)]

extern crate alloc;

#[macro_use]
mod labelled;

mod backlog;
pub mod config;
mod decoder;
pub mod display_text;
pub mod event;
pub mod frame;
pub mod injection;
pub mod line;
pub mod link;
pub mod lru;
pub mod message;
mod pace;
mod random;
pub mod signal;
mod speed;
mod time;
mod verdict;

pub use backlog::Backlog;
pub use lru::LruId;
pub use pace::ScanDeadlines;
pub use random::Random;
pub use speed::Speed;
pub use time::{CYCLE, Duration, Instant, SCAN};
pub use verdict::Verdict;
