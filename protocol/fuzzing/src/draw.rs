//! Draws the part that the check runs, another part with each commit; the long suite runs all.

use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

use crate::mutate::Dice;

/// Names the seed of a draw, or [`ALL`].
const SEED: &str = "CHECK_SEED";
/// Seed made of the last commit, read once.
static OF_THE_LAST_COMMIT: LazyLock<String> = LazyLock::new(of_the_last_commit);
/// Seed with which everything is drawn.
const ALL: &str = "all";

/// Draws one in `one_in` of all, at least one. Prints the seed by which the same are drawn again: a test that fails
/// shows what was printed.
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

/// The check is asked to test all of it.
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

/// Seed that was asked for, or a number that follows from the last commit; without Git 0.
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
