//! What the tests of the window share, beside what they share with the tests of `ptu`.

#[path = "../../../tests/common/mod.rs"]
mod shared;

pub mod display;
pub mod picture;
pub mod window;

pub use shared::*;
