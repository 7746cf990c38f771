//! Content of a test sheet, block after block: verdict, notes and failures first, then all that was
//! run, with what and by whom.

use fault_db::{FaultState, RunState, RunSummary, StepCounts, StepRecord, Verdict};

use super::block::{Block, Cell, Row, RowKind, Table, Tone, sentence};
use super::diagnosis::diagnosis;
use super::plots::plots;
use super::settled::settled;
use super::sources::Sources;
use super::steps::{self, passed, tone};
use super::the_run::the_run;
use super::{Sheet, SheetTrace};
use crate::departure::Departure;
use crate::naming;
use crate::trace_notes::{note_text, noted_by};
use crate::words::{Words, fill};
use crate::{count_text, coverage_text};
use ptu_runs::clock::{local, local_zoned};
use ptu_runs::coverage::{Coverage, counts_of};
use ptu_runs::stored::by_procedure;

pub fn blocks(sheet: &Sheet, words: &Words) -> Vec<Block> {
    let mut blocks = head(sheet, words);
    blocks.extend(body(sheet, words));
    blocks.push(Block::Heading(words.report.signatures.into()));
    blocks.push(signatures(words));
    blocks
}

/// Lines for who tested and who approves.
pub fn signatures(words: &Words) -> Block {
    let report = &words.report;
    let signing = [report.tester_signs, report.approver_signs];
    Block::Signatures(signing.map(str::to_owned).into(), report.date.into())
}

/// All blocks of a sheet but its head and its signatures.
pub fn body(sheet: &Sheet, words: &Words) -> Vec<Block> {
    let sources = Sources::of(&sheet.run.steps);
    let mut blocks = settled(sheet, words);
    blocks.extend(summary(sheet, words));
    blocks.extend(notes(sheet, words));
    blocks.extend(failures(sheet, &sources, words));
    blocks.extend(faults(sheet, words));
    blocks.extend(diagnosis(sheet, words));
    blocks.extend(the_run(sheet, words));
    blocks.extend(all_steps(sheet, &sources, words));
    blocks.extend(sources.blocks(words));
    blocks.extend(scripts(sheet, words));
    blocks
}

/// Tone and words of the verdict on a run.
pub fn verdict(run: &RunSummary, words: &Words) -> (Tone, &'static str) {
    match (run.verdict, run.state) {
        (Some(verdict), _) => (tone(verdict), words.common.stored_verdict(verdict)),
        (None, RunState::Running) => (Tone::Soft, words.common.running),
        (None, _) => (Tone::Bad, words.common.interrupted),
    }
}

fn head(sheet: &Sheet, words: &Words) -> Vec<Block> {
    let (run, report) = (&sheet.run.run, &words.report);
    let coverage = Coverage::of_run(&sheet.run);
    let part = coverage_text(&coverage, words);
    let counted = part.unwrap_or_else(|| count_text(&coverage.steps, words));
    let who: [(&str, &dyn std::fmt::Display); 2] =
        [("serial", &run.unit_serial), ("run", &run.id.short())];
    let (tone, said) = verdict(run, words);
    let below = format!(
        "{}   {}",
        fill(report.of_unit, &who),
        local_zoned(run.started_at_us)
    );
    let mut blocks = vec![
        Block::Title(report.sheet.into(), below),
        Block::Verdict(tone, sentence(said), counted),
    ];
    if let Some(departure) = Departure::of(&sheet.run) {
        blocks.push(Block::Facts(vec![departure.fact(words)]));
    }
    if run.verdict.is_none() {
        blocks.push(Block::Text(Tone::Bad, report.not_finished.into()));
    }
    if let Some(injected) = run.injected.as_ref().filter(|faults| !faults.is_empty()) {
        blocks.push(Block::Facts(vec![(
            report.injected.into(),
            injected.clone(),
        )]));
    }
    blocks
}

/// Numbers of different steps by verdict.
fn summary(sheet: &Sheet, words: &Words) -> Vec<Block> {
    if sheet.run.steps.is_empty() {
        return Vec::new();
    }
    let (counts, common) = (counts_of(&sheet.run.run), &words.common);
    let of = |verdict| (common.stored_verdict(verdict), tone(verdict));
    // Failures outside steps are counted apart: without them the verdict may have no reason here.
    let outside = ((words.report.outside, Tone::Bad), counts.outside);
    let all = [
        (of(Verdict::Passed), counts.passed),
        (of(Verdict::Failed), counts.failed),
        (of(Verdict::Error), counts.error),
        ((common.skipped, Tone::Soft), counts.not_run()),
    ];
    let all: Vec<_> = (all.into_iter())
        .chain((counts.outside > 0).then_some(outside))
        .collect();
    let share = 1.0 / all.len() as f32;
    let columns = all.iter().map(|((name, _), _)| (*name, share));
    let counts = all.iter().map(|((_, tone), count)| {
        let tone = if *count == 0 { Tone::Soft } else { *tone };
        Cell::Text(tone, count.to_string())
    });
    let counts = Row::new(RowKind::Head, counts);
    vec![
        Block::Heading(words.report.summary.into()),
        Block::Table(Table::of_words(columns, [counts])),
    ]
}

/// Steps that did not pass, each with its trace; a trace of several is drawn with the first.
fn failures(sheet: &Sheet, sources: &Sources<'_>, words: &Words) -> Vec<Block> {
    let report = &words.report;
    let failed = || sheet.run.steps.iter().filter(|step| !passed(step.verdict));
    let mut blocks = Vec::new();
    if failed().next().is_some() {
        blocks.push(Block::Heading(report.failures.into()));
    }
    let mut drawn = Vec::new();
    for step in failed() {
        blocks.push(Block::Subheading(step.procedure.clone(), String::new()));
        let this: &[StepRecord] = std::slice::from_ref(step);
        blocks.push(Block::Table(steps::table(this, sources, words)));
        for trace in sheet
            .traces
            .iter()
            .filter(|t| t.steps.contains(&step.index))
        {
            if drawn.contains(&trace.id) {
                let shown = fill(report.trace_shown, &[("id", &trace.id.short())]);
                blocks.push(Block::Text(Tone::Soft, shown));
            } else {
                drawn.push(trace.id);
                blocks.extend(traced(trace, words));
            }
        }
    }
    let others: Vec<_> = sheet
        .traces
        .iter()
        .filter(|t| !drawn.contains(&t.id))
        .collect();
    if !others.is_empty() {
        blocks.push(Block::Heading(report.other_traces.into()));
    }
    for trace in others {
        blocks.extend(traced(trace, words));
    }
    if sheet.more_traces > 0 {
        let more = fill(report.more_traces, &[("n", &sheet.more_traces)]);
        blocks.push(Block::Text(Tone::Soft, more));
    }
    blocks
}

fn traced(trace: &SheetTrace, words: &Words) -> Vec<Block> {
    let report = &words.report;
    let id = trace.id.short();
    match &trace.samples {
        Ok(samples) => {
            let names = trace.faults.iter();
            let names = names.map(|name| naming::event_named(name, words));
            let faults = names.collect::<Vec<_>>().join(", ");
            let mut head = match trace.faults.is_empty() {
                true => fill(report.trace_of_passed, &[("id", &id)]),
                false => fill(report.trace_of, &[("id", &id), ("faults", &faults)]),
            };
            if samples.partial {
                head += &format!(" ({})", report.cut_short);
            }
            let plots = plots(samples, words).into_iter();
            std::iter::once(Block::Text(Tone::Soft, head))
                .chain(plots.map(|plot| Block::Plot(Box::new(plot))))
                .collect()
        }
        Err(why) => {
            let missing = fill(
                report.trace_missing,
                &[("id", &id), ("why", &words.trouble(why))],
            );
            vec![Block::Text(Tone::Bad, missing)]
        }
    }
}

fn faults(sheet: &Sheet, words: &Words) -> Vec<Block> {
    let (common, report) = (&words.common, &words.report);
    let mut blocks = vec![Block::Heading(report.faults.into())];
    if sheet.run.faults.is_empty() {
        blocks.push(Block::Text(Tone::Plain, report.no_faults.into()));
        return blocks;
    }
    let columns = [
        (common.code, 0.27),
        (common.part, 0.21),
        (common.severity, 0.09),
        (report.seen, 0.06),
        (report.first_seen, 0.18),
        (common.state, 0.09),
        (report.trace, 0.1),
    ];
    let rows = sheet.run.faults.iter().map(|fault| {
        let state: FaultState = fault.state;
        let cells = [
            naming::code(fault.code, &fault.code_name, words),
            sheet.part(&fault.lru, words),
            report.severity(&fault.severity).to_owned(),
            fault.occurrences.to_string(),
            local(fault.first_at_us),
            words.fault_state(state).to_owned(),
            fault.trace_id.map_or_else(String::new, |id| id.short()),
        ];
        Row::words(cells)
    });
    blocks.push(Block::Table(Table::of_words(columns, rows)));
    blocks
}

fn notes(sheet: &Sheet, words: &Words) -> Vec<Block> {
    let report = &words.report;
    if sheet.run.notes.is_empty() {
        return Vec::new();
    }
    let rows = sheet.run.notes.iter().map(|note| {
        let who = noted_by(note, &sheet.run, words);
        let cells = [local(note.at_us), who, note_text(note, words)];
        Row::words(cells)
    });
    let columns = [
        (words.common.time, 0.18),
        (report.noted_by, 0.16),
        (report.noted, 0.66),
    ];
    vec![
        Block::Heading(report.notes.into()),
        Block::Table(Table::of_words(columns, rows)),
    ]
}

fn all_steps(sheet: &Sheet, sources: &Sources<'_>, words: &Words) -> Vec<Block> {
    let report = &words.report;
    let mut blocks = Vec::new();
    for (procedure, mine) in by_procedure(&sheet.run.steps) {
        let counts = StepCounts::of(mine.iter().copied());
        let told: [(&str, &dyn std::fmt::Display); 2] =
            [("passed", &counts.passed), ("of", &counts.planned)];
        let counted = fill(report.procedure_passed, &told);
        blocks.push(Block::Subheading(procedure.to_owned(), counted));
        blocks.push(Block::Table(steps::table(mine, sources, words)));
    }
    if !blocks.is_empty() {
        blocks.insert(0, Block::Heading(report.procedures.into()));
    }
    blocks
}

fn scripts(sheet: &Sheet, words: &Words) -> Vec<Block> {
    let report = &words.report;
    let scripts = &sheet.run.scripts;
    if scripts.is_empty() {
        return Vec::new();
    }
    let rows = scripts.iter();
    let rows = rows.map(|script| Row::words([script.path.clone(), script.sha256.clone()]));
    vec![
        Block::Heading(report.scripts.into()),
        Block::Table(Table::of_words(
            [(report.script, 0.35), ("SHA-256", 0.65)],
            rows,
        )),
    ]
}
