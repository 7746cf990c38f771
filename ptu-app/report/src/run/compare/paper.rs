//! Two runs beside each other as a printed page.

use super::table;
use super::{Differs, RunComparison, Tally};
use crate::run::block::{Block, Tone};
use crate::run::content::verdict;
use crate::run::paper::across;
use crate::run::{Paper, Printed};
use crate::words::{Words, fill};
use ptu_runs::clock::local;

impl RunComparison {
    /// Sentence with the numbers of changed steps.
    pub fn headline(&self, words: &Words) -> String {
        let report = &words.report;
        let tally = self.tally();
        let mut said = fill(
            report.compared_said,
            &[
                ("now", &tally.pass_now),
                ("before", &tally.passed_before),
                ("neither", &tally.in_neither),
            ],
        );
        for (n, wording) in [
            (tally.only_a, report.only_in_a),
            (tally.only_b, report.only_in_b),
        ] {
            if n > 0 {
                said += " ";
                said += &fill(wording, &[("n", &n)]);
            }
        }
        said
    }

    /// Warnings of differences that make the two runs hard to compare, a sentence each.
    pub fn warnings(&self, words: &Words) -> Vec<String> {
        let report = &words.report;
        let two = |wording, a: &String, b: &String| fill(wording, &[("a", a), ("b", b)]);
        let said = |differs: Differs| match differs {
            Differs::Unit(a, b) => two(report.other_units, &a, &b),
            Differs::Configuration(a, b) if a == b => report.changed_config.to_owned(),
            Differs::Configuration(a, b) => two(report.other_configs, &a, &b),
            Differs::Line(a, b) => two(report.other_lines, &a, &b),
            Differs::Scripts(names) if names.is_empty() => report.other_directory.to_owned(),
            Differs::Scripts(names) => fill(report.other_scripts, &[("names", &names.join(", "))]),
            Differs::Unfinished(run) => fill(report.run_unfinished, &[("run", &run.short())]),
            Differs::Order => report.other_order.to_owned(),
        };
        self.differs().into_iter().map(said).collect()
    }

    /// A run by its number, time and verdict.
    pub(super) fn told(run: &fault_db::RunSummary, words: &Words) -> String {
        let (_, said) = verdict(run, words);
        let (id, at) = (run.id, local(run.started_at_us));
        format!("{id}, {}, {at}, {said}", run.unit_serial)
    }

    fn blocks(&self, words: &Words) -> Vec<Block> {
        let report = &words.report;
        let pairs = self.steps();
        let told = pairs
            .iter()
            .filter(|pair| self.all || !pair.passed_in_both());
        let steps = table::steps(told, words);
        let runs = [(report.run_a, &self.a), (report.run_b, &self.b)];
        let mut blocks = vec![
            Block::Title(report.comparison.into(), self.title(words)),
            Block::Text(tone(self.tally()), self.headline(words)),
            Block::Facts(
                runs.map(|(name, run)| (name.to_owned(), Self::told(&run.run, words)))
                    .into(),
            ),
        ];
        let warnings = self.warnings(words).into_iter();
        blocks.extend(warnings.map(|said| Block::Text(Tone::Bad, said)));
        if !steps.rows.is_empty() {
            blocks.push(Block::Table(steps));
        }
        if let Some(said) = self.rest(words) {
            blocks.push(Block::Text(Tone::Plain, said));
        }
        blocks
    }

    /// Sentence with the number of steps that are not shown; none if all are.
    pub(super) fn rest(&self, words: &Words) -> Option<String> {
        let pairs = self.steps();
        let rest = pairs.iter().filter(|pair| pair.passed_in_both()).count();
        let said = fill(words.report.passed_in_both, &[("n", &rest)]);
        (rest > 0 && !self.all).then_some(said)
    }

    fn title(&self, words: &Words) -> String {
        let [a, b] = [&self.a, &self.b].map(|run| run.run.id.short());
        fill(words.report.of_two_runs, &[("a", &a), ("b", &b)])
    }
}

/// Whether the second run is better than the first one.
fn tone(tally: Tally) -> Tone {
    match tally {
        Tally { passed_before, .. } if passed_before > 0 => Tone::Bad,
        Tally { pass_now, .. } if pass_now > 0 => Tone::Good,
        _ => Tone::Plain,
    }
}

impl Printed for RunComparison {
    fn paper(&self, words: &Words) -> Paper {
        let (a, b) = (&self.a.run, &self.b.run);
        let number = format!("{}-{}", a.id.short(), b.id.short());
        Paper {
            name: words.report.comparison,
            unit: b.unit_serial.clone(),
            short: number.clone(),
            number,
            program: format!("ptu {}", b.app_version),
            at_us: b.finished_at_us.unwrap_or(b.started_at_us),
            across: (a.is_practice() || b.is_practice()).then(|| across(words)),
            blocks: self.blocks(words),
        }
    }
}
