//! Small widgets that several pages use.

mod chip;
pub mod lane;
mod limit_bar;

pub use chip::{chip, verdict_chip};
pub use limit_bar::{limit_bar, value_text};
