//! Trains, the units in them, and how good each unit is.

use crate::bench::{CHECKS, Wear};
use crate::catalogue::KINDS;
use crate::chance::Chance;

const LINES: [&str; 4] = ["line2", "line5", "line6", "line8"];

/// A unit that has one of the faults that are not closed.
#[derive(Clone, Copy)]
pub struct Slot {
    /// The fault, if one is not closed.
    pub fault: Option<fault_db::Id>,
    pub state: fault_db::FaultState,
    /// The part that is really broken; none: nothing is, or no longer.
    pub broken: Option<&'static str>,
    /// When it was as good as new.
    pub new_since_us: i64,
    /// Told apart from the faults before it.
    pub turn: u32,
}

pub struct Unit {
    pub serial: String,
    /// Empty: a spare, on the bench.
    pub train: String,
    pub line: &'static str,
    pub software: &'static str,
    /// How often things happen to it, against the others.
    pub factor: f64,
    /// The same of each kind.
    pub leaning: Vec<f64>,
    pub slots: Vec<Slot>,
    pub wear: Vec<Wear>,
    pub seen_us: i64,
}

pub struct Fleet {
    pub units: Vec<Unit>,
}

impl Fleet {
    /// Two units in each train, and every sixth a spare.
    pub fn new(units: usize, start_us: i64, chance: &mut Chance) -> Self {
        let spares = units / 6;
        let trains = (units - spares).div_ceil(2);
        let unit = |number: usize, chance: &mut Chance| {
            let slot = |chance: &mut Chance| Slot {
                fault: None,
                state: fault_db::FaultState::Closed,
                broken: None,
                new_since_us: start_us - (chance.between(0.0, 400.0) * 86_400e6) as i64,
                turn: 0,
            };
            let place = number / 2;
            let (train, line) = if place < trains && number < units - spares {
                let line = place * LINES.len() / trains;
                (
                    format!("{}{:02}", &LINES[line][4..], place + 1),
                    LINES[line],
                )
            } else {
                (String::new(), chance.one_of(&LINES))
            };
            Unit {
                serial: format!("ATC-{:04}", 1001 + number * 7),
                train,
                line,
                software: chance.one_of(&["1.2.0", "1.2.0", "1.3.1", "1.3.2"]),
                factor: chance.factor(0.5),
                leaning: KINDS.iter().map(|_| chance.factor(0.9)).collect(),
                slots: KINDS.iter().map(|_| slot(chance)).collect(),
                wear: CHECKS
                    .iter()
                    .map(|check| Wear::new(check, chance))
                    .collect(),
                seen_us: start_us,
            }
        };
        let mut units: Vec<_> = (0..units).map(|number| unit(number, chance)).collect();
        let mean = units.iter().map(|unit| unit.factor).sum::<f64>() / units.len() as f64;
        units.iter_mut().for_each(|unit| unit.factor /= mean);
        Self { units }
    }

    /// A spare takes the place of a unit in a train.
    pub fn swap(&mut self, chance: &mut Chance) {
        let in_trains = |unit: &Unit| !unit.train.is_empty();
        let (running, spare): (Vec<_>, Vec<_>) =
            (0..self.units.len()).partition(|&place| in_trains(&self.units[place]));
        if running.is_empty() || spare.is_empty() {
            return;
        }
        let (out, into) = (chance.one_of(&running), chance.one_of(&spare));
        let train = std::mem::take(&mut self.units[out].train);
        self.units[into].train = train;
        self.units[into].line = self.units[out].line;
    }
}
