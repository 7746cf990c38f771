//! `ptu trace diff`: two traces side by side.

use std::fmt::Write as _;

use clap::Args;
use fault_db::{Store, TraceData};
use serde_json::json;

use super::explained::{deviations_json, deviations_text};
use super::plot::lanes;
use crate::cli::{ScriptsOption, print_json, print_out};
use crate::failure::{Exit, Failure};
use crate::replay::{Comparison, Original, compare, good_twin, rule_between};

/// Say where two traces differ, aligned at their triggers: which signals, first where, by how much
///
/// Numbers differ beyond one step of their signal, words and bits at once; where one of the traces comes
/// from a unit on a port, beyond what its clock explains (two rows, and a tolerance by the unit).
/// The number of log entries (`events`) is left out; on a port also efforts, accelerations and counts of
/// frames.
///
/// Examples:
///   ptu trace diff 59c2ce97 latest
///   ptu trace diff latest twin --signals speed,speed1,speed2,eb
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct DiffArguments {
    /// A trace
    #[arg(value_name = "A")]
    came: String,
    /// Another, or `twin`: the same stimuli on a sound unit
    #[arg(value_name = "B")]
    expected: String,
    /// Only these signals
    #[arg(long, value_name = "NAME[,NAME]", value_delimiter = ',')]
    signals: Vec<String>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl DiffArguments {
    pub fn run(self, store: &Store) -> Result<Exit, Failure> {
        let a = store.resolve_trace(&self.came)?;
        let came = store.trace(a)?;
        let (name, expected, rule) = if self.expected == "twin" {
            let original = Original::read(store, a)?;
            let (twin, rule) = good_twin(&original, &self.scripts.find()?)?;
            ("twin".to_owned(), twin, rule)
        } else {
            let b = store.resolve_trace(&self.expected)?;
            let rule = rule_between(store, a, b)?;
            (b.to_string(), store.trace(b)?, rule)
        };
        let comparison = compare(&came, &expected, &rule, &self.signals)?;
        if self.json {
            return print_json(&json!({
                "a": a.to_string(), "b": name,
                "from_s": comparison.window_s.0, "to_s": comparison.window_s.1,
                "missing_in_a": comparison.missing, "missing_in_b": comparison.missing_expected,
                "deviations": deviations_json(&comparison),
            }));
        }
        print_out(&text(&format!("{a}"), &name, &came, &expected, &comparison))
    }
}

fn text(a: &str, b: &str, came: &TraceData, expected: &TraceData, found: &Comparison) -> String {
    let (from_s, to_s) = found.window_s;
    let mut text =
        format!("A {a}\nB {b}\ncompared from {from_s:.2} s to {to_s:.2} s of the triggers\n");
    for (missing, of) in [(&found.missing, "A"), (&found.missing_expected, "B")] {
        if !missing.is_empty() {
            let _ = writeln!(text, "not in {of}: {}", missing.join(", "));
        }
    }
    if found.deviations.is_empty() {
        text.push_str("no signal differs");
        return text;
    }
    text.push_str(&deviations_text(found, "A", "B"));
    let names: Vec<_> = found.deviations.iter().map(|d| d.signal.as_str()).collect();
    let _ = write!(text, "\n{}", lanes(came, expected, &names));
    text
}
