//! The structure of a unit and its train (`scripts/units/structure.toml`): the parts that each signal comes through, from
//! the sensors on, and so the parts on the way of what a step judges.
//!
//! A fault dictionary is checked against the structure: the first step of a procedure that fails under a mode must have
//! the mode's part on its way. Later steps may fail because the first did, and an event that the unit logs fails any
//! step. Any exception is a finding, about the file or about the unit; the file lists those that are understood.

mod chain;
mod link;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use btu_rig::procedure::Procedure;
use btu_rig::procedure::plan::{Connection, Expectation, Step};
use diagnosis::{Cell, CheckName, Dictionary, Group, Measure, Mode, Relations, Shared};
use protocol::event::Event;
use protocol::injection::FaultCatalogue;
use protocol::signal::{Origin, Signal};
use protocol::{LruId, Verdict};
use serde::Deserialize;

use crate::data::ScriptsDirectory;
use crate::failure::{Failure, FileTrouble};
use link::WayStep;
pub use link::{Chain, Link, LinkOutput};

/// Path of the structure's file in the scripts directory.
pub const FILE: &str = "units/structure.toml";

/// A mode fails a step if, at one of its levels, more than this share of the runs does not pass the step.
const FAILS: f64 = 0.5;

/// The file as it is written.
#[derive(Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Written {
    /// Parts on the way of every signal that has a way.
    everywhere: Vec<LruId>,
    /// Procedures in which the bench has no part.
    without_bench: Vec<String>,
    /// Further parts on the way of every step, in procedures that a laptop runs.
    on_the_train: Vec<LruId>,
    ways: Vec<WrittenWay>,
    groups: Vec<WrittenGroup>,
    shared: Vec<WrittenShared>,
    off_way: Vec<KnownOffWay>,
}

#[derive(Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
struct WrittenWay {
    #[serde(default)]
    signals: Vec<String>,
    /// Events that come through the same parts, from the same signals.
    #[serde(default)]
    events: Vec<String>,
    /// Signals that `signals` and `events` are made of.
    #[serde(default)]
    from: Vec<String>,
    /// Parts that make `signals` and `events`.
    #[serde(default)]
    parts: Vec<LruId>,
}

/// Parts that checks do not always tell apart.
#[derive(Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
struct WrittenGroup {
    parts: Vec<LruId>,
    /// Measure that tells which part has failed, worded to follow "to tell which, ".
    measure: String,
    /// The measure in Korean.
    measure_ko: String,
}

/// A part that several parts share.
#[derive(Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
struct WrittenShared {
    part: LruId,
    reaches: Vec<LruId>,
    measure: String,
    measure_ko: String,
}

/// Fault modes that are known to fail a step off the way of their part.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct KnownOffWay {
    /// Names of the fault modes.
    pub faults: Vec<String>,
    /// The step, `procedure: step`.
    pub step: String,
    /// Reason for which the step fails all the same.
    pub because: String,
}

/// A fault mode that fails a step off the way of its part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OffWay {
    /// Fault mode.
    pub fault: String,
    /// First step of the procedure that the fault mode fails.
    pub step: CheckName,
}

/// The parts that each signal comes through.
#[derive(Debug)]
pub struct Structure {
    /// Last step of the way of each signal and event, as the file has it.
    steps: BTreeMap<LinkOutput, WayStep>,
    /// Parts on the way of every signal and event.
    everywhere: Vec<LruId>,
    on_the_train: Vec<LruId>,
    /// Parts that checks do not always tell apart, and what several parts share.
    pub relations: Relations,
    /// Fault modes that are known to fail a step off the way of their part, and why.
    pub known_off_way: Vec<KnownOffWay>,
}

impl Structure {
    /// Reads the structure of the unit and train whose parts a catalogue lists.
    ///
    /// # Errors
    /// The file is missing or wrong.
    pub fn load(directory: &ScriptsDirectory, catalogue: &FaultCatalogue) -> Result<Self, Failure> {
        let parts: Vec<_> = catalogue.lrus.iter().map(|part| &part.id).collect();
        let mut structure = Self::from_toml(&directory.text(FILE)?, &parts)
            .map_err(|error| Failure::usage(FileTrouble::wrong(directory.shown(FILE), error)))?;
        let of_bench = catalogue.lrus.iter().filter(|part| part.of_bench);
        structure.relations.of_bench = of_bench.map(|part| part.id.clone()).collect();
        Ok(structure)
    }

    /// Reads and checks the file; `parts` are those that can be replaced.
    fn from_toml(text: &str, parts: &[&LruId]) -> Result<Self, String> {
        let written: Written = toml::from_str(text).map_err(|error| error.to_string())?;
        let named = written.ways.iter().flat_map(|way| &way.parts);
        let mut named = named
            .chain(&written.everywhere)
            .chain(&written.on_the_train)
            .chain(written.groups.iter().flat_map(|group| &group.parts))
            .chain(written.shared.iter().flat_map(|shared| &shared.reaches))
            .chain(written.shared.iter().map(|shared| &shared.part));
        if let Some(part) = named.find(|part| !parts.contains(part)) {
            return Err(format!(
                "no part \"{part}\"; `ptu catalog parts` lists them"
            ));
        }
        let mut steps = BTreeMap::new();
        for way in &written.ways {
            let from = way.from.iter().map(|name| signal(name));
            let made = WayStep {
                parts: way.parts.clone(),
                from: from.collect::<Result<_, _>>()?,
            };
            for name in &way.signals {
                if steps.insert(signal(name)?, made.clone()).is_some() {
                    return Err(format!("signal {name} has two ways"));
                }
            }
            for name in &way.events {
                steps.insert(event(name)?, made.clone());
            }
        }
        let of_unit = Signal::ALL.iter();
        let mut of_unit = of_unit.filter(|signal| signal.definition().origin == Origin::Unit);
        if let Some(signal) =
            of_unit.find(|signal| !steps.contains_key(&LinkOutput::Signal(**signal)))
        {
            return Err(format!("the unit's signal {} has no way", signal.name()));
        }
        let (mut makers, mut on_the_way) = (BTreeMap::new(), BTreeMap::new());
        let is_recorded = |signal: &Signal| signal.definition().origin == Origin::Rig;
        for (signal, step) in steps
            .iter()
            .filter_map(|(made, step)| Some((made.signal()?, step)))
        {
            let name = signal.name().to_owned();
            makers.insert(name.clone(), step.parts.iter().cloned().collect());
            let from = step
                .from
                .iter()
                .filter_map(|made| made.signal())
                .filter(is_recorded);
            on_the_way.insert(name, from.map(|signal| signal.name().to_owned()).collect());
        }
        Ok(Self {
            steps,
            everywhere: written.everywhere,
            on_the_train: written.on_the_train,
            relations: Relations {
                groups: written.groups.into_iter().map(Group::from).collect(),
                shared: written.shared.into_iter().map(Shared::from).collect(),
                of_bench: BTreeSet::new(),
                without_bench: written.without_bench,
                on_the_way,
                makers,
            },
            known_off_way: written.off_way,
        })
    }

    /// The signals that have a way, each with the parts that it comes through.
    pub fn signals(&self) -> impl Iterator<Item = (Signal, BTreeSet<LruId>)> {
        let signals = self.steps.keys().filter_map(|made| made.signal());
        signals.map(|signal| (signal, self.way(LinkOutput::Signal(signal))))
    }

    /// All parts from `last` back to the sensors, by whatever ways, and those that are everywhere; none if `last` has
    /// no way.
    fn way(&self, last: LinkOutput) -> BTreeSet<LruId> {
        let Some(step) = self.steps.get(&last) else {
            return BTreeSet::new();
        };
        let mut parts: BTreeSet<_> = step.parts.iter().chain(&self.everywhere).cloned().collect();
        let (mut seen, mut ahead) = (BTreeSet::new(), step.from.clone());
        while let Some(made) = ahead.pop() {
            if let Some(step) = self.steps.get(&made).filter(|_| seen.insert(made)) {
                parts.extend(step.parts.iter().cloned());
                ahead.extend(&step.from);
            }
        }
        parts
    }

    /// The parts on the way of what a step looks at, its signals and the events that it waits for, and the part that it
    /// suspects.
    pub fn of_step(&self, procedure: &Procedure, step: &Step) -> BTreeSet<LruId> {
        let mut way: BTreeSet<_> = step.suspect.iter().cloned().collect();
        if procedure.needs == Connection::Ptu {
            way.extend(self.on_the_train.iter().cloned());
        }
        step.for_each_signal(&mut |signal| {
            way.extend(self.way(LinkOutput::Signal(signal)));
        });
        for expectation in &step.expectations {
            if let Expectation::Logs { event, .. } = expectation {
                way.extend(self.way(LinkOutput::Event(*event)));
                way.extend(event.definition().lru.clone());
            }
        }
        way
    }

    /// The modes of a dictionary whose first failed step in a procedure is off the way of their part.
    pub fn off_way(&self, procedures: &[Arc<Procedure>], dictionary: &Dictionary) -> Vec<OffWay> {
        let mut found = Vec::new();
        for procedure in procedures {
            let steps = procedure.steps.iter().filter_map(|step| {
                let name = CheckName {
                    procedure: procedure.id.clone(),
                    step: step.name.clone(),
                };
                Some((
                    dictionary.place(&name)?,
                    name,
                    self.of_step(procedure, step),
                ))
            });
            let steps: Vec<_> = steps.collect();
            for mode in &dictionary.modes {
                let first = steps.iter().find(|(place, ..)| fails(mode, *place));
                found.extend(first.and_then(|(_, step, way)| {
                    let is_off = !way.contains(&mode.name.lru);
                    is_off.then(|| OffWay {
                        fault: mode.name.id.clone(),
                        step: step.clone(),
                    })
                }));
            }
        }
        found
    }

    /// Fault modes of `off_way` that the file does not list.
    pub fn not_understood(&self, off_way: Vec<OffWay>) -> Vec<OffWay> {
        let is_known = |off: &OffWay| {
            self.known_off_way.iter().any(|known| {
                known.faults.contains(&off.fault) && known.step == off.step.to_string()
            })
        };
        off_way.into_iter().filter(|off| !is_known(off)).collect()
    }
}

impl From<WrittenGroup> for Group {
    fn from(written: WrittenGroup) -> Self {
        Self {
            parts: written.parts,
            measure: Measure {
                english: written.measure,
                korean: written.measure_ko,
            },
        }
    }
}

impl From<WrittenShared> for Shared {
    fn from(written: WrittenShared) -> Self {
        Self {
            part: written.part,
            reaches: written.reaches,
            measure: Measure {
                english: written.measure,
                korean: written.measure_ko,
            },
        }
    }
}

/// Whether a mode fails a step by what the step judges: events logged meanwhile fail any step, and do not count.
fn fails(mode: &Mode, place: usize) -> bool {
    let fails = |cell: &Cell| {
        let failed = cell
            .signatures
            .iter()
            .filter(|(outcome, _)| outcome.result != Verdict::Passed && outcome.signs.is_empty());
        let failed: u32 = failed.map(|(_, runs)| runs).sum();
        f64::from(failed) > FAILS * f64::from(cell.runs())
    };
    let mut cells = mode
        .columns
        .iter()
        .filter_map(|level| level.cells.get(&place));
    cells.any(fails)
}

fn signal(name: &str) -> Result<LinkOutput, String> {
    let signal = Signal::from_name(name);
    let signal =
        signal.ok_or_else(|| format!("no signal \"{name}\"; `ptu catalog signals` lists them"));
    signal.map(LinkOutput::Signal)
}

fn event(name: &str) -> Result<LinkOutput, String> {
    let event = Event::from_name(name).ok_or_else(|| format!("no event \"{name}\""));
    event.map(LinkOutput::Event)
}

#[cfg(test)]
mod tests;
