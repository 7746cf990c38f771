//! Promises of the crate, without a server.

#[path = "../common/mod.rs"]
mod common;

mod asking;
mod care;
mod cases;
mod checking;
mod counting;
mod counting_filters;
mod dictionaries;
mod foreign_files;
mod forged;
mod history;
mod life;
mod merging;
mod opening;
mod pruning;
mod recording;
mod run_notes;
mod signing;
mod stimuli;
mod trace_codec;
mod trace_reading;
mod verifying;
mod withdrawing;
