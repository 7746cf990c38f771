//! Campaigns on the history: a program that is killed at any of its writes, and a power cut at any time between two syncs
//! of the disk. The check does a part of each; `scripts/campaigns/run` does all.

#![allow(
    clippy::print_stdout,
    reason = "figures, for whoever asks with --nocapture"
)]

mod histories;
mod kills;
mod power_cuts;
mod system_calls;
