//! The command line in Korean: no sentence of an answer is left in English.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::common::{Place, Said};

/// Commands of a technician, on the history of a unit with a bad relay.
const COMMANDS: &[&str] = &[
    "run tcms/link",
    "run atp/overspeed --inject eb_relay.slow --verbose",
    "run twc/exchange --harness none",
    "run --adaptive --inject tra.dead",
    "run --list",
    "runs list",
    "runs show latest",
    "runs note latest 확인함 --who 김",
    "runs compare latest latest",
    "runs list --verdict aborted",
    "report latest --out sheet.html",
    "diagnose latest",
    "diagnose latest --all",
    "diagnose latest --why-not io_board",
    "faults list",
    "faults list --limit 1",
    "faults list --when today --part tra",
    "faults show latest",
    "faults note latest 확인함",
    "faults state latest acknowledged --who 김",
    "faults repair latest --part eb_relay --new 17 --who 김",
    "faults undo latest --who 김",
    "faults cause latest none",
    "faults life SIM-0001",
    "faults stats",
    "faults stats --by month",
    "faults trend eb_reaction",
    "trace list",
    "trace show latest",
    "trace show latest --twin",
    "trace diff latest latest",
    "trace replay latest",
    "trace export latest --out trace.csv",
    "db check",
    "db backup copy.db",
    "db import copy.db",
    "db rebuild",
    "db prune --older-than 90d --dry-run",
    "db export --parquet tables",
    "db query VALUES(1),(2) --max-rows 1",
    "signal make code 55 code.wav --seconds 0.3",
    "signal read code.wav",
    "new procedure depot/own --in own",
    "run --check",
    "faults list --state open --save open",
    "saved --forget open",
    "saved",
    "doctor",
    "verify latest",
    "config",
    "instrument list",
    "key list",
    "runs show 0000",
    "faults show 0000",
    "faults list --part eb_rely",
    "run atp/overspeeed",
    "run --lin line8",
    "runs lst",
    "faults trend nothing",
    "trace show latest --signal spee",
];

/// Words of the field, of units of measure and of the program that stand in Korean sentences as they are.
const OF_THE_FIELD: &str = "alarm ato atp bit color csv cycle freeze frame html json kmh lang line list log mcap pdf ptu rms \
    runs scan sim speed starlark tcp utf version who yard ATC ATO ATP BCYINFSB BCYMSB COMMAND CPU CUT DISPLAY DOORS DRYINB \
    DRYINCOA DRYINP DRYTEBE EB FSB FSK GLOB HCR HTML ID ISO LINES MTBF MTTR MiB NAME DuckDB SNR NFF OPTIONS PATH PCI POWER PSM PTU RAM ROM \
    SIM TCMS TEST TWC UTC VVVF VRF WAYLAND";

/// Every name that scripts and catalogues give, which commands take: parts, fault modes, signals, procedures, lines.
fn names(place: &Place) -> BTreeSet<String> {
    let mut names: BTreeSet<_> = OF_THE_FIELD.split_whitespace().map(str::to_owned).collect();
    let mut take = |text: &str| {
        let words = text.split(|letter: char| !letter.is_ascii_alphabetic());
        names.extend(words.map(str::to_owned));
    };
    for of in ["faults", "signals", "codes", "lines", "parts", "symptoms"] {
        let all = place.json(&format!("catalog {of} --json"));
        for entry in all.as_array().into_iter().flatten() {
            for key in [
                "id",
                "name",
                "part",
                "mode",
                "line",
                "labels",
                "bits",
                "from_station",
            ] {
                match &entry[key] {
                    Value::String(text) if !text.contains(' ') => take(text),
                    Value::Array(all) => all.iter().filter_map(Value::as_str).for_each(&mut take),
                    _ => {}
                }
            }
        }
    }
    let listed = place.json("run --list --json");
    for procedure in listed.as_array().into_iter().flatten() {
        take(procedure["procedure"].as_str().unwrap_or_default());
        for step in procedure["steps"].as_array().into_iter().flatten() {
            for measurement in step["measurements"].as_array().into_iter().flatten() {
                take(measurement["name"].as_str().unwrap_or_default());
            }
        }
    }
    names
}

/// The words of a text that are neither names nor within a command to type, an option, a path or a number.
fn english(text: &str, names: &BTreeSet<String>) -> Vec<String> {
    let outside_commands = text.split('`').step_by(2).collect::<Vec<_>>().join(" ");
    let words = outside_commands.split_whitespace().filter(|word| {
        let named = |letter: char| "/_-.:@=0123456789".contains(letter);
        !word
            .trim_matches(|letter: char| ".,:;()\"".contains(letter))
            .contains(named)
    });
    let words = words.flat_map(|word| word.split(|letter: char| !letter.is_ascii_alphabetic()));
    let words = words.filter(|word| word.len() > 2 && !names.contains(*word));
    words.map(str::to_owned).collect()
}

/// Goal: who reads Korean is answered in Korean (issue of one source in two languages). Method: what a technician asks and does, on
/// a computer whose locale is Korean; no word of an answer is English but names, which commands take.
#[test]
fn a_korean_computer_is_answered_in_korean() {
    let place = Place::with_bad_unit();
    let names = names(&place);
    let mut left = Vec::new();
    for command in COMMANDS {
        let said = place.ptu_where(("LC_ALL", "ko_KR.UTF-8"), *command);
        let text = said.out + &said.err;
        assert!(!text.is_empty(), "{command} says nothing");
        for line in text.lines() {
            let typed = command.split(|letter: char| !letter.is_ascii_alphabetic());
            let typed: Vec<_> = typed.collect();
            let mut english = english(line, &names);
            english.retain(|word| !typed.contains(&word.as_str()));
            if !english.is_empty() {
                left.push(format!("{command}: {}: {line}", english.join(" ")));
            }
        }
    }
    assert!(
        left.is_empty(),
        "{} lines:\n{}",
        left.len(),
        left.join("\n")
    );
}

/// Goal: the language is that asked for, else that of the locale, else English; JSON has no language. Method: one question under
/// locales and options.
#[test]
fn the_language_is_asked_for_or_that_of_the_locale() {
    let place = Place::with_bad_unit();
    let asked = |variables: &[(&str, &str)], question: &str| {
        let mut command = place.command(question);
        command
            .env_remove("LC_ALL")
            .env_remove("LANG")
            .env_remove("LC_MESSAGES");
        let said = command.envs(variables.iter().copied()).output();
        Said::from(said.expect("it starts")).exits(0).out
    };
    let is_korean = |text: &str| text.contains("시험") && !text.contains("RUN");
    let list = "runs list";
    assert!(is_korean(&asked(&[("LANG", "ko_KR.UTF-8")], list)));
    assert!(is_korean(&asked(
        &[("LANG", "en_US"), ("LC_MESSAGES", "ko_KR")],
        list
    )));
    assert!(is_korean(&asked(&[], "runs list --lang ko")));
    for (variables, question) in [
        (&[][..], list),
        (&[("LANG", "C")], list),
        (&[("LANG", "ko_KR.UTF-8"), ("LC_ALL", "en_US.UTF-8")], list),
        (&[("LANG", "ko_KR.UTF-8")], "runs list --lang en"),
    ] {
        assert!(
            asked(variables, question).starts_with("RUN "),
            "{variables:?} {question}"
        );
    }
    let json = |variables: &[(&str, &str)]| asked(variables, "diagnose latest --json");
    assert_eq!(json(&[("LANG", "ko_KR.UTF-8")]), json(&[]));
}
