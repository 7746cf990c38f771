//! `ptu gui` in a program that was built without its window.

use clap::Args;
use ptu_bench::failure::{Exit, Failure};

/// Open the technician's window, which this program was built without
#[derive(Debug, Args)]
pub struct GuiArguments {
    /// What a program with a window takes
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    _any: Vec<String>,
}

impl GuiArguments {
    /// Those of `ptu gui` with nothing after it.
    pub fn usual() -> Result<Self, Failure> {
        Ok(Self { _any: Vec::new() })
    }

    /// Says that there is no window.
    pub fn run(self) -> Result<Exit, Failure> {
        Err(Failure::usage(
            "this program was built without its window; build it without --no-default-features, or see `ptu help` for \
             what it does at a terminal",
        ))
    }
}
