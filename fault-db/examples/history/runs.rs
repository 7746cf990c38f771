//! One run after the other, and the faults seen in each.

use std::collections::BTreeMap;

use fault_db::{
    FaultRecord, FaultState, Id, LOG_SOURCE, RunEnd, RunRecord, RunWriter, ScriptRecord, Store,
    StoreError, UnitRecord, Verdict,
};

use crate::bench::{CHECKS, freeze, measured};
use crate::catalogue::{KINDS, failed_check, others};
use crate::chance::Chance;
use crate::common::realistic_trace;
use crate::fleet::Fleet;
use crate::people::People;
use crate::words;

pub const DAY_US: i64 = 86_400_000_000;

/// How much more often a fault is seen while the part is broken.
const WHILE_BROKEN: f64 = 9.0;

/// What is about to be recorded.
pub struct Visit {
    pub unit: usize,
    pub at_us: i64,
    /// The unit's own log is read; else procedures are run.
    pub of_log: bool,
    /// Faults to be seen in it.
    pub faults: usize,
    /// Whether the first fault gets a trace.
    pub traced: bool,
}

#[derive(Default)]
pub struct Seen {
    pub occurrences: usize,
    pub traces: usize,
}

/// The part of the year that is over.
fn of_year(at_us: i64) -> f64 {
    (at_us as f64 / (365.2425 * DAY_US as f64)).fract()
}

pub fn record(
    store: &Store,
    fleet: &mut Fleet,
    people: &mut People,
    visit: &Visit,
    chance: &mut Chance,
) -> Result<Seen, StoreError> {
    let &Visit {
        unit,
        at_us,
        of_log,
        ..
    } = visit;
    let since_us = std::mem::replace(&mut fleet.units[unit].seen_us, at_us);
    let mut seen = Seen::default();
    let mut writer = RunWriter::begin(store, &run_record(fleet, visit, chance))?;
    let length_us = if of_log { 4_000_000 } else { 120_000_000 };
    let mut failed = Vec::new();
    if !of_log {
        let days = (at_us - since_us) as f64 / DAY_US as f64;
        let mut index = 0;
        for (check, wear) in CHECKS.iter().zip(&mut fleet.units[unit].wear) {
            wear.age(days);
            // Not every run asks everything.
            if !chance.happens(0.75) {
                continue;
            }
            let step = measured(check, wear, index, of_year(at_us), chance);
            if step.verdict == Verdict::Failed {
                failed.push((failed_check(check.lru), index));
            }
            writer.step(step)?;
            index += 1;
        }
    }
    let mut found = drawn(fleet, visit, since_us, chance);
    found.extend(
        failed
            .iter()
            .map(|&(kind, step)| (at_us + i64::from(step) * 9_000_000, kind, Some(step))),
    );
    found.sort_unstable();
    let mut occurrences = Vec::new();
    for (seen_us, kind, step) in found {
        let part = step.map(|_| KINDS[kind].lru);
        let id = see(
            &mut writer,
            fleet,
            people,
            visit,
            (seen_us, kind, step, part),
            chance,
        )?;
        occurrences.push(id);
    }
    if let (true, Some(first)) = (visit.traced, occurrences.first()) {
        writer.trace(&[*first], &realistic_trace(600, chance.bits()))?;
        seen.traces = 1;
    }
    seen.occurrences = occurrences.len();
    let verdict = match chance.part() {
        part if part < 0.01 => Verdict::Aborted,
        part if part < 0.015 => Verdict::Error,
        _ if !failed.is_empty() || (!of_log && seen.occurrences > 0 && chance.happens(0.4)) => {
            Verdict::Failed
        }
        _ => Verdict::Passed,
    };
    let run = writer.id();
    // A laptop that fell asleep leaves a run without an end.
    if !chance.happens(0.0005) {
        writer.finish(&RunEnd {
            verdict,
            finished_at_us: at_us + length_us,
            bench_time_us: if of_log { 0 } else { length_us },
            wall_time_us: length_us,
        })?;
    }
    if chance.happens(0.03) {
        store.add_run_note(
            run,
            words::person(chance),
            words::of_run(chance),
            at_us + length_us,
        )?;
    }
    if verdict == Verdict::Passed && !of_log {
        for kind in 0..KINDS.len() {
            if fleet.units[unit].slots[kind].state == FaultState::Repaired {
                people.pass(fleet, unit, kind, at_us + length_us, chance);
            }
        }
    }
    Ok(seen)
}

/// What is seen in a run, when, and of which kind.
fn drawn(
    fleet: &Fleet,
    visit: &Visit,
    since_us: i64,
    chance: &mut Chance,
) -> Vec<(i64, usize, Option<u32>)> {
    let unit = &fleet.units[visit.unit];
    let part = of_year(visit.at_us);
    let weights: Vec<f64> = KINDS
        .iter()
        .zip(&unit.slots)
        .zip(&unit.leaning)
        .map(|((kind, slot), leaning)| {
            let aged = if kind.doubles_days > 0.0 {
                let days = (visit.at_us - slot.new_since_us) as f64 / DAY_US as f64;
                (days / kind.doubles_days).min(3.0).exp2()
            } else {
                1.0
            };
            let broken = if slot.broken.is_some() {
                WHILE_BROKEN
            } else {
                1.0
            };
            kind.rate.sqrt() * leaning * kind.season.factor(part) * aged * broken
        })
        .collect();
    let (from_us, until_us) = if visit.of_log {
        (since_us, visit.at_us)
    } else {
        (visit.at_us, visit.at_us + 120_000_000)
    };
    let time = |chance: &mut Chance| from_us + ((until_us - from_us) as f64 * chance.part()) as i64;
    (0..visit.faults)
        .map(|_| (time(chance), chance.weighted(&weights), None))
        .collect()
}

/// Stores a fault; the fleet and the people know of it then.
fn see(
    writer: &mut RunWriter<'_>,
    fleet: &mut Fleet,
    people: &mut People,
    visit: &Visit,
    (at_us, place, step_index, part): (i64, usize, Option<u32>, Option<&'static str>),
    chance: &mut Chance,
) -> Result<Id, StoreError> {
    let kind = &KINDS[place];
    let stored = writer.fault(&FaultRecord {
        code: kind.code,
        code_name: kind.name.to_owned(),
        lru: kind.lru.to_owned(),
        severity: kind.severity.to_owned(),
        at_us,
        bench_us: (at_us - visit.at_us).max(0),
        step_index,
        findings: None,
        message: format!("{} (parameter {})", kind.text, chance.below(400)),
        freeze: freeze(!visit.of_log, chance),
    })?;
    let slot = &mut fleet.units[visit.unit].slots[place];
    if slot.broken.is_none() && (part.is_some() || !chance.happens(kind.passing)) {
        let other = chance.happens(0.15) || kind.lru == "unknown";
        slot.broken = part.or(Some(if other {
            chance.one_of(others(kind.lru))
        } else {
            kind.lru
        }));
    }
    if stored.is_new {
        slot.turn += 1;
    }
    if stored.is_new || stored.reopened {
        slot.fault = Some(stored.fault);
        slot.state = FaultState::Open;
        // People know of it when the run is over.
        people.see(
            fleet,
            (visit.unit, place),
            visit.at_us.max(at_us),
            stored.reopened,
            chance,
        );
    }
    Ok(stored.occurrence)
}

fn run_record(fleet: &Fleet, visit: &Visit, chance: &mut Chance) -> RunRecord {
    let unit = &fleet.units[visit.unit];
    let port = chance.one_of(&[
        "serial:/dev/ttyUSB0",
        "serial:/dev/ttyUSB0",
        "tcp:10.4.0.7:4000",
    ]);
    let scripts = [
        "atp/limit_speed",
        "atp/overspeed",
        "atp/power_up",
        "door/interlocks",
    ];
    let script = |name: &&str| ScriptRecord {
        path: format!("scripts/{name}.star"),
        sha256: "5a".repeat(32),
    };
    RunRecord {
        unit: UnitRecord {
            serial: unit.serial.clone(),
            kind: "atc".to_owned(),
            config_name: "sg100".to_owned(),
            sw_versions: BTreeMap::from([("atp".to_owned(), unit.software.to_owned())]),
        },
        line: unit.line.to_owned(),
        train: unit.train.clone(),
        seed: chance.bits() >> 32,
        operator: words::person(chance).to_owned(),
        source: if visit.of_log {
            format!("{LOG_SOURCE}{port}")
        } else {
            port.to_owned()
        },
        started_at_us: visit.at_us,
        app_version: "0.1.0".to_owned(),
        scripts_sha256: "ab".repeat(32),
        unit_config_sha256: "cd".repeat(32),
        owner: "history".to_owned(),
        scripts: if visit.of_log {
            Vec::new()
        } else {
            scripts.iter().map(script).collect()
        },
        ..RunRecord::default()
    }
}
