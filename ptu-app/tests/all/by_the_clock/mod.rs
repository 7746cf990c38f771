//! Tests that judge times by the clock, when nothing else runs.

mod acceptance;
mod bench;
mod pace;
mod sound;
mod sound_server;
mod standstill;
