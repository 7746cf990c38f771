//! Automatic runs as printed pages, which the window shows: the tables, facts and plots of the other reports, in either
//! language.

use ptu_bench::drive::{Case, Driven};

use super::facts::{conditions, off};
use super::plots::plots;
use super::tables;
use crate::plot::Plot;
use crate::run::block::{Block, Tone, sentence};
use crate::run::{Paper, Printed};
use crate::words::{Words, fill};

/// Runs that were driven, to be shown or printed.
pub struct DriveSheet {
    runs: Vec<Driven>,
}

impl DriveSheet {
    /// Of these runs; those of one section stand side by side.
    pub fn new(runs: Vec<Driven>) -> Self {
        Self { runs }
    }
}

impl Printed for DriveSheet {
    fn paper(&self, words: &Words) -> Paper {
        let case = self.runs.first().map(|run| &run.case);
        let config = case.map(|case| case.bench.config.content.name.clone());
        let seed = case.map_or(0, |case| case.seed);
        let mut blocks = vec![Block::Title(
            words.drive.report.into(),
            words.report.simulated_unit.into(),
        )];
        let groups = self
            .runs
            .chunk_by(|a, b| a.case.plan.section.section == b.case.plan.section.section);
        for (place, group) in groups.enumerate() {
            if place > 0 {
                blocks.push(Block::NewPage);
            }
            blocks.extend(of_section(group, words));
        }
        Paper {
            name: words.drive.report,
            unit: config.unwrap_or_default(),
            short: words.drive.title.into(),
            number: format!("{} {seed}", words.content("Seed")),
            program: format!("ptu {}", env!("CARGO_PKG_VERSION")),
            at_us: 0,
            across: None,
            blocks,
        }
    }
}

/// The runs of one section, a controller each.
fn of_section(runs: &[Driven], words: &Words) -> Vec<Block> {
    let Some(Driven { case, .. }) = runs.first() else {
        return Vec::new();
    };
    let said = &words.drive;
    let (line, section) = (&case.bench.line.content.name, case.plan.section.section);
    let mut heading = fill(said.section_of, &[("line", line), ("section", &section)]);
    if let [run] = runs {
        heading = format!("{heading}, {}", run.case.controller.name());
    }
    let mut blocks = vec![Block::Heading(heading)];
    blocks.extend(runs.iter().map(|run| verdict(run, runs.len() == 1, words)));
    blocks.push(Block::Facts(facts(case, words)));
    blocks.push(Block::Heading(said.figures.into()));
    blocks.push(Block::Table(tables::of_runs(runs).printed(words)));
    blocks.push(Block::Heading(said.plots.into()));
    let plots = plots(runs).into_iter();
    blocks.extend(plots.map(|plot| Block::Plot(Box::new(in_words(plot, words)))));
    blocks.push(Block::Heading(said.on_the_way.into()));
    for run in runs {
        if runs.len() > 1 {
            let name = run.case.controller.name();
            blocks.push(Block::Subheading(name.into(), String::new()));
        }
        let events = tables::events(&run.outcome.landmarks);
        blocks.push(Block::Table(events.printed(words)));
    }
    blocks
}

/// How a run ended, and where the train stands.
fn verdict(run: &Driven, alone: bool, words: &Words) -> Block {
    let ending = run.outcome.ending.to_string();
    let mut ending = sentence(&words.content(&ending));
    if !alone {
        ending = format!("{}: {ending}", run.case.controller.name());
    }
    let tone = if run.aligned() { Tone::Good } else { Tone::Bad };
    Block::Verdict(tone, ending, stop(run, words))
}

fn stop(run: &Driven, words: &Words) -> String {
    let said = &words.drive;
    let Some(error) = run.outcome.stop_error_m else {
        return said.did_not_stop.to_owned();
    };
    let tolerance_m = run.case.tolerance_m();
    let wording = match (error > 0.0, error.abs() <= tolerance_m) {
        (false, true) => said.before_within,
        (false, false) => said.before_outside,
        (true, true) => said.past_within,
        (true, false) => said.past_outside,
    };
    let size = off(error.abs());
    let size = size.trim_start_matches('+');
    let tolerance_cm = format!("{:.0}", tolerance_m * 100.0);
    fill(wording, &[("error", &size), ("tolerance", &tolerance_cm)])
}

/// Train and day, and what the bench was made of.
fn facts(case: &Case, words: &Words) -> Vec<(String, String)> {
    let bench = &case.bench;
    let section = &case.plan.section;
    let file = |name: &str, crc: u32| format!("{name}, {crc:08x}");
    let more = [
        (
            "Unit configuration",
            file(&bench.config.content.name, bench.config.crc),
        ),
        (
            "Track database",
            file(&bench.line.content.name, bench.line.crc),
        ),
        (
            "Length to the stop point",
            format!("{:.2} m", section.stop_m - section.start_m),
        ),
    ];
    let all = conditions(case).into_iter().chain(more);
    all.map(|(name, value)| (words.content(name).into_owned(), value))
        .collect()
}

/// A plot with all its words in one language.
fn in_words(mut plot: Plot, words: &Words) -> Plot {
    let named = plot.series.iter_mut().map(|series| &mut series.name);
    let named = named.chain(plot.places.iter_mut().map(|place| &mut place.name));
    let named = named.chain([&mut plot.title, &mut plot.x_label, &mut plot.y_label]);
    for text in named {
        *text = words.content(text).into_owned();
    }
    plot
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use btu_rig::drive::Load;
    use protocol::config::ControllerKind;
    use ptu_bench::data::ScriptsDirectory;
    use ptu_bench::drive::{Fixed, Request, SectionChoice, drive_all};
    use ptu_bench::stop::Stop;

    use super::*;
    use crate::run::block::Cell;
    use crate::words::Language;

    fn sheet(controllers: &[ControllerKind]) -> DriveSheet {
        let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts");
        let scripts = ScriptsDirectory::find(Some(&scripts)).expect("scripts");
        let request = Request {
            line: None,
            sections: Some(SectionChoice::Range(61, 62)),
            controllers: controllers.to_vec(),
            train: "line6".into(),
            mass_kg: None,
            load: Some(Load::Full),
            fixed: Fixed::default(),
            code: None,
            unit_config: "sg100".into(),
            settings: Vec::new(),
            seed: 1,
        };
        let cases = request.cases(&scripts).expect("cases");
        DriveSheet::new(drive_all(cases, 2, &Stop::default(), &mut |_| {}))
    }

    /// Everything that is read on the pages.
    fn texts(blocks: &[Block]) -> Vec<String> {
        let mut texts = Vec::new();
        for block in blocks {
            match block {
                Block::Title(a, b) | Block::Subheading(a, b) | Block::Verdict(_, a, b) => {
                    texts.extend([a.clone(), b.clone()]);
                }
                Block::Heading(text) | Block::Text(_, text) => texts.push(text.clone()),
                Block::Facts(facts) => {
                    texts.extend(facts.iter().flat_map(|(a, b)| [a.clone(), b.clone()]));
                }
                Block::Table(table) => {
                    texts.extend(table.columns.iter().map(|column| column.name.clone()));
                    let cells = table.rows.iter().flat_map(|row| &row.cells);
                    texts.extend(cells.filter_map(|(cell, _)| match cell {
                        Cell::Text(_, text) | Cell::Verdict(_, text) => Some(text.clone()),
                        Cell::Gauge(_) => None,
                    }));
                }
                Block::Plot(plot) => {
                    texts.extend([&plot.title, &plot.x_label, &plot.y_label].map(Clone::clone));
                    texts.extend(plot.series.iter().map(|series| series.name.clone()));
                    texts.extend(plot.places.iter().map(|place| place.name.clone()));
                }
                Block::NewPage | Block::Signatures(..) => {}
            }
        }
        texts
    }

    /// Goal: a Korean reader meets no English in the report of a run. Method: runs of all controllers and of one alone; what is
    /// left in small Latin letters are names of controllers, files and events, and units.
    #[test]
    fn a_korean_report_of_automatic_runs_has_no_english() {
        const NAMES: [&str; 3] = ["servo", "fuzzy", "pss"];
        for controllers in [&[ControllerKind::Servo][..], &ControllerKind::ALL] {
            let paper = sheet(controllers).paper(Language::Korean.words());
            let texts = texts(&paper.blocks);
            assert!(texts.len() > 100, "{texts:?}");
            let is_english = |text: &&String| {
                let mut words = text.split(|letter: char| !letter.is_ascii_alphanumeric());
                let is_small = |word: &str| word.chars().all(|letter| letter.is_ascii_lowercase());
                words.any(|word| word.len() > 2 && is_small(word) && !NAMES.contains(&word))
            };
            let english: Vec<_> = texts.iter().filter(is_english).collect();
            assert!(english.is_empty(), "{english:#?}");
        }
    }
}
