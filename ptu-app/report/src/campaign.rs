//! The result of a campaign as text and as JSON.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::left_out::{
    left_out_json, left_out_text, other_faults_json, other_faults_text, pairs_json, pairs_text,
};
use crate::shares::{percent, share_json};
use ptu_runs::campaign::{AdaptiveFigures, Effort, Figures, Outcome, Redundancy, Share, Shortfall};

/// The connection of a laptop alone, as a dictionary names it.
const ALONE: &str = "ptu";

/// The result of a campaign as JSON; the keys on which other programs rely come first, shares and names beside them.
pub fn campaign_json(outcome: &Outcome, figures: &Figures, steps: &Redundancy) -> Value {
    let names = |shortfalls: &[Shortfall]| -> Vec<_> {
        shortfalls.iter().map(|s| s.fault.clone()).collect()
    };
    let [one, two, three] = figures.isolated_modes;
    json!({
        "modes": figures.modes,
        "detected": figures.detected_modes,
        "isolated_1": one,
        "isolated_2": two,
        "isolated_3": three,
        "false_alarms": figures.false_alarms,
        "good_runs": figures.good_runs,
        "undetected": names(&figures.undetected),
        "ambiguous": figures.ambiguous,
        "runs": outcome.runs,
        "shares": {
            "detected": figures.detected.iter().map(|(kind, s)| ((*kind).to_owned(), share_json(*s))).collect::<serde_json::Map<_, _>>(),
            "unsafe_detected": share_json(figures.unsafe_detected),
            "reachable_detected": share_json(figures.reachable_detected),
            "detected_isolated_1": share_json(figures.detected_isolated),
            "isolated_1": share_json(figures.isolated[0]),
            "isolated_2": share_json(figures.isolated[1]),
            "isolated_3": share_json(figures.isolated[2]),
            "named": share_json(figures.named),
            "wrong": share_json(figures.wrong),
        },
        "not_isolated": figures.not_isolated.iter().map(shortfall).collect::<Vec<_>>(),
        "missed": figures.undetected.iter().map(shortfall).collect::<Vec<_>>(),
        "adaptive": outcome.adaptive.as_ref().map(adaptive_json),
        "steps": {
            "needed": texts(&steps.needed),
            "redundant": texts(&steps.redundant),
            "never_failed": texts(&steps.never_failed),
        },
        "connection": outcome.dictionary.basis.connection,
        "need_bench": need_bench(outcome),
        "basis_sha256": outcome.dictionary.basis.sha256,
        "left_out": outcome.left_out.as_ref().map(left_out_json),
        "off_way": outcome.off_way.iter().map(|off| json!({ "fault": off.fault, "step": off.step.to_string() })).collect::<Vec<_>>(),
        "pairs": outcome.pairs.as_ref().map(pairs_json),
        "common_causes": outcome.common.as_ref().map(other_faults_json),
    })
}

/// Fault modes that no held-out run on the maintenance port alone detected: they need the bench.
fn need_bench(outcome: &Outcome) -> Vec<&str> {
    if outcome.dictionary.basis.connection != ALONE {
        return Vec::new();
    }
    let mut found = BTreeMap::<&str, bool>::new();
    for one in &outcome.assessments {
        *found.entry(&one.fault).or_default() |= one.detected;
    }
    let missed = found.into_iter().filter(|(_, detected)| !detected);
    missed.map(|(fault, _)| fault).collect()
}

fn texts(checks: &[diagnosis::CheckName]) -> Vec<String> {
    checks.iter().map(ToString::to_string).collect()
}

fn shortfall(short: &Shortfall) -> Value {
    json!({
        "fault": short.fault, "of": short.share.of, "all": short.share.all,
        "taken_for": short.taken_for,
    })
}

pub fn campaign_text(outcome: &Outcome, figures: &Figures, steps: &Redundancy) -> String {
    let mut text = String::new();
    let dictionary = &outcome.dictionary;
    let _ = writeln!(
        text,
        "{} suite runs; dictionary of {} fault modes of {} parts over {} checks kept\n",
        outcome.runs,
        dictionary.modes.len(),
        dictionary.lrus().len(),
        dictionary.checks.len()
    );
    let mut line = |what: &str, share: Share| text += &share_text(what, share);
    for (kind, s) in &figures.detected {
        line(&format!("detected, {kind}"), *s);
    }
    line("detected, unsafe", figures.unsafe_detected);
    for (parts, s) in (1..).zip(figures.isolated) {
        line(
            &format!(
                "isolated to at most {parts} part{}",
                if parts == 1 { "" } else { "s" }
            ),
            s,
        );
    }
    line("right part named, or among few", figures.named);
    line("wrong parts named", figures.wrong);
    let _ = writeln!(
        text,
        "{:34} {} of {} good runs",
        "false alarms", figures.false_alarms, figures.good_runs
    );
    if let Some(adaptive) = &outcome.adaptive {
        text += &adaptive_text(adaptive);
    }
    text.push('\n');
    if dictionary.basis.connection == ALONE && figures.modes > 0 {
        let bench = need_bench(outcome);
        let Share { of, all } = figures.reachable_detected;
        let _ = writeln!(
            text,
            "reachable: detected {of} of {all} runs ({:.1} %); of all runs detected isolated to one part {} of {} ({:.1} %)",
            percent(of as f64, all as f64),
            figures.detected_isolated.of,
            figures.detected_isolated.all,
            percent(
                figures.detected_isolated.of as f64,
                figures.detected_isolated.all as f64
            ),
        );
        let _ = writeln!(
            text,
            "a laptop alone finds {} of {} fault modes; the bench is needed for: {}",
            figures.modes - bench.len(),
            figures.modes,
            if bench.is_empty() {
                "none".to_owned()
            } else {
                bench.join(", ")
            }
        );
    }
    list_shortfalls(&mut text, figures);
    for said in outcome.good.iter().filter(|said| !said.is_empty()) {
        let _ = writeln!(text, "false alarm: {}", said.join("; "));
    }
    let _ = writeln!(
        text,
        "\nsteps: {} of {} tell apart, by passing or failing alone, all that the suite does; {} more fail under \
         some fault; {} fail under none",
        steps.needed.len(),
        dictionary.checks.len(),
        steps.redundant.len(),
        steps.never_failed.len()
    );
    for off in &outcome.off_way {
        let _ = writeln!(
            text,
            "{} fails {}, whose way does not pass its part",
            off.fault, off.step
        );
    }
    if let Some(left_out) = &outcome.left_out {
        text += &left_out_text(left_out);
    }
    if let Some(pairs) = &outcome.pairs {
        text += &pairs_text(pairs);
    }
    if let Some(common) = &outcome.common {
        text += &other_faults_text("one cause at several parts", common);
    }
    text.trim_end().to_owned()
}

fn share_text(what: &str, Share { of, all }: Share) -> String {
    let value = (Share { of, all }).value();
    let value = value.map_or_else(|| "-".into(), |value| format!("{:.2} %", 100.0 * value));
    format!("{what:34} {value:>8}  ({of} of {all} runs)\n")
}

fn adaptive_json(adaptive: &AdaptiveFigures) -> Value {
    let effort =
        |Effort { mean, median, p90 }| json!({ "mean": mean, "median": median, "p90": p90 });
    json!({
        "suite_steps": adaptive.suite_steps,
        "suite_s": adaptive.suite_s,
        "steps": effort(adaptive.steps),
        "time_s": effort(adaptive.time_s),
        "detected": share_json(adaptive.detected),
        "unsafe_detected": share_json(adaptive.unsafe_detected),
        "named": share_json(adaptive.named),
        "wrong": share_json(adaptive.wrong),
        "missed": adaptive.missed,
    })
}

fn adaptive_text(adaptive: &AdaptiveFigures) -> String {
    let steps = adaptive.suite_steps as f64;
    let mut text = format!(
        "\nadaptive runs of these units, of {steps} steps and {:.0} s of the suite\n",
        adaptive.suite_s
    );
    let (all, all_s) = (adaptive.steps, adaptive.time_s);
    for (name, made, took_s) in [
        ("effort, median", all.median, all_s.median),
        ("effort, mean", all.mean, all_s.mean),
        ("nine in ten runs take at most", all.p90, all_s.p90),
    ] {
        let _ = writeln!(
            text,
            "{name:34} {made:.0} steps ({:.1} %), {took_s:.0} s ({:.1} %)",
            percent(made, steps),
            percent(took_s, adaptive.suite_s)
        );
    }
    for (what, share) in [
        ("detected", adaptive.detected),
        ("detected, unsafe", adaptive.unsafe_detected),
        ("right part named, or among few", adaptive.named),
        ("wrong parts named", adaptive.wrong),
    ] {
        text += &share_text(what, share);
    }
    if !adaptive.missed.is_empty() {
        let _ = writeln!(text, "unsafe and missed: {}", adaptive.missed.join(", "));
    }
    text
}

fn list_shortfalls(text: &mut String, figures: &Figures) {
    list(text, "not detected in some run", &figures.undetected);
    list(
        text,
        "not isolated to one part in some run",
        &figures.not_isolated,
    );
    for group in &figures.ambiguous {
        let _ = writeln!(text, "not distinguished in some run: {}", group.join(", "));
    }
}

fn list(text: &mut String, what: &str, shortfalls: &[Shortfall]) {
    if shortfalls.is_empty() {
        return;
    }
    let _ = writeln!(text, "{what}:");
    for short in shortfalls {
        let Share { of, all } = short.share;
        let _ = writeln!(
            text,
            "  {:34} {of} of {all}; else {}",
            short.fault,
            short.taken_for.join(", ")
        );
    }
}
