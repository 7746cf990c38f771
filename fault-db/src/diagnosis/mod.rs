//! From results to the part that failed.
//!
//! Two rooms: [`matrix`] works on any dependency matrix of states and tests and builds the cheapest
//! decision tree; the rest reads what a run found against a dictionary of what each fault mode does
//! to each check.

pub mod matrix;
