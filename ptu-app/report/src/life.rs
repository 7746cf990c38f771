//! Texts of the life of a unit, a train or a part, on the command line and in the window.

use fault_db::{LOG_SOURCE, Life, LifeEvent, LifeFault, LifeOf, LifeRun, LifeWhat, Stay};
use ptu_runs::clock::{local, rfc3339};
use serde_json::{Value, json};

use crate::event_text::{cause_text, repair_text};
use crate::naming::{DOT, PartNames, event};
use crate::words::{Words, fill};

/// Name of the thing, and the time that its life covers.
pub fn title(life: &Life, words: &Words) -> String {
    let name = fill(words.life.of(life.of), &[("serial", &life.serial)]);
    let (Some(first), Some(last)) = (life.events.first(), life.events.last()) else {
        return name;
    };
    let span = fill(
        words.life.span,
        &[
            ("n", &life.events.len()),
            ("first", &local(first.at_us)),
            ("last", &local(last.at_us)),
        ],
    );
    format!("{name}: {span}")
}

/// Place or unit, first and last time there, and number of runs.
pub fn stay(of: LifeOf, stay: &Stay, words: &Words, parts: &PartNames) -> [String; 4] {
    let place = match of {
        LifeOf::Unit => stay.place.clone(),
        LifeOf::Train => stay.unit.clone(),
        LifeOf::Part => [&*stay.unit, parts.name(&stay.place, words.language)].join(DOT),
    };
    let at = |at_us: Option<i64>, none: &str| at_us.map_or_else(|| none.to_owned(), local);
    let runs = stay.runs.to_string();
    let (from, until) = (
        at(stay.from_us, words.life.before),
        at(stay.until_us, words.life.now),
    );
    [place, from, until, runs]
}

/// The event in one line.
pub fn happened(entry: &LifeEvent, words: &Words, parts: &PartNames) -> String {
    match &entry.what {
        LifeWhat::Run(run) => of_run(run, words),
        LifeWhat::Fault(fault) => of_fault(fault, words, parts),
    }
}

fn of_run(run: &LifeRun, words: &Words) -> String {
    let said = if run.source.starts_with(LOG_SOURCE) {
        fill(words.life.log, &[("n", &run.faults)])
    } else {
        let verdict = run.verdict.map(|said| words.common.stored_verdict(said));
        let verdict = verdict.unwrap_or(words.common.interrupted);
        fill(words.life.run, &[("verdict", &verdict), ("n", &run.faults)])
    };
    let train = match &*run.train {
        "" => String::new(),
        train => fill(words.life.in_train, &[("train", &train)]),
    };
    joined([&said, &train, &run.operator])
}

fn of_fault(entry: &LifeFault, words: &Words, parts: &PartNames) -> String {
    let called = |part: &str| parts.name(part, words.language).to_owned();
    let kind = words.event_kind(&entry.kind);
    let said = match (&entry.repair, &entry.cause) {
        (Some(repair), _) => repair_text(repair, called),
        (None, Some(cause)) => cause_text(cause, called),
        // The program notes which run proves a repair; that run is an entry of its own.
        (None, None) if matches!(&*entry.kind, "passed" | "confirmed") => String::new(),
        (None, None) => words.found(&entry.findings, &entry.note).into_owned(),
    };
    let fault = entry.faults.first().map_or_else(String::new, |fault| {
        let code = event(fault.code, &fault.code_name, words);
        [&*called(&fault.part), &code].join(DOT)
    });
    let more = match entry.faults.len() {
        0 | 1 => String::new(),
        n => fill(words.life.more_faults, &[("n", &(n - 1))]),
    };
    format!(
        "{kind}: {}",
        joined([said.trim(), &fault, &more, &entry.who])
    )
}

fn joined<const N: usize>(texts: [&str; N]) -> String {
    let said: Vec<&str> = texts.into_iter().filter(|text| !text.is_empty()).collect();
    said.join(DOT)
}

pub fn json(life: &Life) -> Value {
    let stays = life.stays.iter().map(|stay| {
        json!({
            "unit": stay.unit, "place": stay.place, "from": stay.from_us.map(rfc3339),
            "until": stay.until_us.map(rfc3339), "runs": stay.runs,
        })
    });
    json!({
        "of": life.of.as_str(), "serial": life.serial,
        "stays": stays.collect::<Vec<_>>(),
        "events": life.events.iter().map(event_json).collect::<Vec<_>>(),
    })
}

fn event_json(entry: &LifeEvent) -> Value {
    let mut value = match &entry.what {
        LifeWhat::Run(run) => json!({
            "kind": "run", "run_id": run.id.to_string(), "who": run.operator,
            "verdict": run.verdict.map(|verdict| verdict.as_str()), "source": run.source,
            "train": run.train, "fault_count": run.faults,
        }),
        LifeWhat::Fault(fault) => json!({
            "kind": fault.kind, "who": fault.who, "note": fault.note, "repair": fault.repair,
            "cause": fault.cause,
            "faults": fault.faults.iter().map(|fault| json!({
                "id": fault.id.to_string(), "code": fault.code, "name": fault.code_name, "part": fault.part,
            })).collect::<Vec<_>>(),
        }),
    };
    value["at"] = rfc3339(entry.at_us).into();
    value["unit"] = entry.unit.clone().into();
    value
}
