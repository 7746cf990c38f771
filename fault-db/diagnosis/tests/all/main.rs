//! Tests of what diagnosis promises to its callers.

mod diagnosis;
mod proof;
