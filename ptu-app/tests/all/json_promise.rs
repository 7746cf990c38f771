//! Promise to other programs: every key of every JSON answer, with its types, is in `docs/json.txt`.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use crate::common::{Place, list, text};

const PROMISED: &str = include_str!("../../../docs/json.txt");

type Shape = BTreeMap<String, BTreeSet<&'static str>>;

/// Every path of a document with the types found there; objects whose keys are data have `*` for them. A finding is told by
/// its kind, of which there are more than one run finds.
fn shape(document: &Value, path: &str, found: &mut Shape) {
    let kind = match document {
        Value::Null => "null",
        Value::Bool(_) => "bool",
        Value::Number(_) => "number",
        Value::String(_) => "string",
        Value::Array(_) => "list",
        Value::Object(_) => "object",
    };
    found.entry(path.to_owned()).or_default().insert(kind);
    match document {
        Value::Array(items) => {
            for item in items {
                shape(item, &format!("{path}[]"), found);
            }
        }
        Value::Object(_) if path.ends_with(".finding") => {}
        Value::Object(keys) => {
            for (key, value) in keys {
                let is_name = key.chars().all(|c| c.is_ascii_lowercase() || c == '_');
                let key = if is_name { key } else { "*" };
                shape(value, &format!("{path}.{key}"), found);
            }
        }
        _ => {}
    }
}

/// The lines of `docs/json.txt` for these answers.
fn told(answers: &[(&str, Value)]) -> Vec<String> {
    let mut lines = Vec::new();
    for (command, answer) in answers {
        let mut found = Shape::new();
        shape(answer, "", &mut found);
        for (path, kinds) in found {
            let kinds: Vec<_> = kinds.into_iter().collect();
            let path = if path.is_empty() { "." } else { &path };
            lines.push(format!("{command}: {path} {}", kinds.join("|")));
        }
    }
    lines
}

/// Goal: a program that reads an answer goes on reading it: a key that goes, or becomes something else, fails here; a new
/// one is written down. Method: one run of a bad unit with a repair, and every question about it.
#[test]
fn every_answer_has_the_keys_that_are_promised() {
    let place = Place::new();
    place.ptu("run tcms/link").exits(0);
    let run = "run atp/overspeed twc/exchange --inject eb_relay.slow --who Kim --train-no 612";
    place.ptu(&format!("{run} --symptom brakes_late")).exits(1);
    let faults = place.json("faults list --json");
    let fault = text(&list(&faults)[0]["id"]).to_owned();
    let repair = format!("faults repair {fault} --part eb_relay --old R-1 --new R-2 --who Kim");
    place.ptu(&repair).exits(0);
    place.ptu("signal make code 55 code.wav").exits(0);
    place.ptu("signal make twc 01 twc.wav").exits(0);
    let cut = std::fs::read(place.path("twc.wav")).expect("made");
    std::fs::write(place.path("twc.wav"), &cut[..cut.len() - 1]).expect("cut");
    let asked: [&[&str]; 19] = [
        &["signal", "read", "code.wav"],
        &["signal", "read", "twc.wav"],
        &["runs", "list"],
        &["runs", "show", "latest"],
        &["faults", "list"],
        &["faults", "show", &fault],
        &["faults", "stats", "--by", "part"],
        &["faults", "life", "SIM-0001"],
        &["trace", "list"],
        &["trace", "show", "latest"],
        &["diagnose", "latest"],
        &["catalog", "faults"],
        &["catalog", "signals"],
        &["catalog", "codes"],
        &["catalog", "lines"],
        &["catalog", "parts"],
        &["catalog", "symptoms"],
        &["db", "check"],
        &["run", "tcms/link", "--list"],
    ];
    let answers: Vec<_> = asked
        .iter()
        .map(|command| {
            // A fault's number is data, and so is a run's place.
            let name = command.iter().filter(|word| **word != fault);
            let name: Vec<_> = name.copied().collect();
            let said = place.ptu(&[command, &["--json"][..]].concat());
            let answer: Result<Value, _> = serde_json::from_str(&said.out);
            (
                name.join(" "),
                answer.unwrap_or_else(|_| panic!("{}", said.all())),
            )
        })
        .collect();
    let answers: Vec<_> = answers
        .iter()
        .map(|(name, answer)| (name.as_str(), answer.clone()))
        .collect();
    let now: BTreeSet<String> = told(&answers).into_iter().collect();
    let promised: BTreeSet<String> = PROMISED
        .lines()
        .filter(|line| !line.starts_with('#') && !line.is_empty())
        .map(str::to_owned)
        .collect();
    let gone: Vec<_> = promised.difference(&now).collect();
    let new: Vec<_> = now.difference(&promised).collect();
    assert!(
        gone.is_empty() && new.is_empty(),
        "gone or changed, which breaks programs:\n{gone:#?}\nnew, to be added to docs/json.txt:\n{}",
        new.iter()
            .map(|line| line.as_str())
            .collect::<Vec<_>>()
            .join("\n")
    );
}
