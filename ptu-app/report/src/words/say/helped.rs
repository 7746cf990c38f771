//! The commands and options that help, after the Korean of a trouble that a window tells without them.

use fault_db::StoreError;
use ptu_runs::failure::{Trouble, in_place_of};

pub(super) fn with_commands(trouble: &Trouble, said: String) -> String {
    let help = match trouble {
        Trouble::Store(error) => of_store(error),
        Trouble::NotStored {
            kept: Some(file), ..
        }
        | Trouble::RestKept { rest: file, .. } => format!("`ptu db import {}`", file.display()),
        _ => String::new(),
    };
    match help.is_empty() {
        true => said,
        false => format!("{said} ({help})"),
    }
}

fn of_store(error: &StoreError) -> String {
    use StoreError as S;
    let help = match error {
        S::Altered { .. } => "`ptu db check`, `ptu db query`",
        S::EarlierCopy { .. } => "`ptu db sync --as-copy`",
        S::ForkedCopy { .. } => "`ptu db import`, `ptu db sync --as-copy`",
        S::Io { .. } | S::Malformed { .. } | S::Corrupt { .. } => "`ptu db check`",
        S::NotAFile { .. } => "`ptu db sync`",
        S::ServerEmpty { .. } | S::ServerOlderSchema { .. } => "`ptu db server init ADDRESS`",
        other if in_place_of(other).is_some() => "--db",
        _ => "",
    };
    help.to_owned()
}
