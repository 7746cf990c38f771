//! The history as Parquet partitions, asked with DuckDB and read with Polars.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::{Value, json};

use crate::common::{Place, list, record_bad_unit, relay_fault, text};
use crate::fault_months::{self, noon_us, store};
use crate::trace_files::python;

/// The documented examples, and more.
fn questions() -> Vec<String> {
    let page = fault_db::VIEWS_PAGE;
    let examples = page
        .split("```sql")
        .nth(1)
        .and_then(|rest| rest.split("```").next());
    let examples = examples.expect("examples on the page of the views");
    let mut questions: Vec<String> = examples
        .split(';')
        .map(str::trim)
        .filter(|question| !question.is_empty())
        .map(str::to_owned)
        .collect();
    assert!(questions.len() >= 4, "{questions:?}");
    questions.extend(
        [
            "SELECT lru, count(*), sum(occurrences) FROM faults GROUP BY lru ORDER BY lru",
            "SELECT unit, verdict, count(*) FROM runs GROUP BY unit, verdict ORDER BY unit, verdict",
            "SELECT procedure, step, name, value, low, high FROM measurements ORDER BY run_id, step_index, name",
            "SELECT kind, who, text, withdrawn FROM events ORDER BY id",
            "SELECT serial, runs, faults_not_closed FROM units ORDER BY serial",
        ]
        .map(str::to_owned),
    );
    questions
}

fn asked(folder: &Path, questions: &[String]) -> Value {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/readers/ask_history.py");
    let mut reader = Command::new(python())
        .arg(script)
        .arg(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("Python starts");
    let mut input = reader.stdin.take().expect("its input");
    let questions = serde_json::to_vec(questions).expect("JSON");
    input.write_all(&questions).expect("written");
    drop(input);
    let output = reader.wait_with_output().expect("it ends");
    assert!(output.status.success());
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// Rows of an answer, sorted, because some questions give their rows no order.
fn sorted(answer: &Value) -> Vec<String> {
    let mut rows: Vec<_> = list(answer).iter().map(Value::to_string).collect();
    rows.sort();
    rows
}

/// Answer from the file: rows as lists.
fn from_file(place: &Place, question: &str) -> Value {
    let answer = place.json(&["db", "query", "--json", "--", question]);
    answer["rows"].clone()
}

fn bytes_below(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        match path.is_dir() {
            true => found.extend(bytes_below(&path)),
            false => {
                let name = path.display().to_string();
                found.insert(name, std::fs::read(&path).expect("read"));
            }
        }
    }
    found
}

/// Goal: DuckDB answers the documented questions from the partitions as SQLite does from the file. What has not changed
/// is not written again, and an export in steps makes the same files as an export of all at once.
#[test]
#[ignore = "long suite: readers of other makers"]
fn partitions_answer_as_the_file_does_and_grow_with_it() {
    let place = Place::with_database();
    let old = store(&place);
    for month in [4, 6] {
        fault_months::record(&old, noon_us(month, 3), Some("tra"));
    }
    drop(old);
    record_bad_unit(&place);
    let export = |to: &str| place.json(&["db", "export", "--parquet", to, "--json"]);
    let first = export("files");
    assert_eq!(first["unchanged"], 0, "{first}");
    let again = export("files");
    assert_eq!(
        (&again["written"], &again["removed"]),
        (&json!(0), &json!(0))
    );

    place.ptu("run atp/overspeed --serial-no OK-7").exits(0);
    let fault = relay_fault(&place);
    let id = text(&fault["id"]);
    let repair = format!("faults repair {id} --part eb_relay --new SN-77");
    place.ptu(&repair).exits(0);
    place.ptu("runs note latest 바꿈").exits(0);
    let grown = export("files");
    assert!(
        grown["unchanged"].as_u64() > Some(0) && grown["written"].as_u64() > Some(5),
        "{grown}"
    );
    export("whole");
    let of = |folder: &str| {
        let files = bytes_below(&place.path(folder));
        let below = |(name, bytes): (String, Vec<u8>)| {
            let (_, name) = name.split_once(folder).expect("below it");
            (name.to_owned(), bytes)
        };
        files.into_iter().map(below).collect::<BTreeMap<_, _>>()
    };
    assert!(of("files") == of("whole"), "exported in steps and at once");

    let questions = questions();
    let answers = asked(&place.path("files"), &questions);
    for (question, answer) in questions.iter().zip(list(&answers["answers"])) {
        assert_eq!(
            sorted(answer),
            sorted(&from_file(&place, question)),
            "{question}"
        );
    }
    for view in [
        "runs",
        "steps",
        "measurements",
        "faults",
        "occurrences",
        "events",
        "repairs",
        "traces",
        "units",
        "notes",
    ] {
        let count = from_file(&place, &format!("SELECT count(*) FROM {view}"));
        assert_eq!(answers["rows"][view], count[0][0], "{view}");
        assert!(
            count[0][0].as_u64() > Some(0),
            "{view} has no rows to compare"
        );
    }
}

#[test]
#[ignore = "long suite: readers of other makers"]
fn partitions_of_a_history_without_runs_have_all_columns() {
    let place = Place::with_database();
    place.ptu("db export --parquet files").exits(0);
    let count = "SELECT count(*) FROM repairs JOIN faults ON fault_id = faults.id".to_owned();
    let answers = asked(&place.path("files"), &[count]);
    assert_eq!(answers["answers"], json!([[[0]]]));
    place.ptu("db export").exits(2);
    place.ptu("db export other.db --parquet files").exits(2);
    place.write("in_the_way", "");
    place
        .ptu("db export --parquet in_the_way")
        .exits(2)
        .explains(&["in_the_way"]);
}
