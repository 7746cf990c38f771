//! `--scripts`: selects the folder of procedures and data files.

use std::path::PathBuf;

use clap::Args;
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::Failure;

/// Where procedures and data files are.
#[derive(Debug, Args)]
pub struct ScriptsOption {
    /// Directory with procedures, units/ and lines/, alone [default: ./scripts, or above the program; else the user's and
    /// the system's own files over those in the program]
    #[arg(long, value_name = "DIR", env = "PTU_SCRIPTS")]
    scripts: Option<PathBuf>,
}

impl ScriptsOption {
    /// The folder that was named, or the one that counts where none was. Its Korean texts are taken for all that is said from now on.
    ///
    /// # Errors
    /// The named folder or its Korean texts cannot be read.
    pub fn find(&self) -> Result<ScriptsDirectory, Failure> {
        let scripts = ScriptsDirectory::find(self.scripts.as_deref())?;
        ptu_report::words::take_own(&scripts)?;
        Ok(scripts)
    }
}
