//! Small widgets that several pages use.

mod chip;
mod limit_bar;

pub use chip::{chip, verdict_chip};
pub use limit_bar::{limit_bar, value_text};
