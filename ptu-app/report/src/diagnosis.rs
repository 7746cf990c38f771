//! A diagnosis, as text and as JSON.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use diagnosis::{Candidate, Conclusion, Diagnosis, PartProbability, Reason};
use fault_db::Id;
use protocol::display_text;
use serde_json::{Value, json};

use crate::coverage::count_short;
use crate::words::{Language, Words, fill};
use ptu_runs::coverage::counts_of;
use ptu_runs::run_diagnosis::Answer;

/// Parts that are shown at once.
pub const MOST_PARTS: usize = 3;
/// Reasons that are shown for each part.
pub const MOST_REASONS: usize = 3;

/// A diagnosis as JSON; the keys on which other programs rely come first.
pub fn diagnosis_json(answer: &Answer) -> Value {
    let d = &answer.diagnosis;
    let words = Language::English.words();
    let traces = |lru: &str| -> Vec<String> {
        let of_part = answer.traces.get(lru).into_iter().flatten();
        of_part.map(Id::to_string).collect()
    };
    let candidate = |c: &Candidate| {
        json!({
            "part": c.lru, "fault": c.fault, "probability": c.probability,
            "for": shown_reasons(answer, &c.for_it, words),
            "against": shown_reasons(answer, &c.against, words),
            "details": {
                "for": details(answer, &c.for_it, words), "against": details(answer, &c.against, words),
            },
            "text": words.fault_text(&c.text), "traces": traces(c.lru.as_str()),
        })
    };
    let share =
        |part: &PartProbability| json!({ "part": part.lru, "probability": part.probability });
    json!({
        "candidates": d.candidates.iter().map(candidate).collect::<Vec<_>>(),
        "why_not": answer.why_not.as_ref().map(candidate),
        "next_check": d.next_check,
        "conclusion": words.concluded(answer),
        "conclusion_ko": Language::Korean.words().concluded(answer),
        "finding": d.conclusion.finding(),
        "group": d.conclusion.measure().map(|measure| json!({
            "parts": d.conclusion.parts(), "measure": measure.english, "measure_ko": measure.korean,
        })),
        "parts": d.parts.iter().filter(|part| part.probability >= 0.001).map(share).collect::<Vec<_>>(),
        "no_fault": d.no_fault,
        "warnings": answer.warnings.iter().map(|warning| words.told(warning)).collect::<Vec<_>>(),
        "dictionary": words.report.origin(answer.dictionary_from),
        "run": answer.run.run.id.to_string(),
    })
}

/// The first reasons as text, [`MOST_REASONS`] at most.
pub fn shown_reasons(answer: &Answer, reasons: &[Reason], words: &Words) -> Vec<String> {
    let said = reasons.iter().take(MOST_REASONS);
    said.map(|reason| words.reason(reason, &answer.run))
        .collect()
}

/// All reasons, compared with the fault dictionary.
fn details(answer: &Answer, reasons: &[Reason], words: &Words) -> Vec<String> {
    let detail = |reason: &Reason| {
        let said = || words.reason(reason, &answer.run);
        words.reason_detail(reason).unwrap_or_else(said)
    };
    reasons.iter().map(detail).collect()
}

/// Text for people: the three likeliest parts, each with its likeliest fault and its strongest reasons; with `all` all
/// parts and all reasons, compared with the fault dictionary. If one part was asked about, that part alone.
pub fn diagnosis_text(answer: &Answer, all: bool, words: &Words) -> String {
    let d = &answer.diagnosis;
    let run = &answer.run.run;
    let counts = counts_of(run);
    let terminal = &words.terminal;
    let mut text = fill(
        terminal.counts,
        &[
            ("run", &run.id.short()),
            ("unit", &display_text::line(&run.unit_serial)),
            ("steps", &count_short(&counts, words)),
            ("failed", &counts.not_passed()),
            ("faults", &run.faults),
        ],
    );
    let _ = writeln!(text, "\n\n{}", words.concluded(answer));
    if let Some(c) = &answer.why_not {
        text += &format!("\n{}", fill(terminal.why_not, &[("part", &c.lru)]));
        part_text(&mut text, d, c, words);
        reasons_text(&mut text, (answer, c), all, words);
        return text.trim_end().to_owned();
    }
    for (probability, possible) in ranked(d, if all { usize::MAX } else { MOST_PARTS }) {
        let percent = 100.0 * probability;
        match possible {
            Possible::NoFault => {
                text += &format!("\n{percent:5.1} %  {}\n", words.diagnosis.no_fault);
            }
            Possible::Part(c) if all => {
                text += &format!("\n{percent:5.1} %  {}\n", c.lru);
                faults_text(&mut text, (answer, c), probability, words);
            }
            Possible::Part(c) => {
                part_text(&mut text, d, c, words);
                reasons_text(&mut text, (answer, c), false, words);
            }
        }
    }
    let shown = ranked(d, MOST_PARTS);
    let likely = |lru: &String| {
        let is_it =
            |possible: &Possible<'_>| matches!(possible, Possible::Part(c) if c.lru == **lru);
        shown.iter().any(|(_, possible)| is_it(possible))
    };
    for (lru, ids) in &answer.traces {
        let ids: Vec<_> = ids.iter().map(Id::short).collect();
        if !ids.is_empty() && (all || likely(lru)) {
            let of = [("part", lru as _), ("ids", &ids.join(", ") as _)];
            let _ = writeln!(text, "{}", fill(terminal.traces_naming, &of));
        }
    }
    if !all {
        text += &fill(terminal.diagnose_all, &[("run", &run.id.short())]);
    }
    text.trim_end().to_owned()
}

/// What may be the cause.
#[derive(Clone, Copy, Debug)]
pub enum Possible<'a> {
    /// A part, by its likeliest fault.
    Part(&'a Candidate),
    NoFault,
}

/// Least probability that is shown: a lower one would read 0.0 %.
const LEAST_TOLD: f64 = 0.0005;

/// What may be the cause, `most` parts, each with its probability, the likeliest first. The
/// probability of a part is the one that the conclusion tells.
pub fn ranked(of: &Diagnosis, most: usize) -> Vec<(f64, Possible<'_>)> {
    let nothing = matches!(
        of.conclusion,
        Conclusion::NothingSeen { made: 0, .. } | Conclusion::BenchFailed { .. }
    );
    if nothing {
        // The probability that a part has before any check is no finding.
        return Vec::new();
    }
    let mut parts = BTreeSet::new();
    let first = of.candidates.iter().filter(|c| parts.insert(&c.lru));
    let parts = first
        .take(most)
        .map(|c| (probability_of(of, c), Possible::Part(c)));
    let none = (of.no_fault, Possible::NoFault);
    let mut all: Vec<_> = parts.chain([none]).collect();
    all.retain(|(probability, _)| *probability >= LEAST_TOLD);
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    all
}

/// Probability that the part of a candidate has failed.
pub fn probability_of(of: &Diagnosis, c: &Candidate) -> f64 {
    let part = of.parts.iter().find(|part| part.lru == c.lru);
    part.map_or(c.probability, |part| part.probability)
}

/// Writes a part with its probability and its likeliest fault.
fn part_text(text: &mut String, d: &Diagnosis, c: &Candidate, words: &Words) {
    let percent = 100.0 * probability_of(d, c);
    let what = words.fault_text(&c.text);
    let _ = writeln!(text, "\n{percent:5.1} %  {}  ({}: {what})", c.lru, c.fault);
}

/// Writes all faults of a part, whose probabilities add up to that of the part.
fn faults_text(
    text: &mut String,
    (answer, part): (&Answer, &Candidate),
    mut rest: f64,
    words: &Words,
) {
    let terminal = &words.terminal;
    let of_these = terminal.of_these;
    for c in answer
        .diagnosis
        .candidates
        .iter()
        .filter(|c| c.lru == part.lru)
    {
        rest -= c.probability;
        let percent = 100.0 * c.probability;
        let what = words.fault_text(&c.text);
        let _ = writeln!(text, " {of_these} {percent:5.1} %  {}: {what}", c.fault);
        reasons_text(text, (answer, c), true, words);
    }
    if rest >= LEAST_TOLD {
        let percent = 100.0 * rest;
        let _ = writeln!(
            text,
            " {of_these} {percent:5.1} %  {}",
            terminal.other_faults
        );
    }
}

fn reasons_text(text: &mut String, (answer, c): (&Answer, &Candidate), all: bool, words: &Words) {
    for (sign, reasons) in [('+', &c.for_it), ('-', &c.against)] {
        let reasons = if all {
            details(answer, reasons, words)
        } else {
            shown_reasons(answer, reasons, words)
        };
        for reason in reasons {
            let _ = writeln!(text, "         {sign} {reason}");
        }
    }
}
