//! A diagnosis, as text and as JSON.

use std::fmt::Write as _;

use diagnosis::Candidate;
use fault_db::Id;
use protocol::display_text;
use serde_json::{Value, json};

use crate::words::Language;
use ptu_bench::run_diagnosis::Answer;

/// The contract's keys first.
pub fn diagnosis_json(answer: &Answer) -> Value {
    let d = &answer.diagnosis;
    let traces = |lru: &str| -> Vec<String> {
        let of_part = answer.traces.get(lru).into_iter().flatten();
        of_part.map(Id::to_string).collect()
    };
    let candidate = |c: &Candidate| {
        json!({
            "lru": c.lru, "fault": c.fault, "probability": c.probability,
            "for": c.for_it, "against": c.against, "text": c.text, "traces": traces(c.lru.as_str()),
        })
    };
    json!({
        "candidates": d.candidates.iter().map(candidate).collect::<Vec<_>>(),
        "why_not": answer.why_not.as_ref().map(candidate),
        "next_check": d.next_check,
        "conclusion": d.conclusion.english,
        "conclusion_ko": Language::Korean.words().sentence(&d.conclusion),
        "finding": d.finding,
        "group": d.group.as_ref().map(|group| json!({
            "parts": group.parts, "measure": group.measure.english, "measure_ko": group.measure.korean,
        })),
        "lrus": d.lrus.iter().filter(|part| part.probability >= 0.001).collect::<Vec<_>>(),
        "two_faults": d.two_faults,
        "no_fault": d.no_fault,
        "warnings": answer.warnings,
        "dictionary": Language::English.words().report.origin(answer.dictionary_from),
        "run": answer.run.run.id.to_string(),
    })
}

/// For people.
pub fn diagnosis_text(answer: &Answer) -> String {
    let d = &answer.diagnosis;
    let run = &answer.run.run;
    let mut text = format!(
        "run {}  unit {}  {} steps, {} not passed, {} faults\n\n{}\n",
        run.id.short(),
        display_text::line(&run.unit_serial),
        run.steps,
        run.steps_not_passed,
        run.faults,
        d.conclusion.english
    );
    for c in &d.candidates {
        candidate_text(&mut text, c);
    }
    for two in &d.two_faults {
        let _ = writeln!(
            text,
            "\n{:5.1} %  both {}",
            100.0 * two.probability,
            two.faults.join(" and ")
        );
    }
    let _ = writeln!(text, "\n{:5.1} %  no fault", 100.0 * d.no_fault);
    if let Some(c) = &answer.why_not {
        let _ = write!(text, "\nwhy not {}; of its faults the likeliest is", c.lru);
        candidate_text(&mut text, c);
    }
    for (lru, ids) in &answer.traces {
        let ids: Vec<_> = ids.iter().map(Id::short).collect();
        if !ids.is_empty() {
            let _ = writeln!(text, "traces of faults that name {lru}: {}", ids.join(", "));
        }
    }
    text.trim_end().to_owned()
}

fn candidate_text(text: &mut String, c: &Candidate) {
    let _ = writeln!(
        text,
        "\n{:5.1} %  {}  ({}: {})",
        100.0 * c.probability,
        c.lru,
        c.fault,
        c.text
    );
    for (sign, reasons) in [('+', &c.for_it), ('-', &c.against)] {
        for reason in reasons {
            let _ = writeln!(text, "         {sign} {reason}");
        }
    }
}
