//! A train driven by hand: a sequence of notches and switches from a file, or keys on a terminal.

mod keyboard;
mod keys;
mod terminal;
#[cfg(test)]
mod tests;

use std::convert::Infallible;
use std::path::Path;
use std::sync::Arc;

use btu_rig::drive::Load;
use btu_rig::drive::manual::{Ending, ManualError, Outcome, Plan, Player, Sequence, SequenceError};
use btu_rig::train::TrainData;

use super::case::track;
use super::{DriveBench, Fixed, Request, train};
use crate::data::{ScriptsDirectory, read};
use crate::failure::Failure;

pub use keyboard::drive_by_hand;

/// What stands for a file when keys are asked for.
pub const KEYS: &str = "keys";
/// Folder of sequences.
const FOLDER: &str = "manual";
/// Line of a sequence that names none: level and straight.
const DEFAULT_LINE: &str = "test_track";

/// A run by hand, ready to be driven.
#[derive(Clone)]
pub struct ManualCase {
    /// Name of the sequence, or `keys`.
    pub name: String,
    /// Line as `--line` takes it.
    pub line: String,
    /// Unit configuration and line.
    pub bench: Arc<DriveBench>,
    /// The run.
    pub plan: Plan,
    /// Seed.
    pub seed: u64,
}

/// A run by hand that is over.
pub struct ManualRun {
    /// What was driven.
    pub case: ManualCase,
    /// The result.
    pub outcome: Outcome,
}

/// A sequence and what to call it.
struct Source {
    name: String,
    /// Its file, for messages.
    file: String,
    sequence: Sequence,
}

impl Request {
    /// The run by hand of a sequence, `manual/NAME.toml` or a file ending in .toml, or by keys. What
    /// the command says goes before what the file says.
    ///
    /// # Errors
    /// A name that is not known, a value out of range, or a sequence that cannot be driven.
    pub fn manual(
        &self,
        directory: &ScriptsDirectory,
        source: &str,
    ) -> Result<ManualCase, Failure> {
        self.fixed.check()?;
        let source = Source::find(directory, source)?;
        let mut train = train::train(directory, &self.train)?;
        let load_kg = self.passengers_kg(&mut train, &source)?;
        let asked = self.line.clone().or(source.sequence.line.clone());
        let name = asked.unwrap_or(DEFAULT_LINE.into());
        let line = track(directory, &name, &train)?;
        let section = match self.sections {
            Some(choice) => match choice.numbers(&line.content)?.as_slice() {
                [one] => *one,
                _ => return Err(Failure::usage("--manual drives on one section: name one")),
            },
            // A section of the sequence's own line is none of another.
            None => (source.sequence.section.filter(|_| self.line.is_none()))
                .or(line.content.sections.first().map(|section| section.section))
                .unwrap_or_default(),
        };
        let [bench] = <[_; 1]>::try_from(self.benches(directory, &train, &line)?)
            .map_err(|_| Failure::usage("--manual drives without a speed controller"))?;
        let mut sequence = source.sequence.clone();
        sequence.code = self.code.clone().or(sequence.code);
        let gradient = self.fixed.gradient_permille;
        sequence.gradient_permille = gradient.unwrap_or(sequence.gradient_permille);
        let config = &bench.config.content;
        let mut plan = Plan::new(config, &line.content, &train, section, sequence)
            .map_err(|error| source.refused(error))?;
        let fixed = Fixed {
            gradient_permille: None,
            ..self.fixed
        };
        (_, plan.conditions) = fixed.hold(load_kg, plan.conditions);
        plan.load_kg = load_kg;
        plan.by_hand = source.name == KEYS;
        Ok(ManualCase {
            name: source.name,
            line: name,
            bench,
            plan,
            seed: self.seed,
        })
    }

    /// Passengers the command asks for, or the sequence.
    fn passengers_kg(&self, train: &mut TrainData, source: &Source) -> Result<f64, Failure> {
        if let Some(kg) = train::load(train, self.mass_kg, self.load)? {
            return Ok(kg);
        }
        let loaded = train::load(train, None, Some(source.sequence.load));
        let kg = loaded.map_err(|failure| {
            Failure::usage(format!(
                "{}: {}",
                source.file,
                failure.to_string().trim_start_matches("--")
            ))
        })?;
        Ok(kg.unwrap_or(0.0))
    }
}

impl Source {
    fn find(directory: &ScriptsDirectory, asked: &str) -> Result<Self, Failure> {
        if asked == KEYS {
            return Ok(Self {
                name: KEYS.into(),
                file: KEYS.into(),
                sequence: Sequence {
                    title: "Driven by hand".into(),
                    ..Sequence::default()
                },
            });
        }
        let (name, file, parsed) = if asked.ends_with(".toml") {
            let name = Path::new(asked).file_stem().unwrap_or_default();
            let parsed = Sequence::from_toml(&read(Path::new(asked))?);
            (name.to_string_lossy().into_owned(), asked.into(), parsed)
        } else {
            let parse = |text: &str| Ok::<_, Infallible>(Sequence::from_toml(text));
            let loaded = directory.load(FOLDER, asked, "sequence", parse)?;
            let file = directory.shown(&format!("{FOLDER}/{asked}.toml"));
            (asked.to_owned(), file, loaded.content)
        };
        let wrong = |error: SequenceError| located(&file, &error);
        let sequence = parsed.map_err(wrong)?;
        Ok(Self {
            name,
            file,
            sequence,
        })
    }

    fn refused(&self, error: ManualError) -> Failure {
        match error {
            ManualError::Sequence(error) => located(&self.file, &error),
            error => Failure::usage(error.to_string()),
        }
    }
}

/// An error of a file at its line, as editors jump to it.
fn located(file: &str, error: &SequenceError) -> Failure {
    Failure::usage(format!("{file}:{}: {}", error.line, error.message))
}

impl ManualCase {
    /// Plays the sequence in virtual time.
    pub fn play(&self) -> Outcome {
        let mut bench = self.bench.fresh(self.seed);
        let mut player = Player::new(self.plan.clone());
        loop {
            let ticked = bench.tick();
            let now = bench.now();
            if let Err(failure) = ticked {
                return player.end(Ending::LinkLost(failure.to_string()));
            }
            if let Some(outcome) = player.step(now, bench.rig_mut()) {
                return outcome;
            }
        }
    }
}

impl ManualRun {
    /// It went to its end, and ATP let it.
    pub fn passed(&self) -> bool {
        matches!(self.outcome.ending, Ending::Played | Ending::ByHand)
    }

    /// The sequence that drives it again.
    pub fn sequence(&self) -> Sequence {
        let plan = &self.case.plan;
        self.outcome.sequence(Sequence {
            title: plan.sequence.title.clone(),
            line: Some(self.case.line.clone()),
            section: Some(plan.section.section),
            load: Load::Passengers(plan.load_kg),
            code: Some(plan.code.clone()),
            gradient_permille: plan.conditions.gradient_offset_permille,
            steps: Vec::new(),
            end_after_s: None,
        })
    }
}
