//! The readers' monitor: runs of every kind, each read in every surface; all tell the facts of the run, and so the same.

mod surfaces;

use std::collections::BTreeMap;

use fault_db::{RunDetail, Signed, SqlValue, Statement, Store};
use fuzzing::draw;
use ptu_app::verdict_table::{failures, verdict_table};
use ptu_report::diagnosis::{diagnosis_json, diagnosis_text};
use ptu_report::run::page::pages;
use ptu_report::run::{RunComparison, Sheet, html};
use ptu_report::words::Language;
use ptu_report::{Target, csv, read_certificate, run_content, run_json, run_summary_json};
use ptu_runs::data::ScriptsDirectory;
use serde_json::Value;

use self::surfaces::{
    columns, console, diagnosed, diagnosed_json, in_full, json, junit, printed_texts, short,
    stream, summary, table_of_values, texts, turn_kind,
};
use crate::common::made_runs::{Made, Maker, PARTS};
use crate::common::served::{Running, Unit};
use crate::common::told::{
    Facts, Monitor, fact, id, live, measured, numbers, results, sheet, sorted, turn_of,
};
use crate::common::{Place, list, scripts, text};

/// Seed of a run without steps.
const NO_STEPS: u64 = 12;

/// A run in its store, and the scripts by which it is diagnosed.
struct Stored<'a> {
    store: &'a Store,
    run: RunDetail,
    scripts: &'a ScriptsDirectory,
}

/// Goal: nobody is told one thing of a run here and another there. Method: 200 runs of all kinds, of which a check draws a
/// third, made from seeds and recorded as a bench's or read of a unit; every surface, in both languages, is read by a small
/// reader of its own, and held to the run.
#[test]
fn every_reader_tells_the_same_of_every_run() {
    let place = Place::new();
    let mut maker = Maker::new(place.path("history.db"), &scripts());
    // Two of each kind are 34.
    let mut seeds = draw::drawn(0..200, 3);
    seeds.retain(|seed| *seed != NO_STEPS);
    let mut made: Vec<_> = [&[NO_STEPS], &seeds[..]]
        .concat()
        .into_iter()
        .map(|seed| maker.make(seed))
        .collect();
    let store = maker.store();
    let with_dictionary = ScriptsDirectory::find(Some(&scripts())).expect("scripts");
    let none = place.no_scripts();
    let scripts_of = [&none, &with_dictionary];
    let mut monitor = Monitor::default();
    let nothing = store.run(made[0].id).expect("recorded");
    for run in &mut made {
        let of = Stored {
            store: &store,
            run: store.run(run.id).expect("recorded"),
            scripts: scripts_of[usize::from([1, 13, 23, 25].contains(&(run.seed % 68)))],
        };
        of_run(&mut monitor, &mut run.facts, &of, run.seed % 9 == 0);
        compared(&mut monitor, &mut run.facts, &of.run, &nothing);
        if let Some(led) = &run.live {
            monitor.hold(&mut run.facts, "stream", stream(&run.lines));
            for language in Language::ALL {
                let told = live(led, language);
                monitor.hold(&mut run.facts, "window that led it", told);
            }
        }
        if run.seed % 50 == 1 {
            certificate(&mut monitor, &mut run.facts, &of, &place);
        }
    }
    views(&mut monitor, &mut made, &store);
    store.close().expect("closed");
    by_command(&mut monitor, &mut made, &place);
    monitor.finish(70 * made.len());
}

/// Goal: the same of runs that a person leads. Method: the program on a unit, to the end, and broken off by a lost link and by
/// a stop; what is due is what `ptu run --list` says.
#[test]
fn every_reader_tells_the_same_of_runs_on_a_unit() {
    let mut monitor = Monitor::default();
    let asked = ["atp/overspeed", "twc/exchange", "tcms/link"];
    let listed = Place::new().json(&[&["run", "--list", "--json"], &asked[..]].concat());
    let planned = list(&listed).iter().map(|of| list(&of["steps"]).len());
    let planned: usize = planned.sum();
    let repeated = "--repeat 2 --inject eb_relay.slow";
    for how in [repeated, "--adaptive", "link lost", "stopped"] {
        let place = Place::new();
        let asked = [&asked[..], &["--events", "e.jsonl"]].concat();
        if how.starts_with('-') {
            let more: Vec<_> = how.split(' ').collect();
            place.ptu(&[&["run"], &asked[..], &more].concat());
        } else {
            // By the clock: in lock step the run could be over before it is broken off.
            let mut unit = Unit::on_pty(&[]);
            let mut run = Running::start(&place, &unit, &asked);
            run.recorded_steps(2);
            match how {
                "stopped" => run.interrupt(),
                _ => unit.kill(),
            }
            let said = run.finish();
            assert!(matches!(said.code, Some(3 | 130)), "{how}: {}", said.all());
        }
        let store = Store::open_read_only(&place.path("history.db")).expect("a database");
        let latest = store.resolve_run("latest").expect("a run");
        let run = store.run(latest).expect("recorded");
        let scripts = ScriptsDirectory::find(Some(&scripts())).expect("scripts");
        let known = [fact("planned", planned)].into();
        let of = how.to_owned();
        let mut facts = Facts { of, known };
        let lines: Vec<_> = place.read("e.jsonl").lines().map(str::to_owned).collect();
        monitor.hold(&mut facts, "stream", stream(&lines));
        let of = Stored {
            store: &store,
            run,
            scripts: &scripts,
        };
        of_run(&mut monitor, &mut facts, &of, true);
        let lost = &facts.known["link en"];
        assert_eq!(lost.is_empty(), how != "link lost", "{how}: {lost}");
    }
    monitor.finish(400);
}

/// Compares everything made of a stored run.
fn of_run(monitor: &mut Monitor, facts: &mut Facts, of: &Stored<'_>, is_printed: bool) {
    let run = &of.run;
    for language in Language::ALL {
        let words = language.words();
        let [whole, quiet] = [verdict_table(run, words), failures(run, words)];
        monitor.hold(facts, "table", console(&whole, language));
        monitor.hold(facts, "quiet table", console(&quiet, language));
    }
    monitor.hold(facts, "JSON", json(&run_json(run)));
    monitor.hold(
        facts,
        "JSON of a list",
        summary(&run_summary_json(&run.run)),
    );
    monitor.hold(facts, "CSV", table_of_values(&csv::csv(run)));
    let target: Target = "x.junit.xml".parse().expect("a target");
    let bytes = run_content(&target, of.store, of.scripts, run, Language::English).expect("made");
    monitor.hold(
        facts,
        "JUnit",
        junit(&String::from_utf8(bytes).expect("text")),
    );
    let of = Sheet::gather(of.store, of.scripts, run.run.id).expect("a sheet");
    for language in Language::ALL {
        let page = html(&of, language.words());
        monitor.hold(facts, "HTML", sheet(&texts(&page), language));
        if is_printed {
            let printed = pages(&of, language.words()).expect("pages");
            let printed: Vec<_> = printed.iter().flat_map(printed_texts).collect();
            monitor.hold(facts, "PDF", sheet(&printed, language));
        }
    }
    if let Ok(answer) = &of.diagnosis {
        let english = Language::English.words();
        monitor.hold(
            facts,
            "diagnosis",
            diagnosed(&diagnosis_text(answer, false, english)),
        );
        facts
            .known
            .insert("parts whose faults do not add up".into(), String::new());
        monitor.hold(
            facts,
            "whole diagnosis",
            in_full(&diagnosis_text(answer, true, english)),
        );
        monitor.hold(
            facts,
            "JSON of a diagnosis",
            diagnosed_json(&diagnosis_json(answer)),
        );
    }
}

/// A run beside one without steps: all that it has a result of is its own.
fn compared(monitor: &mut Monitor, facts: &mut Facts, run: &RunDetail, nothing: &RunDetail) {
    let (a, b) = (run.clone(), nothing.clone());
    let tally = RunComparison { a, b, all: true }.tally();
    let told = numbers(
        "with a result|0|0|0",
        [
            tally.only_a,
            tally.only_b,
            tally.pass_now,
            tally.passed_before,
        ],
    );
    monitor.hold(facts, "comparison", told);
}

/// The signed documents: of the run in the store, and in a sheet.
fn certificate(monitor: &mut Monitor, facts: &mut Facts, of: &Stored<'_>, place: &Place) {
    let target = place.text_path("signed.html").parse().expect("a target");
    let written = ptu_report::write(&[target], of.store, of.scripts, &of.run, Language::English);
    written.expect("written");
    let certificate = read_certificate(&place.read("signed.html")).expect("a certificate");
    let stored = of.store.signatures(of.run.run.id).expect("signed");
    let stored = stored
        .iter()
        .map(|text| Signed::read(text).expect("signed"));
    let in_page = certificate
        .run
        .into_iter()
        .map(|signed| signed.expect("signed"));
    for signed in stored.chain(in_page) {
        let of = Statement::of(&signed).expect("of a run");
        let about = of.about.expect("of a run");
        let told = [
            fact("digest", of.digest),
            fact("run", about.steps),
            fact("verdict", about.verdict),
        ];
        monitor.hold(
            facts,
            "certificate",
            [vec![id(&of.id)], told.into()].concat(),
        );
    }
    let seal = of.run.seal.as_ref().expect("sealed");
    monitor.hold(facts, "seal", vec![fact("digest", &seal.digest)]);
}

/// Rows that SQL finds in the views.
fn views(monitor: &mut Monitor, made: &mut [Made], store: &Store) {
    let ask = |sql: &str| {
        let answer = store.query_read_only(sql, 100_000).expect("an answer");
        let mut by_run: BTreeMap<String, Vec<Vec<String>>> = BTreeMap::new();
        for row in answer.rows {
            let row: Vec<_> = row.into_iter().map(cell).collect();
            by_run.entry(row[0].clone()).or_default().push(row);
        }
        by_run
    };
    let runs = ask("SELECT id, coalesce(verdict, 'interrupted') FROM runs");
    let steps = ask("SELECT run_id, name, verdict, message, kind, turn, turns FROM steps");
    let values = ask("SELECT run_id, name, value, low, high FROM measurements ORDER BY step_index");
    let parts = ask("SELECT run_id, lru, count(*) FROM occurrences GROUP BY run_id, lru");
    for run in made {
        let of = run.id.to_string();
        let [run_row, steps, values, parts] =
            [&runs, &steps, &values, &parts].map(|all| all.get(&of).map_or(&[][..], |rows| rows));
        let steps = steps.iter().map(|row| {
            let [turn, turns] = [5, 6].map(|place: usize| row[place].parse().expect("a number"));
            let turn = turn_of(turn, turns, turn_kind(&row[4]));
            (row[4] != "outside", &*row[1], &*row[2], &*row[3], turn)
        });
        let values = values.iter().map(|row| {
            let numbers = [2, 3, 4].map(|place: usize| row[place].parse::<f64>().ok());
            (row[1].clone(), numbers)
        });
        let parts = parts.iter().map(|row| format!("{}={}", row[1], row[2]));
        let mut told = vec![fact("verdict", &run_row[0][1]), sorted("parts", parts)];
        told.extend(results(steps).into_iter().chain(measured(values)));
        monitor.hold(&mut run.facts, "SQL views", told);
    }
}

/// Answers of commands about all runs.
fn by_command(monitor: &mut Monitor, made: &mut [Made], place: &Place) {
    let runs = place.ptu("runs list --limit 1000").exits(0).out;
    let faults = place.json("faults list --limit 10000 --json");
    let stats = place.json("faults stats --by part --json");
    let mut all: BTreeMap<&str, u64> = BTreeMap::new();
    for run in made.iter_mut() {
        let row = runs.lines().find(|line| line.starts_with(&run.id.short()));
        let cells = columns(row.expect("listed"));
        let mut told = short(&cells[5]);
        told.extend([fact("verdict", &cells[4]), fact("faults", &cells[6])]);
        monitor.hold(&mut run.facts, "list of runs", told);
        let shown = place.ptu(&["runs", "show", &run.id.to_string()]).exits(0);
        monitor.hold(
            &mut run.facts,
            "run shown",
            console(&shown.out, Language::English),
        );
        let unit = format!("M-{}", run.seed);
        let of_run = list(&faults)
            .iter()
            .filter(|fault| fault["unit_serial"] == unit);
        monitor.hold(
            &mut run.facts,
            "list of faults",
            vec![sorted("parts", seen(of_run))],
        );
        for (part, of_run) in run.facts.known["parts"]
            .split(' ')
            .filter_map(|part| part.split_once('='))
        {
            let part = PARTS
                .into_iter()
                .find(|known| *known == part)
                .expect("known");
            *all.entry(part).or_default() += of_run.parse::<u64>().expect("a number");
        }
    }
    for (part, seen) in all {
        let row = list(&stats)
            .iter()
            .find(|row| row["key"] == part)
            .expect("counted");
        assert_eq!(row["occurrences"], seen, "statistics of {part}");
    }
}

/// Parts of faults, each with how often it was seen.
fn seen<'a>(faults: impl Iterator<Item = &'a Value>) -> Vec<String> {
    faults
        .map(|fault| format!("{}={}", text(&fault["part"]), fault["occurrences"]))
        .collect()
}

fn cell(value: SqlValue) -> String {
    match value {
        SqlValue::Null => String::new(),
        SqlValue::Integer(number) => number.to_string(),
        SqlValue::Real(number) => number.to_string(),
        SqlValue::Text(text) => text,
    }
}
