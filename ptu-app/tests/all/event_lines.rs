//! The stream of a run for other programs: what `docs/events.schema.json` promises.

use std::collections::{BTreeMap, BTreeSet};

use ptu_report::event_lines::{SCHEMA, VERSION};
use serde_json::Value;

use crate::common::{Place, list, number, text};
use crate::trace_files::run_python;

fn lines(text: &str) -> Vec<Value> {
    let line = |line| serde_json::from_str(line).expect("a JSON line");
    text.lines().map(line).collect()
}

/// Whether a value is of one of the types that the schema has for its key.
fn is_of(types: &Value, value: &Value) -> bool {
    match types.as_str() {
        Some("string") => value.is_string(),
        Some("integer") => value.is_i64() || value.is_u64(),
        Some("number") => value.is_number(),
        Some("boolean") => value.is_boolean(),
        Some("array") => value.is_array(),
        Some("null") => value.is_null(),
        _ => list(types).iter().any(|one| is_of(one, value)),
    }
}

/// The keys of each event with what the schema says of them.
fn promised() -> BTreeMap<String, Value> {
    let schema: Value = serde_json::from_str(SCHEMA).expect("a schema");
    assert!(text(&schema["title"]).ends_with(&format!("version {VERSION}")));
    let keys = |event: &Value| {
        let keys = event["properties"].as_object().expect("keys");
        let required: Vec<_> = list(&event["required"]).iter().map(text).collect();
        assert!(keys.keys().eq(required), "{event}");
        for common in ["seq", "event", "procedure"] {
            assert!(keys.contains_key(common), "{common} of {event}");
        }
        let is_told = |(key, meaning): (&String, &Value)| {
            key == "event" || !text(&meaning["description"]).is_empty()
        };
        assert!(keys.iter().all(is_told), "{event}");
        let name = text(&event["title"]).to_owned();
        assert_eq!(keys["event"]["const"], name);
        (name, event["properties"].clone())
    };
    list(&schema["oneOf"]).iter().map(keys).collect()
}

/// Holds lines to the schema: exactly these keys, of these types, numbered without a gap.
fn check(lines: &[Value]) -> BTreeSet<String> {
    let promised = promised();
    let mut seen = BTreeSet::new();
    for (number, line) in lines.iter().enumerate() {
        assert_eq!(line["seq"], number, "{line}");
        let name = text(&line["event"]);
        let keys = promised.get(name);
        let keys = keys.unwrap_or_else(|| panic!("no such event: {line}"));
        let line_keys = line.as_object().expect("keys").keys();
        let keys = keys.as_object().expect("keys");
        assert_eq!(
            line_keys.collect::<BTreeSet<_>>(),
            keys.keys().collect(),
            "{line}"
        );
        for (key, meaning) in keys.iter().filter(|(key, _)| *key != "event") {
            assert!(is_of(&meaning["type"], &line[key]), "{key} of {line}");
        }
        seen.insert(name.to_owned());
    }
    seen
}

/// Goal: other programs can rely on the stream: it says what the database says, in the order of the record, whatever number
/// of units is tested side by side. Method: a run of a bad unit, its lines against the schema and against the stored run.
#[test]
fn the_stream_of_a_run_says_what_the_database_says() {
    let place = Place::new();
    let run = "run atp/overspeed twc/exchange --inject eb_relay.slow";
    let said = place.ptu(&format!("{run} --json")).exits(1);
    let all = lines(&said.out);
    let seen = check(&all);
    for event in [
        "stream_started",
        "procedure_started",
        "step_finished",
        "measured",
        "fault",
        "ended",
        "run_finished",
    ] {
        assert!(seen.contains(event), "no {event} in {seen:?}");
    }
    assert_eq!(all[0]["version"], VERSION);
    let last = all.last().expect("lines");
    assert_eq!(
        (text(&last["verdict"]), &last["exit"]),
        ("failed", &Value::from(1))
    );
    let stored = place.json(&["runs", "show", text(&last["run"]), "--json"]);
    let of = |event: &str| {
        all.iter()
            .filter(|line| line["event"] == event)
            .collect::<Vec<_>>()
    };
    let steps: Vec<_> = (of("step_finished").iter())
        .map(|line| (text(&line["name"]), text(&line["verdict"])))
        .collect();
    let stored_steps = stored["steps"].as_array().expect("steps");
    let stored_steps: Vec<_> = (stored_steps.iter())
        .map(|step| (text(&step["name"]), text(&step["verdict"])))
        .collect();
    assert_eq!(steps, stored_steps);
    assert!(of("fault").iter().any(|line| line["part"] == "eb_relay"));

    place
        .ptu(&format!("{run} --events events.jsonl --jobs 2"))
        .exits(1)
        .prints(&["eb_relay"]);
    let again = lines(&place.read("events.jsonl"));
    let without_id = |lines: &[Value]| lines[..lines.len() - 1].to_vec();
    assert_eq!(without_id(&again), without_id(&all));
}

/// Goal: a whole run can be looked at in other programs: every row of every signal, and the same events as the stream has.
/// Method: two procedures of a bad unit side by side, read by the format's own reader.
#[test]
#[ignore = "long suite: readers of other makers"]
fn a_recorded_run_has_every_row_and_every_event() {
    let place = Place::new();
    let [record, stream] = ["run.mcap", "run.jsonl"].map(|name| place.text_path(name));
    let run = "run atp/overspeed twc/exchange --jobs 2 --inject eb_relay.slow";
    place
        .ptu(&format!("{run} --mcap {record} --events {stream}"))
        .exits(1);
    let read: Value = serde_json::from_str(&run_python("read_run.py", &[&record])).expect("JSON");
    assert_eq!(read["ordered"], true);
    let events: Vec<_> = read["events"]
        .as_array()
        .expect("events")
        .iter()
        .map(text)
        .collect();
    assert_eq!(events.join("\n"), place.read("run.jsonl").trim_end());
    let stored = place.json("runs show latest --json");
    let rows = number(&read["counts"]["signals"]);
    let expected = number(&stored["run"]["bench_time_s"]) / 0.05;
    // Bring-up is part of the time, and before the first row.
    assert!(
        rows <= expected && rows > 0.9 * expected,
        "{rows} of {expected} rows"
    );
    assert!(
        number(&read["fastest_kmh"]) > 70.0,
        "{}",
        read["fastest_kmh"]
    );
}
