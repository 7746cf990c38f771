//! Questions of check procedures to the operator at the terminal.

use std::sync::{Arc, Mutex};

use btu_rig::procedure::Runner;
use btu_rig::rig::Rig;
use protocol::Instant;

use ptu_report::words::Words;
use ptu_runs::run::RunControl;
use ptu_runs::stdio;
use ptu_runs::typed::{Typed, somebody_is_there};

/// Reads the answers that the operator types while a procedure asks.
pub struct Operator {
    typed: Mutex<Typed>,
}

impl Operator {
    /// The operator at the terminal; `None` if nobody is there.
    pub fn at_terminal() -> Option<Arc<Self>> {
        let typed = || Mutex::new(Typed::listen());
        somebody_is_there().then(|| Arc::new(Self { typed: typed() }))
    }
}

pub const HOW_TO_ANSWER: &str = "[y/n]";

impl RunControl for Operator {
    fn after_cycle(&self, _now: Instant, _rig: &Rig) {}

    fn before_scan(&self, runner: &mut Runner) {
        let Ok(typed) = self.typed.try_lock() else {
            return;
        };
        // A line typed before the question is not an answer to it, and is dropped.
        let asks = runner.awaits_operator();
        for line in typed.lines().iter().filter(|_| asks) {
            match answer(line) {
                Some(yes) => runner.answer(yes),
                None => {
                    let said = Words::shown().terminal.type_yes_no;
                    stdio::note(&format!("{said} {HOW_TO_ANSWER}"));
                }
            }
        }
    }
}

fn answer(line: &str) -> Option<bool> {
    match line.to_lowercase().as_str() {
        "y" | "yes" | "예" | "네" => Some(true),
        "n" | "no" | "아니오" | "아니요" => Some(false),
        _ => None,
    }
}
