//! Small widgets that several pages use.

mod chip;

pub use chip::{chip, verdict_chip};
