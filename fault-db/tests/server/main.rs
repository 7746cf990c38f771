//! A PostgreSQL server: connecting, the same answers as a file's, and syncing with everything that can
//! happen on the way.

#[path = "../common/mod.rs"]
mod common;
mod counts;
mod laptop;
mod private;
mod proxy;

mod answers;
mod crash;
mod guarded;
mod hostile_rows;
mod insert_only;
mod many_laptops;
mod rights;
mod sealed;
mod shared_faults;
mod syncing;
mod trouble;
