//! PSM: where the train is in its section, from distance run, corrected at markers whose order and
//! place are checked; and the health of TRA [S0 §3.3].

mod locator;
mod tra;

pub use locator::{Locator, Movement};
pub use tra::Tra;
