//! The first page of a repair sheet, which alone proves the repair: what, who, before and after, signatures.

use fault_db::is_practice;

use super::{CaseSheet, Standing};
use crate::naming;
use crate::run::block::{Block, Tone, sentence};
use crate::run::compare::{comparison, is_same, name_of};
use crate::run::content::signatures;
use crate::run::plots::close_up;
use crate::run::{Sheet, SheetTrace, page};
use crate::words::{Words, fill};
use ptu_runs::clock::local;

/// Most rows of the comparison.
const MOST_ROWS: usize = 8;
/// Most letters of a text: the rest is on the next page.
const MOST_LETTERS: usize = 180;

impl CaseSheet {
    /// The first page, and the number of rows of the comparison for which it has room.
    pub(super) fn first_page(&self, words: &Words) -> (Vec<Block>, usize) {
        let make = |rows| (self.with_rows(rows, words), rows);
        let mut fewer = (1..=MOST_ROWS).rev().map(make);
        let fits = fewer.find(|(blocks, _)| page::count(blocks) <= 1);
        fits.unwrap_or_else(|| make(0))
    }

    fn with_rows(&self, rows: usize, words: &Words) -> Vec<Block> {
        let report = &words.report;
        let (tone, said, beside) = self.verdict(words);
        let mut blocks = vec![
            Block::Title(
                report.case_sheet.into(),
                fill(report.document, &[("number", &self.number())]),
            ),
            Block::Verdict(tone, said, beside),
            Block::Facts(self.facts(words)),
            Block::Heading(report.before_and_after.into()),
        ];
        let compared = self.compared();
        match compared.len() {
            0 => blocks.push(Block::Text(Tone::Plain, report.no_step_saw_it.into())),
            _ => blocks.push(Block::Table(comparison(
                compared.get(..rows).unwrap_or(&compared),
                words,
            ))),
        }
        if let Some(n) = compared.len().checked_sub(rows).filter(|n| *n > 0) {
            let more = fill(report.more_compared, &[("n", &n)]);
            blocks.push(Block::Text(Tone::Plain, more));
        }
        let runs = self.sheets().zip([report.before, report.after]);
        blocks.extend(runs.filter_map(|(sheet, when)| self.plot(sheet, when, words)));
        blocks.push(signatures(words));
        blocks
    }

    /// Tone and words of the verdict, and the grounds for it.
    pub(super) fn verdict(&self, words: &Words) -> (Tone, String, String) {
        let report = &words.report;
        let after = self.after.as_ref().map(|sheet| &sheet.run.run);
        let runs = after.map_or_else(String::new, |run| {
            let at = local(run.finished_at_us.unwrap_or(run.started_at_us));
            let (run, n) = (run.id.short(), self.passed.len());
            fill(
                report.passed_since,
                &[("run", &run), ("at", &at), ("n", &n)],
            )
        });
        let (tone, said, beside) = match &self.standing {
            Standing::Proved => (Tone::Good, report.proved, runs),
            Standing::Vouched(who, at_us, _) => {
                let who = clipped(who, 40);
                let at = local(*at_us);
                let by = fill(report.vouched_by, &[("who", &who), ("at", &at)]);
                (Tone::Plain, report.vouched, by)
            }
            Standing::Claimed if after.is_none() => {
                (Tone::Bad, report.claimed, report.no_run_since.to_owned())
            }
            Standing::Claimed => (Tone::Bad, report.claimed, runs),
            Standing::CameBack => {
                let at = local(self.fault.fault.last_at_us);
                let seen = fill(report.seen_again, &[("at", &at)]);
                (Tone::Bad, report.came_back, seen)
            }
            Standing::NotRepaired => (Tone::Bad, report.not_repaired, String::new()),
        };
        (tone, said.to_owned(), beside)
    }

    fn facts(&self, words: &Words) -> Vec<(String, String)> {
        let (common, report) = (&words.common, &words.report);
        let run = &self.last().run.run;
        let both = |of: fn(&Sheet) -> String| {
            let (before, after) = (of(&self.before), self.after.as_ref().map(of));
            match after {
                Some(after) if after != before => fill(
                    report.before_then_after,
                    &[("before", &or_dash(&before)), ("after", &or_dash(&after))],
                ),
                _ => before,
            }
        };
        let record = self.repair.as_ref().map(|repair| &repair.record);
        let serial = |serial: Option<&Option<String>>| {
            clipped(serial.and_then(Option::as_deref).unwrap_or(""), 60)
        };
        let done = self.repair.as_ref().map(|repair| {
            let mut said = local(repair.at_us);
            for more in [&repair.who, &repair.record.note] {
                if !more.trim().is_empty() {
                    said += &format!(", {}", clipped(more, 100));
                }
            }
            said
        });
        let mut facts = vec![
            (report.depot, clipped(&self.depot, 80)),
            (common.unit, unit(run)),
            (
                common.train_no,
                both(|sheet| clipped(&sheet.run.run.train, 60)),
            ),
            (
                report.tester,
                both(|sheet| clipped(&sheet.run.run.operator, 60)),
            ),
            (report.symptom, self.symptom_said(words)),
            (report.found_by, self.found_by(words)),
            (common.part, self.last().part(self.part(), words)),
            (
                words.faults.serial_old,
                serial(record.map(|r| &r.serial_old)),
            ),
            (
                words.faults.serial_new,
                serial(record.map(|r| &r.serial_new)),
            ),
            (report.repair_made, done.unwrap_or_default()),
            (report.run_before, told(&self.before, words)),
            (
                report.run_after,
                self.after
                    .as_ref()
                    .map_or("–".into(), |sheet| told(sheet, words)),
            ),
            (
                report.program,
                both(|sheet| format!("ptu {}", sheet.run.run.app_version)),
            ),
        ];
        if let Standing::Vouched(.., why) = &self.standing {
            facts.push((common.note, clipped(why, MOST_LETTERS)));
        }
        let practice = self.practice(words);
        facts.extend((!practice.is_empty()).then_some((report.simulated, practice)));
        facts
            .into_iter()
            .map(|(name, value)| (sentence(name), value))
            .collect()
    }

    /// Symptom as reported with the unit.
    fn symptom_said(&self, words: &Words) -> String {
        let said = self.symptom.as_ref();
        said.map_or_else(
            || words.report.nobody.to_owned(),
            |symptom| sentence(&words.content(&symptom.name)),
        )
    }

    /// The check that failed first, in words.
    pub(super) fn found_by(&self, words: &Words) -> String {
        let failed = self.failed_steps();
        let said = match failed.first() {
            Some(step) => {
                let message = words.found(&step.findings, &step.message);
                format!("{}, {}: {message}", step.procedure, name_of(step, words))
            }
            None => {
                let seen = self.fault.occurrences.first();
                seen.map_or_else(String::new, |seen| {
                    words.found(&seen.findings, &seen.message).into_owned()
                })
            }
        };
        match said.trim() {
            "" => naming::event_named(&self.fault.fault.code_name, words),
            said => clipped(said, MOST_LETTERS),
        }
    }

    /// Sentence that names the runs on a simulated unit or with injected faults: practice, no unit in service.
    fn practice(&self, words: &Words) -> String {
        let report = &words.report;
        let told = |sheet: &Sheet, when: &str| {
            let run = &sheet.run.run;
            let simulated =
                is_practice(&run.source, None).then(|| report.simulated_unit.to_owned());
            let faults = run.injected.as_deref();
            let injected = faults
                .map(|faults| fill(report.with_injected, &[("faults", &clipped(faults, 80))]));
            let what: Vec<_> = simulated.into_iter().chain(injected).collect();
            (!what.is_empty()).then(|| format!("{when}: {}", what.join(", ")))
        };
        let runs = self.sheets().zip([report.before, report.after]);
        let all: Vec<_> = runs.filter_map(|(sheet, when)| told(sheet, when)).collect();
        all.join("; ")
    }

    /// The trace of a run that shows the first of the steps that failed.
    pub(super) fn trace_in<'a>(&self, sheet: &'a Sheet) -> Option<&'a SheetTrace> {
        self.failed_steps().into_iter().find_map(|step| {
            let all = sheet.run.steps.iter();
            let same: Vec<_> = all
                .filter(|other| is_same(other, step))
                .map(|other| other.index)
                .collect();
            let mut traces = sheet.traces.iter();
            traces.find(|trace| trace.steps.iter().any(|step| same.contains(step)))
        })
    }

    /// A close-up of the first failure of the case, where a run has a trace of it.
    fn plot(&self, sheet: &Sheet, when: &str, words: &Words) -> Option<Block> {
        let trace = self.trace_in(sheet)?;
        let mut plot = close_up(trace.samples.as_ref().ok()?, words)?;
        let id = trace.id.short();
        plot.title = fill(
            words.report.close_up,
            &[
                ("when", &sentence(when)),
                ("what", &plot.title),
                ("id", &id),
            ],
        );
        Some(Block::Plot(Box::new(plot)))
    }
}

/// The unit by serial number, kind and configuration.
fn unit(run: &fault_db::RunSummary) -> String {
    let about = [&run.unit_kind, &run.unit_config_name].map(|text| text.trim());
    let about: Vec<_> = about.into_iter().filter(|text| !text.is_empty()).collect();
    format!("{} ({})", clipped(&run.unit_serial, 60), about.join(", "))
}

/// A run by its number, time and verdict.
fn told(sheet: &Sheet, words: &Words) -> String {
    let run = &sheet.run.run;
    let (_, said) = super::verdict(run, words);
    format!("{}, {}, {said}", run.id, local(run.started_at_us))
}

fn or_dash(text: &str) -> &str {
    if text.is_empty() { "–" } else { text }
}

/// The first `most` letters.
pub(super) fn clipped(text: &str, most: usize) -> String {
    let text = text.trim();
    match text.char_indices().nth(most) {
        Some((end, _)) => format!("{}…", text[..end].trim_end()),
        None => text.to_owned(),
    }
}
