//! Draws the part of all cases that a check runs, another part after each commit; the long suite runs all cases.

use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

use crate::mutate::Dice;

/// Environment variable with the seed of a draw, or [`ALL`].
const SEED: &str = "CHECK_SEED";
/// Seed made from the last commit.
static OF_THE_LAST_COMMIT: LazyLock<String> = LazyLock::new(of_the_last_commit);
/// Value of the variable with which all cases are drawn.
const ALL: &str = "all";

/// Draws one in `one_in` of all cases, at least one. Prints the seed that draws the same cases again; a test that fails
/// shows it.
pub fn drawn<T>(all: impl IntoIterator<Item = T>, one_in: usize) -> Vec<T> {
    let mut waiting: Vec<T> = all.into_iter().collect();
    let seed = seed();
    println!("{SEED}={seed}");
    let Ok(number) = seed.parse() else {
        return waiting;
    };
    let mut dice = Dice::new(number, "draw");
    (0..waiting.len().div_ceil(one_in))
        .map(|_| waiting.swap_remove(dice.below(waiting.len())))
        .collect()
}

/// Whether the check is to run all cases.
pub fn draws_all() -> bool {
    asked().is_some_and(|seed| seed == ALL)
}

/// Value of `CHECK_SEED`.
///
/// # Panics
/// If the variable is neither a number nor [`ALL`].
fn asked() -> Option<String> {
    let asked = std::env::var(SEED).ok()?;
    let known = asked == ALL || asked.parse::<u64>().is_ok();
    assert!(known, "{SEED} is a number or \"{ALL}\", not {asked:?}");
    Some(asked)
}

/// Seed in `CHECK_SEED`, or else a number made from the last commit; 0 without Git.
fn seed() -> String {
    asked().unwrap_or_else(|| OF_THE_LAST_COMMIT.clone())
}

fn of_the_last_commit() -> String {
    let mut git = Command::new("git");
    git.args(["rev-parse", "HEAD"])
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")));
    let commit = git.output().ok().filter(|output| output.status.success());
    let digits = commit.and_then(|output| {
        Some(
            String::from_utf8_lossy(&output.stdout)
                .get(..15)?
                .to_owned(),
        )
    });
    let number = digits.and_then(|digits| u64::from_str_radix(&digits, 16).ok());
    number.unwrap_or_default().to_string()
}
