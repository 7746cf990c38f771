//! What this computer is called, as a server knows it.

/// This computer's name.
pub fn computer_name() -> String {
    rustix::system::uname()
        .nodename()
        .to_string_lossy()
        .into_owned()
}
