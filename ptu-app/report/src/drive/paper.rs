//! Runs as printed blocks, which page and window show: verdict, train and day, figures, plots, and what happened.

use ptu_runs::drive::monte_carlo::MonteCarlo;
use ptu_runs::drive::{Case, DriveBench, Driven};

use super::facts::{Fact, conditions, standing, title};
use super::plots::{plots, plots_of_many};
use super::{Outcomes, Results, tables};
use crate::plot::Plot;
use crate::run::block::{Block, Tone, sentence};
use crate::run::{Paper, Printed};
use crate::words::{Words, fill};

impl Printed for Results {
    fn paper(&self, words: &Words) -> Paper {
        let said = &words.drive;
        let mut blocks = Vec::new();
        let (name, case) = match &self.outcomes {
            Outcomes::Single(runs) => {
                let section = |run: &Driven| run.case.plan.section.section;
                for group in runs.chunk_by(|a, b| section(a) == section(b)) {
                    if !blocks.is_empty() {
                        blocks.push(Block::NewPage);
                    }
                    blocks.extend(of_section(group, words));
                }
                (said.report, runs.first().map(|run| &run.case))
            }
            Outcomes::Many(many) => {
                blocks.extend(many.iter().flat_map(|many| of_many(many, words)));
                (said.many, many.first().map(|many| &many.case))
            }
        };
        let unit = words.report.simulated_unit;
        blocks.insert(0, Block::Title(name.into(), unit.into()));
        if let Some(made) = &self.made {
            blocks.push(Block::Text(Tone::Soft, made.clone()));
        }
        Paper {
            name,
            unit: case.map_or_else(String::new, |case| case.bench.config.content.name.clone()),
            short: said.title.into(),
            number: format!(
                "{} {}",
                words.content("Seed"),
                case.map_or(0, |case| case.seed)
            ),
            program: format!("ptu {}", env!("CARGO_PKG_VERSION")),
            blocks,
            ..Paper::default()
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
    blocks.push(facts(conditions(case), case, words));
    blocks.extend(measured(&tables::of_runs(runs), plots(runs), words));
    blocks.push(Block::Heading(said.on_the_way.into()));
    for run in runs {
        if runs.len() > 1 {
            let name = run.case.controller.name();
            blocks.push(Block::Subheading(name.into(), String::new()));
        }
        let events = tables::events(&run.outcome.landmarks, words);
        blocks.push(Block::Table(events.printed(words)));
    }
    blocks
}

/// Sentences on the end of a run and the place of the train.
fn verdict(run: &Driven, alone: bool, words: &Words) -> Block {
    let mut ending = sentence(&words.ending(&run.outcome.ending));
    if !alone {
        ending = format!("{}: {ending}", run.case.controller.name());
    }
    let tone = if run.aligned() { Tone::Good } else { Tone::Bad };
    Block::Verdict(tone, ending, standing(run, words))
}

/// Many runs of one case.
fn of_many(many: &MonteCarlo, words: &Words) -> Vec<Block> {
    let (done, asked) = (many.trials.len(), many.asked);
    let percent = |metres| many.within(metres) * 100.0;
    let within = format!(
        "within ±10 cm {:.2} %, ±30 cm {:.2} %",
        percent(0.1),
        percent(0.3)
    );
    let (past, failures) = (many.past_1m(), many.failures().count());
    let beside = format!("more than 1 m past: {past}, did not stop: {failures}");
    let tone = if many.passed() { Tone::Good } else { Tone::Bad };
    let heading = format!("{}, {done} of {asked} runs", title(&many.case));
    let mut blocks = vec![
        Block::Heading(heading),
        Block::Verdict(tone, within, beside),
        facts(conditions(&many.case), &many.case, words),
    ];
    blocks.extend(measured(&tables::of_many(many), plots_of_many(many), words));
    blocks.extend([
        Block::Heading("Worst runs".into()),
        Block::Text(
            Tone::Soft,
            "Repeat one with --scattered --seed SEED in place of --monte-carlo.".into(),
        ),
        Block::Table(tables::worst(many).printed(words)),
    ]);
    blocks
}

/// Figures and plots, each under its heading.
fn measured(figures: &tables::Table, plots: Vec<Plot>, words: &Words) -> Vec<Block> {
    let said = &words.drive;
    let mut blocks = vec![
        Block::Heading(said.figures.into()),
        Block::Table(figures.printed(words)),
        Block::Heading(said.plots.into()),
    ];
    let plots = plots.into_iter();
    blocks.extend(plots.map(|plot| Block::Plot(Box::new(in_words(plot, words)))));
    blocks
}

/// Train and day, the way, and what the bench was made of.
fn facts(mut known: Vec<Fact>, case: &Case, words: &Words) -> Block {
    let section = &case.plan.section;
    let length_m = section.stop_m - section.start_m;
    known.push(("Length to the stop point", format!("{length_m:.2} m")));
    known.extend(made_of(&case.bench, case.seed));
    let said = |(name, value): Fact| (words.content(name).into_owned(), value);
    Block::Facts(known.into_iter().map(said).collect())
}

/// The files that a bench was made of, with their check sums, the keys changed, and the seed.
fn made_of(bench: &DriveBench, seed: u64) -> Vec<Fact> {
    let file = |name: &str, crc: u32| format!("{name}, {crc:08x}");
    let (config, line) = (&bench.config, &bench.line);
    let mut made = vec![
        ("Unit configuration", file(&config.content.name, config.crc)),
        ("Track database", file(&line.content.name, line.crc)),
    ];
    if !bench.settings.is_empty() {
        let settings: Vec<_> = bench.settings.iter().map(ToString::to_string).collect();
        made.push(("Keys changed", settings.join("; ")));
    }
    made.push(("Seed", seed.to_string()));
    made
}

/// A plot with all its words in one language.
fn in_words(mut plot: Plot, words: &Words) -> Plot {
    let named = plot.series.iter_mut().map(|series| &mut series.name);
    let named = named.chain(plot.places.iter_mut().map(|place| &mut place.name));
    let named = named.chain([&mut plot.title, &mut plot.x_label, &mut plot.y_label]);
    for text in named {
        *text = words.content(text).into_owned();
    }
    if !plot.shaded.is_empty() {
        plot.title = fill(words.drive.shaded, &[("plot", &plot.title)]);
    }
    plot
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use btu_rig::drive::Load;
    use protocol::config::ControllerKind;
    use ptu_runs::data::ScriptsDirectory;
    use ptu_runs::drive::{Fixed, Request, SectionChoice, drive_all};
    use ptu_runs::stop::Stop;

    use super::*;
    use crate::run::page::pages;
    use crate::run::tests::words_of;
    use crate::words::Language;

    fn sheet(controllers: &[ControllerKind]) -> Results {
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
        Results::of_runs(drive_all(cases, 2, &Stop::default(), &mut |_| {}))
    }

    /// Goal: a Korean reader meets no English in the report of a run. Method: runs of all controllers and of one alone; what is
    /// left in small Latin letters are names of controllers, files, events and keys of a configuration, and units.
    #[test]
    fn a_korean_report_of_automatic_runs_has_no_english() {
        const NAMES: [&str; 6] = ["servo", "fuzzy", "pss", "ato", "controller", "ptu"];
        for controllers in [&[ControllerKind::Servo][..], &ControllerKind::ALL] {
            let pages = pages(&sheet(controllers), Language::Korean.words()).expect("pages");
            let said: Vec<_> = pages.iter().map(|page| words_of(page)).collect();
            assert!(said.concat().len() > 5_000, "{said:?}");
            let is_english = |word: &&str| {
                let is_small = word.chars().all(|letter| letter.is_ascii_lowercase());
                word.len() > 2 && is_small && !NAMES.contains(word)
            };
            for page in said {
                let words = page.split(|letter: char| !letter.is_ascii_alphanumeric());
                let english: Vec<_> = words.filter(is_english).collect();
                assert!(english.is_empty(), "{english:?} in {page}");
            }
        }
    }
}
