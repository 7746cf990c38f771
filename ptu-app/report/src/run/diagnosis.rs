//! The diagnosis on a test sheet: the conclusion, and the parts and fault modes that are likely.

use super::Sheet;
use super::block::{Align, Block, Column, Row, Table, Tone, sentence};
use crate::diagnosis::{MOST_PARTS, Possible, ranked, shown_reasons};
use crate::words::{Words, fill};
use diagnosis::Conclusion;
use fault_db::Verdict;
use protocol::lru::from_stored;
use ptu_runs::run_diagnosis::Answer;

/// Parts less likely than this are not named.
const LEAST_NAMED: f64 = 0.01;

/// The blocks of the diagnosis, or why there is none.
pub(super) fn diagnosis(sheet: &Sheet, words: &Words) -> Vec<Block> {
    let report = &words.report;
    // A run that passed with steps that are in no dictionary, as before service, has no question open.
    if let Ok(answer) = &sheet.diagnosis
        && answer.run.run.verdict == Some(Verdict::Passed)
        && matches!(
            answer.diagnosis.conclusion,
            Conclusion::NothingSeen { made: 0, .. }
        )
    {
        return Vec::new();
    }
    let mut blocks = vec![Block::Heading(report.diagnosis.into())];
    match &sheet.diagnosis {
        Err(why) => {
            let none = fill(report.no_diagnosis, &[("why", &words.trouble(why))]);
            blocks.push(Block::Text(Tone::Soft, none));
        }
        Ok(answer) => {
            blocks.push(Block::Facts(concluded(answer, words)));
            let table = candidates(sheet, answer, words);
            if !table.rows.is_empty() {
                blocks.push(Block::Table(table));
            }
        }
    }
    blocks
}

fn concluded(answer: &Answer, words: &Words) -> Vec<(String, String)> {
    let (report, diagnosis) = (&words.report, &answer.diagnosis);
    let age = if answer.dictionary_current {
        report.current
    } else {
        report.stale
    };
    let mut facts = vec![(report.conclusion.to_owned(), words.concluded(answer))];
    if let Some(next) = &diagnosis.next_check {
        let next = format!("{} ({:.0} s)", words.check(&next.check), next.cost_s);
        facts.push((report.next_check.to_owned(), next));
    }
    let dictionary = format!("{}, {age}", report.origin(answer.dictionary_from));
    facts.push((report.dictionary.to_owned(), dictionary));
    let warnings = answer.warnings.iter();
    facts.extend(warnings.map(|warning| (sentence(words.common.note), words.trouble(warning))));
    facts
}

fn candidates(sheet: &Sheet, answer: &Answer, words: &Words) -> Table {
    let report = &words.report;
    let likely = ranked(&answer.diagnosis, MOST_PARTS).into_iter();
    let likely = likely.filter_map(|(probability, possible)| match possible {
        Possible::Part(candidate) if probability >= LEAST_NAMED => Some((probability, candidate)),
        _ => None,
    });
    let rows = likely.map(|(probability, candidate)| {
        let cells = [
            format!("{:.1} %", 100.0 * probability),
            sheet.part(candidate.lru.as_str(), words),
            format!("{}: {}", candidate.fault, words.fault_text(&candidate.text)),
            shown_reasons(answer, &candidate.for_it, words).join("\n"),
        ];
        Row::words(cells)
    });
    Table {
        columns: vec![
            Column::new(report.probability, 0.1, Align::Right),
            Column::new(words.common.part, 0.2, Align::Left),
            Column::new(report.mode, 0.28, Align::Left),
            Column::new(report.speaks_for, 0.42, Align::Left),
        ],
        rows: rows.collect(),
    }
}

impl Sheet {
    /// A part by the name people use for it, with its identifier.
    pub(super) fn part(&self, lru: &str, words: &Words) -> String {
        let name = self.parts.name(lru, words.language);
        match from_stored(lru) {
            Some(_) if !name.eq_ignore_ascii_case(lru) => format!("{name} ({lru})"),
            Some(_) => lru.to_owned(),
            None => words.common.no_part.to_owned(),
        }
    }
}
