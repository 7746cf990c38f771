//! What each operating system does in a way of its own, under the same names: who may read a file, what a file is, and
//! where libpq has its things.

#[cfg(unix)]
mod unix;
#[cfg(windows)]
mod windows;

#[cfg(unix)]
use unix as system;
#[cfg(windows)]
use windows as system;

pub(crate) use system::{
    LOGGED_IN, at_socket, for_owner, is_open_to_others, password_file, special_kind,
};
