//! What the crate promises.

mod diagnosis;
mod proof;
