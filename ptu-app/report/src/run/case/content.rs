//! Pages of a repair sheet behind its first: failures, faults of the case, work done, and on request all of both
//! runs.

use fault_db::{FaultEvent, FaultSummary, StepRecord};

use super::CaseSheet;
use super::first_page::clipped;
use crate::event_text::note_text;
use crate::naming;
use crate::run::block::{Block, Row, Table, Tone, sentence};
use crate::run::compare::comparison;
use crate::run::content::body;
use crate::run::plots::plots;
use crate::run::sources::Sources;
use crate::run::{Sheet, page, steps};
use crate::trace_notes::{note_text as run_note_text, noted_by};
use crate::words::{Words, fill};
use ptu_runs::clock::local;

/// Most pages for the failures.
const PAGES: usize = 2;
/// Failed steps in full, further rows of the comparison, faults, and events at most.
const MOST_STEPS: usize = 6;
const MOST_COMPARED: usize = 24;
const MOST_FAULTS: usize = 8;
const MOST_EVENTS: usize = 10;
const MOST_NOTES: usize = 3;

impl CaseSheet {
    pub(super) fn blocks(&self, words: &Words) -> Vec<Block> {
        let (mut blocks, rows) = self.first_page(words);
        blocks.push(Block::NewPage);
        let make = |steps| self.what_failed(rows, steps, words);
        let mut fewer = (0..=MOST_STEPS).rev().map(make);
        let fits = fewer.find(|blocks| page::count(blocks) <= PAGES);
        blocks.extend(fits.unwrap_or_else(|| make(0)));
        if self.with_annex {
            let when = [words.report.before, words.report.after];
            let runs = self.sheets().zip(when);
            blocks.extend(runs.flat_map(|(sheet, when)| annex(sheet, when, words)));
        }
        blocks
    }

    fn what_failed(&self, rows: usize, most: usize, words: &Words) -> Vec<Block> {
        let report = &words.report;
        let failed: Vec<StepRecord> = self.failed_steps().into_iter().cloned().collect();
        let shown = failed.get(..most).unwrap_or(&failed);
        let sources = Sources::of(shown);
        let mut blocks = vec![Block::Heading(report.failures.into())];
        let compared = self.compared();
        let further = compared.get(rows..).unwrap_or_default();
        if !further.is_empty() {
            let listed = further.get(..MOST_COMPARED).unwrap_or(further);
            blocks.push(Block::Table(comparison(listed, words)));
        }
        for of in shown.chunk_by(|a, b| a.procedure == b.procedure) {
            blocks.push(Block::Subheading(of[0].procedure.clone(), String::new()));
            blocks.push(Block::Table(steps::table(of, &sources, words)));
        }
        if failed.is_empty() {
            blocks.push(Block::Text(Tone::Plain, self.found_by(words)));
        }
        if let Some(n) = failed.len().checked_sub(most).filter(|n| *n > 0) {
            let more = fill(
                report.more_steps,
                &[("n", &n), ("run", &self.before.run.run.id)],
            );
            blocks.push(Block::Text(Tone::Plain, more));
        }
        blocks.extend(self.traced(words));
        blocks.extend(self.concluded(words));
        blocks.extend(self.faults(words));
        blocks.extend(self.done(words));
        blocks.extend(sources.blocks(words));
        blocks
    }

    /// The speeds around the first failure; what changed is on the first page.
    fn traced(&self, words: &Words) -> Option<Block> {
        let trace = self.trace_in(&self.before)?;
        let drawn = plots(trace.samples.as_ref().ok()?, words);
        let speeds = drawn.into_iter().next()?;
        let mut points = speeds.series.iter().flat_map(|series| &series.points);
        // A train that stood still has nothing to show there.
        let moves = points.any(|(_, speed)| *speed > 0.0);
        moves.then(|| Block::Plot(Box::new(speeds)))
    }

    /// Conclusion of the diagnosis of the run before.
    fn concluded(&self, words: &Words) -> Vec<Block> {
        let report = &words.report;
        let Ok(answer) = &self.before.diagnosis else {
            return Vec::new();
        };
        let said = words.concluded(answer);
        vec![
            Block::Heading(report.diagnosis.into()),
            Block::Facts(vec![(report.conclusion.into(), said)]),
        ]
    }

    fn faults(&self, words: &Words) -> Vec<Block> {
        let (common, report) = (&words.common, &words.report);
        let all = || std::iter::once(&self.fault.fault).chain(&self.fault.case);
        let row = |fault: &FaultSummary| {
            let cells = [
                fault.id.short(),
                naming::code(fault.code, &fault.code_name, words),
                self.before.part(&fault.lru, words),
                report.severity(&fault.severity).to_owned(),
                fault.occurrences.to_string(),
                local(fault.last_at_us),
                words.fault_state(fault.state).to_owned(),
            ];
            Row::words(cells)
        };
        let columns = [
            (common.fault, 0.11),
            (common.code, 0.21),
            (common.part, 0.24),
            (common.severity, 0.1),
            (report.seen, 0.07),
            (words.faults.last_seen, 0.18),
            (common.state, 0.09),
        ];
        let mut blocks = vec![
            Block::Heading(report.faults_of_case.into()),
            Block::Table(Table::of_words(columns, all().take(MOST_FAULTS).map(row))),
        ];
        if let Some(n) = all().count().checked_sub(MOST_FAULTS).filter(|n| *n > 0) {
            let more = fill(report.more_faults, &[("n", &n)]);
            blocks.push(Block::Text(Tone::Plain, more));
        }
        blocks
    }

    /// Work that was done last, and who checked the last run.
    fn done(&self, words: &Words) -> Vec<Block> {
        let (common, report) = (&words.common, &words.report);
        let seen_again = |event: &&FaultEvent| event.kind != "recurred";
        let all: Vec<_> = self.fault.events.iter().filter(seen_again).collect();
        let last = all.get(all.len().saturating_sub(MOST_EVENTS)..);
        let events = last.unwrap_or_default().iter();
        let run = &self.last().run;
        let notes = run.notes.iter().rev().take(MOST_NOTES).rev();
        let noted = notes.map(|note| {
            let (who, text) = (noted_by(note, run, words), run_note_text(note, words));
            done_row(note.at_us, common.note, &who, &text)
        });
        let rows = events.map(|event| self.told(event, words)).chain(noted);
        let columns = [
            (common.time, 0.18),
            (report.what, 0.16),
            (report.by_whom, 0.14),
            (common.note, 0.52),
        ];
        vec![
            Block::Heading(sentence(words.faults.what_was_done)),
            Block::Table(Table::of_words(columns, rows)),
        ]
    }

    fn told(&self, event: &FaultEvent, words: &Words) -> Row {
        let (common, report) = (&words.common, &words.report);
        let what = match (event.passed_run(), &event.repair, &event.cause, event.state) {
            (Some(_), ..) if event.is_proof() => report.event_proved,
            (Some(_), ..) => report.event_passed,
            (_, Some(_), ..) => report.event_repair,
            (_, _, Some(_), _) => words.faults.cause,
            (_, _, _, Some(state)) => words.fault_state(state),
            _ => common.note,
        };
        let note = match (event.passed_run(), &event.repair, &event.cause) {
            (Some(run), ..) => run.to_string(),
            (_, Some(repair), _) => {
                let serial = |serial: &Option<String>| serial.clone().unwrap_or("–".into());
                let (old, new) = (serial(&repair.serial_old), serial(&repair.serial_new));
                let part = self.before.part(&repair.part, words);
                format!("{part} {old} → {new} {}", repair.note)
            }
            (_, _, Some(cause)) => {
                let share = cause.probability.map(|p| format!(" {:.1} %", 100.0 * p));
                let part = self.before.part(&cause.part, words);
                format!("{part}{} {}", share.unwrap_or_default(), cause.note)
            }
            _ => note_text(&self.fault, event, words).into_owned(),
        };
        done_row(event.at_us, what, &event.who, &note)
    }
}

fn done_row(at_us: i64, what: &str, who: &str, note: &str) -> Row {
    let cells = [
        local(at_us),
        sentence(what),
        clipped(who, 40),
        clipped(note, 300),
    ];
    Row::words(cells)
}

/// All that a run's own sheet says, behind a heading.
fn annex(sheet: &Sheet, when: &str, words: &Words) -> Vec<Block> {
    let head = fill(
        words.report.annex,
        &[("when", &when), ("run", &sheet.run.run.id.short())],
    );
    let mut blocks = vec![Block::NewPage, Block::Title(head, String::new())];
    blocks.extend(body(sheet, words));
    blocks
}
