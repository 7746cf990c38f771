//! Options that `ptu` and `ptu-window` share. Each of the two programs reads them from its own command line, so that
//! the same words mean the same.
//!
//! * [`Database`]: `--db`; [`ScriptsOption`]: `--scripts`;
//! * [`WindowOptions`]: all options of `ptu gui`; [`Page`]: the pages of the window.

mod database;
mod page;
mod scripts;
pub mod sound_file;
mod window;

pub use database::{Database, only_file};
use fault_db::Address;
pub use page::Page;
use ptu_runs::failure::Failure;
pub use scripts::ScriptsOption;
pub use window::WindowOptions;

/// Refuses a command line that holds a server's password.
///
/// # Errors
/// An argument holds one. Looked at first: whatever else is wrong would be shown as it stands.
pub fn refuse_password() -> Result<(), Failure> {
    let mut arguments = std::env::args_os().skip(1);
    if arguments.any(|argument| Address::holds_password(&argument.to_string_lossy())) {
        return Err(Failure::usage(
            "the command line holds a password, and every program on this computer can read it there: leave \
             it out of the address and put it into ~/.pgpass (a line HOST:PORT:DATABASE:USER:PASSWORD, chmod \
             600), into a file named with ?passfile=FILE, or into PGPASSWORD; and change it, if others work \
             here",
        ));
    }
    Ok(())
}
