//! A diagnosis, as text and as JSON.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use diagnosis::{Candidate, PartProbability, Reason};
use fault_db::Id;
use protocol::display_text;
use serde_json::{Value, json};

use crate::coverage::count_short;
use crate::words::{Language, Words};
use ptu_runs::coverage::counts_of;
use ptu_runs::run_diagnosis::Answer;

/// Parts that are shown at once.
pub const MOST_PARTS: usize = 3;
/// Reasons that are shown of each.
pub const MOST_REASONS: usize = 3;

/// The contract's keys first.
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
        "group": d.conclusion.group().map(|group| json!({
            "parts": group.parts, "measure": group.measure.english, "measure_ko": group.measure.korean,
        })),
        "parts": d.lrus.iter().filter(|part| part.probability >= 0.001).map(share).collect::<Vec<_>>(),
        "two_faults": d.two_faults,
        "no_fault": d.no_fault,
        "warnings": answer.warnings.iter().map(|warning| words.warning(warning)).collect::<Vec<_>>(),
        "dictionary": words.report.origin(answer.dictionary_from),
        "run": answer.run.run.id.to_string(),
    })
}

/// The first reasons, which differ.
pub fn shown_reasons(answer: &Answer, reasons: &[Reason], words: &Words) -> Vec<String> {
    let said = reasons.iter().take(MOST_REASONS);
    said.map(|reason| words.reason(reason, &answer.run))
        .collect()
}

/// All of them, held against the dictionary.
fn details(answer: &Answer, reasons: &[Reason], words: &Words) -> Vec<String> {
    let detail = |reason: &Reason| {
        let said = || words.reason(reason, &answer.run);
        words.reason_detail(reason).unwrap_or_else(said)
    };
    reasons.iter().map(detail).collect()
}

/// For people. Three parts at most, each by its likeliest fault and the reasons that convince most, or all of them with
/// what the dictionary has if `all`; the part that was asked about alone if one was.
pub fn diagnosis_text(answer: &Answer, all: bool) -> String {
    let d = &answer.diagnosis;
    let run = &answer.run.run;
    let counts = counts_of(run);
    let words = Language::English.words();
    let mut text = format!(
        "run {}  unit {}  {} steps, {} not passed, {} faults\n\n{}\n",
        run.id.short(),
        display_text::line(&run.unit_serial),
        count_short(&counts),
        counts.not_passed(),
        run.faults,
        words.concluded(answer)
    );
    if let Some(c) = &answer.why_not {
        let _ = write!(text, "\nwhy not {}; of its faults the likeliest is", c.lru);
        candidate_text(&mut text, (answer, c), all);
        return text.trim_end().to_owned();
    }
    if all {
        d.candidates
            .iter()
            .for_each(|c| candidate_text(&mut text, (answer, c), true));
    } else {
        first_of_parts(&d.candidates).for_each(|c| candidate_text(&mut text, (answer, c), false));
    }
    for two in d
        .two_faults
        .iter()
        .take(if all { usize::MAX } else { MOST_PARTS })
    {
        let _ = writeln!(
            text,
            "\n{:5.1} %  both {}",
            100.0 * two.probability,
            two.faults.join(" and ")
        );
    }
    let _ = writeln!(text, "\n{:5.1} %  no fault", 100.0 * d.no_fault);
    let likely: Vec<_> = first_of_parts(&d.candidates)
        .map(|c| c.lru.as_str())
        .collect();
    for (lru, ids) in &answer.traces {
        let ids: Vec<_> = ids.iter().map(Id::short).collect();
        if !ids.is_empty() && (all || likely.contains(&lru.as_str())) {
            let _ = writeln!(text, "traces of faults that name {lru}: {}", ids.join(", "));
        }
    }
    if !all {
        let run = run.id.short();
        let _ = writeln!(
            text,
            "`ptu diagnose {run} --all` shows all reasons, and what the dictionary has"
        );
    }
    text.trim_end().to_owned()
}

/// The likeliest fault of each of the likeliest parts.
pub fn first_of_parts(candidates: &[Candidate]) -> impl Iterator<Item = &Candidate> {
    let mut parts = BTreeSet::new();
    let first = candidates.iter().filter(move |c| parts.insert(&c.lru));
    first.take(MOST_PARTS)
}

fn candidate_text(text: &mut String, (answer, c): (&Answer, &Candidate), all: bool) {
    let words = Language::English.words();
    let _ = writeln!(
        text,
        "\n{:5.1} %  {}  ({}: {})",
        100.0 * c.probability,
        c.lru,
        c.fault,
        words.fault_text(&c.text)
    );
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
