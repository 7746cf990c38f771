//! Options that `ptu` and `ptu-window` share. Each of the two programs reads them from its own command line, so that
//! the same words mean the same.
//!
//! * [`Database`]: `--db`; [`ScriptsOption`]: `--scripts`;
//! * [`presets`]: defaults that a depot or a user chose, in files;
//! * [`WindowOptions`]: all options of `ptu gui`; [`Page`]: the pages of the window.

mod database;
mod page;
pub mod presets;
mod scripts;
pub mod sound_file;
mod window;

pub use database::{Database, only_file};
use fault_db::Address;
pub use page::Page;
use ptu_runs::failure::{Asked, Failure};
pub use scripts::ScriptsOption;
pub use window::WindowOptions;

/// Refuses a command line that holds a server's password.
///
/// # Errors
/// An argument holds one. Looked at first: whatever else is wrong would be shown as it stands.
pub fn refuse_password() -> Result<(), Failure> {
    let mut arguments = std::env::args_os().skip(1);
    if arguments.any(|argument| Address::holds_password(&argument.to_string_lossy())) {
        return Err(Failure::usage(Asked::Password));
    }
    Ok(())
}
