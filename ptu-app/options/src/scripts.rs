//! `--scripts`: selects the folder of procedures and data files.

use std::path::PathBuf;

use clap::Args;
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::Failure;

/// Option that names the folder of procedures and data files.
#[derive(Debug, Args)]
pub struct ScriptsOption {
    /// Directory with procedures, units/ and lines/, used alone [default: ./scripts, or scripts above the program; else
    /// the user's and the system's own files over those in the program]
    #[arg(long, value_name = "DIR", env = "PTU_SCRIPTS")]
    scripts: Option<PathBuf>,
}

impl ScriptsOption {
    /// The places of the scripts: the named folder, or else the default places. From now on their Korean texts are used
    /// for everything that is said.
    ///
    /// # Errors
    /// The named folder or its Korean texts cannot be read.
    pub fn find(&self) -> Result<ScriptsDirectory, Failure> {
        let scripts = ScriptsDirectory::find(self.scripts.as_deref())?;
        ptu_report::words::take_own(&scripts)?;
        Ok(scripts)
    }
}
