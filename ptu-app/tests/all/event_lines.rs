//! The stream of a run for other programs: what `docs/events.schema.json` promises.

use std::collections::BTreeSet;

use ptu_report::event_lines::{COMMON, EVENTS, Kind, VERSION, schema};
use serde_json::Value;

use crate::common::{Place, number, text};
use crate::trace_files::run_python;

fn lines(text: &str) -> Vec<Value> {
    let line = |line| serde_json::from_str(line).expect("a JSON line");
    text.lines().map(line).collect()
}

fn is_of(kind: Kind, value: &Value) -> bool {
    match kind {
        Kind::Text => value.is_string(),
        Kind::TextOrNull => value.is_string() || value.is_null(),
        Kind::Whole => value.is_i64() || value.is_u64(),
        Kind::WholeOrNull => value.is_u64() || value.is_null(),
        Kind::Number => value.is_number() || value.is_null(),
        Kind::Bit => value.is_boolean(),
        Kind::List => value.is_array(),
    }
}

/// Holds lines to the table that the schema is made of: exactly these keys, of these types, numbered without a gap.
fn check(lines: &[Value]) -> BTreeSet<String> {
    let mut seen = BTreeSet::new();
    for (number, line) in lines.iter().enumerate() {
        assert_eq!(line["seq"], number, "{line}");
        let name = text(&line["event"]);
        let (_, _, keys) = EVENTS
            .iter()
            .find(|(known, ..)| *known == name)
            .unwrap_or_else(|| panic!("no such event: {line}"));
        for (key, kind, _) in COMMON.iter().chain(*keys) {
            assert!(is_of(*kind, &line[key]), "{key} of {line}");
            assert!(line.get(key).is_some(), "{key} is missing: {line}");
        }
        let count = line.as_object().map_or(0, serde_json::Map::len);
        assert_eq!(count, COMMON.len() + keys.len(), "{line}");
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

/// Goal: a change of the stream is seen: the file in `docs/` is what the program writes. `PTU_WRITE_SCHEMA=1` writes it again.
#[test]
fn the_schema_in_docs_is_that_of_the_program() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/events.schema.json");
    let made = format!("{:#}\n", schema());
    if std::env::var_os("PTU_WRITE_SCHEMA").is_some() {
        std::fs::write(file, &made).expect("written");
    }
    assert!(
        std::fs::read_to_string(file).expect("a schema") == made,
        "PTU_WRITE_SCHEMA=1 writes it again"
    );
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
