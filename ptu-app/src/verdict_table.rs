//! The table at the end of a run: procedures with their verdicts, what did not pass, and the faults found.

use std::collections::{BTreeMap, BTreeSet};

use fault_db::{RunDetail, StepCounts, StepKind, StepRecord};
use protocol::display_text;

use ptu_report::words::{Language, Words, fill};
use ptu_report::{count_short, coverage_text};
use ptu_runs::coverage::{Coverage, counts_of};
use ptu_runs::stored::{by_procedure, from_stored, of_procedure, standing};
use ptu_runs::table::Table;
use ptu_runs::terminal::verdict;

/// The procedure and its step; for a failure outside the steps, the place of the failure.
fn named(step: &StepRecord, words: &Words) -> String {
    let name = match words.language {
        Language::English => words.step(&step.name, [step.turn, step.turns], step.kind),
        Language::Korean => words.record(step),
    };
    format!("{}: {name}", step.procedure)
}

/// Table of attempts at steps that could not be tested and were made again.
fn repeated(run: &RunDetail, words: &Words) -> String {
    let mut table = Table::headed(&[words.terminal.repeated_step, words.terminal.reason]);
    let attempts = run.steps.iter();
    let rows: Vec<_> = attempts
        .filter(|step| step.kind == StepKind::Attempt)
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    for step in rows {
        table.row([named(step, words), words.found_in(step).into_owned()]);
    }
    format!("\n\n{}", table.render())
}

/// Table of the reasons for skipped steps, each reason once.
fn skipped(run: &RunDetail, words: &Words) -> String {
    let mut reasons = BTreeMap::<_, BTreeSet<(&str, Option<u32>)>>::new();
    let skipped = standing(&run.steps);
    for step in skipped.filter(|step| step.verdict == fault_db::Verdict::Skipped) {
        let steps = reasons.entry(words.found_in(step)).or_default();
        steps.insert((&step.procedure, step.place));
    }
    if reasons.is_empty() {
        return String::new();
    }
    let mut table = Table::headed(&[words.terminal.skipped_steps, words.terminal.reason]);
    for (reason, steps) in reasons {
        table.row([steps.len().to_string(), reason.into_owned()]);
    }
    format!("\n\n{}", table.render())
}

/// Procedures with their verdicts, what did not pass, and the faults found.
pub fn verdict_table(run: &RunDetail, words: &Words) -> String {
    let mut text = match run.steps[..] {
        // An imported log of a unit, or a run that never began.
        [] => fill(words.terminal.no_steps, &[("source", &run.run.source)]),
        _ => part(run, words) + &procedures(run, words).render(),
    };
    text.push_str(&not_passed(run, words));
    text.push_str(&repeated(run, words));
    text.push_str(&skipped(run, words));
    if !run.faults.is_empty() {
        let (common, terminal) = (&words.common, &words.terminal);
        let mut table = Table::headed(&[
            common.fault,
            common.code,
            common.part,
            common.severity,
            words.faults.seen,
            terminal.trace,
        ])
        .parts([2]);
        for fault in &run.faults {
            let trace = fault.trace_id.map_or_else(String::new, |id| id.short());
            table.row([
                fault.id.short(),
                format!("{} {}", fault.code, fault.code_name),
                fault.lru.clone(),
                words.severity_name(&fault.severity).to_owned(),
                fault.occurrences.to_string(),
                trace,
            ]);
        }
        text.push_str(&format!("\n\n{}", table.render()));
    }
    text.push_str(&format!("\n\n{}", summary(run, words)));
    text
}

/// Steps that did not pass, repeated steps, and the verdict.
pub fn failures(run: &RunDetail, words: &Words) -> String {
    let (failed, repeated) = (not_passed(run, words), repeated(run, words));
    format!("{failed}{repeated}\n\n{}", summary(run, words))
        .trim_start()
        .to_owned()
}

/// Steps that did not pass, each with the reason.
fn not_passed(run: &RunDetail, words: &Words) -> String {
    let failed: Vec<_> = run
        .steps
        .iter()
        .filter(|step| {
            !matches!(
                step.verdict,
                fault_db::Verdict::Passed | fault_db::Verdict::Skipped
            )
        })
        .collect();
    if failed.is_empty() {
        return String::new();
    }
    let common = &words.common;
    let mut table =
        Table::headed(&[common.verdict, common.step, words.terminal.reason]).verdicts(0);
    for step in failed {
        let verdict = words.verdict_name(from_stored(step.verdict)).to_owned();
        table.row([
            verdict,
            named(step, words),
            words.found_in(step).into_owned(),
        ]);
    }
    format!("\n\n{}", table.render())
}

fn procedures(run: &RunDetail, words: &Words) -> Table {
    let (common, terminal) = (&words.common, &words.terminal);
    let mut table = Table::headed(&[
        common.procedure,
        common.verdict,
        terminal.steps,
        common.passed,
        terminal.bench_time,
    ])
    .verdicts(1);
    for (procedure, mine) in by_procedure(&run.steps) {
        let counts = StepCounts::of(mine.iter().copied());
        let verdict = of_procedure(mine.iter().copied(), run.run.verdict);
        let time: i64 = mine.iter().map(|step| step.bench_time_us).sum();
        table.row([
            procedure.to_owned(),
            words.verdict_name(from_stored(verdict)).to_owned(),
            counts.planned.to_string(),
            counts.passed.to_string(),
            format!("{:.1} s", time as f64 / 1e6),
        ]);
    }
    table
}

fn summary(run: &RunDetail, words: &Words) -> String {
    let terminal = &words.terminal;
    let bench_s = run.run.bench_time_us.unwrap_or(0) as f64 / 1e6;
    let wall_s = run.run.wall_time_us.unwrap_or(0) as f64 / 1e6;
    let continued = (run.run.continues).map_or_else(String::new, |earlier| {
        let said = fill(terminal.continues, &[("run", &earlier.short())]);
        format!("\n{said}")
    });
    let came = fill(
        terminal.summary,
        &[
            ("run", &run.run.id.short()),
            ("unit", &display_text::line(&run.run.unit_serial)),
            ("steps", &count_short(&counts_of(&run.run), words)),
            ("faults", &run.faults.len()),
            ("verdict", &verdict(words.run_verdict(&run.run))),
        ],
    );
    let (bench, wall) = (format!("{bench_s:.1}"), format!("{wall_s:.2}"));
    let took = fill(terminal.times, &[("bench", &bench), ("wall", &wall)]);
    format!("{came}\n{took}{continued}")
}

/// First line of the table where steps were skipped: verdict and coverage.
fn part(run: &RunDetail, words: &Words) -> String {
    let coverage = coverage_text(&Coverage::of_run(run), words);
    coverage.map_or_else(String::new, |part| {
        format!("{}: {part}\n\n", verdict(words.run_verdict(&run.run)))
    })
}
