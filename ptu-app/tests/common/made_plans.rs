//! Material of made runs: procedures, of their own or of the fault dictionary, plans, and listeners.

use Kind::*;
use btu_rig::procedure::{Procedure, Verdict};
use diagnosis::{Dictionary, Mode};
use protocol::Duration;
use ptu_report::event_lines::EventLines;
use ptu_runs::bench_worker::Progress;
use ptu_runs::run::{BenchContents, Listener, SessionEvent};
use serde_json::{from_value, json};

/// Texts in a step's name behind its mark.
const NAMES: &str = "| 속도 코드 25: 경보| a;b,\"c\"| <b>&amp;</b>|=1+1| \u{202e}rtl| tab\there| 漢字 😀| \u{fffe}\u{1b}[31m| (cab)| self-test| 1 of 7 steps run, all passed";

/// Course of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Passed,
    Failed,
    Error,
    LinkLost,
    Stopped,
    Broken,
    Adaptive,
    Resumed,
    Repeated,
    Retried,
    OneStep,
    OnTrain,
    NoSteps,
    Pair,
    Outside,
    Imported,
    Pulled,
}

pub const KINDS: [Kind; 17] = [
    Passed, Failed, Error, LinkLost, Stopped, Broken, Adaptive, Resumed, Repeated, Retried,
    OneStep, OnTrain, NoSteps, Pair, Outside, Imported, Pulled,
];
/// Numbers of a seed (splitmix64).
pub struct Chance(pub u64);

impl Chance {
    pub fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) % end as u64) as usize
    }

    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }
}

/// Listeners of a run: the stream, its lines, and the window.
pub struct Heard(pub EventLines, pub Vec<String>, pub Progress);

impl Listener for Heard {
    fn on_event(&mut self, procedure: &Procedure, event: &SessionEvent) {
        self.1.extend(self.0.event(procedure, event));
        self.2.on_event(&procedure.id, event);
    }
}

pub fn contents() -> BenchContents {
    let file = json!({ "name": "x", "sha256": "" });
    from_value(json!({
        "source": "sim", "serial": "", "unit_config": file, "line": file, "train": file, "seed": 1, "scatter": null,
        "realtime": false,
    }))
    .expect("contents")
}

fn procedure(id: &str, names: impl Iterator<Item = String>) -> Procedure {
    let none: [u8; 0] = [];
    let step = |(line, name)| {
        json!({
            "name": name, "line": line, "actions": none, "expectations": none, "origin": { "sources": none, "lacks": false },
            "measures": none, "provokes": none, "when": null, "repeat": 1, "on_fail": "Continue", "continues": false,
            "time_limit": Duration::ZERO, "worst_case": Duration::ZERO, "suspect": null, "note": null,
        })
    };
    from_value(json!({
        "id": id, "title": id, "title_ko": null, "needs": "Btu", "on_request": false, "suspect": null, "path": "", "sha256": "",
        "setup": none, "cleanup": none, "slots": 0, "steps": (1..).zip(names).map(step).collect::<Vec<_>>(),
    }))
    .expect("a procedure")
}

/// A procedure of its own, whose steps bear marks.
pub fn own(seed: u64, number: usize, chance: &mut Chance) -> Procedure {
    let behind: Vec<_> = NAMES.split('|').collect();
    let names = (0..1 + chance.below(8)).map(|step| {
        let mark = seed as usize % 100 * 100 + number * 20 + step;
        format!("s{mark:04}{}", behind[chance.below(behind.len())])
    });
    procedure(&format!("made/p{number}"), names)
}

/// Procedures of the dictionary that have something to say of a mode, and one more.
pub fn known(dictionary: &Dictionary, mode: &Mode, chance: &mut Chance) -> Vec<Procedure> {
    let told = mode.columns[0]
        .cells
        .keys()
        .map(|place| &dictionary.checks[*place].procedure);
    let any = &dictionary.checks[chance.below(dictionary.checks.len())].procedure;
    let mut ids: Vec<_> = told.take(1 + chance.below(8)).chain([any]).collect();
    ids.sort();
    ids.dedup();
    let of = |id: &&String| {
        let checks = dictionary
            .checks
            .iter()
            .filter(|check| check.procedure == **id);
        procedure(
            id,
            checks
                .map(|check| check.step.clone())
                .filter(|name| !name.ends_with(')')),
        )
    };
    ids.iter()
        .map(of)
        .filter(|procedure| !procedure.steps.is_empty())
        .collect()
}

/// The result that a step has most often under a mode.
pub fn likeliest(of: &Dictionary, mode: &Mode, procedure: &Procedure, step: usize) -> Verdict {
    let name = &procedure.steps[step].name;
    let place = of
        .checks
        .iter()
        .position(|check| check.procedure == procedure.id && check.step == *name);
    let cell = [&mode.columns[0], &of.healthy]
        .into_iter()
        .find_map(|column| column.cells.get(&place?));
    let all = [Verdict::Error, Verdict::Failed, Verdict::Passed];
    let count = |verdict: &Verdict| cell.map_or(0, |cell| cell.count(*verdict));
    all.into_iter().max_by_key(count).expect("three")
}
