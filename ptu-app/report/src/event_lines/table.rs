//! The keys of each line of an event stream, and the schema that is made of them.

use serde_json::{Map, Value, json};

/// Version of the stream.
pub const VERSION: u32 = 1;

/// Type of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Text,
    TextOrNull,
    Whole,
    /// A whole number, or null.
    WholeOrNull,
    /// A number, or null.
    Number,
    /// True or false.
    Bit,
    List,
}

use Kind::{Bit, List, Number, Text, TextOrNull, Whole, WholeOrNull};

/// An event: its name, what it is, and its keys, each with its type and meaning.
pub type EventKeys = (
    &'static str,
    &'static str,
    &'static [(&'static str, Kind, &'static str)],
);

const AT: (&str, Kind, &str) = (
    "at_us",
    Whole,
    "bench time, µs since the unit was started for this procedure",
);
const MESSAGE: (&str, Kind, &str) = (
    "message",
    Text,
    "why, or a note; empty if there is nothing to say",
);
const FINDINGS: (&str, Kind, &str) = (
    "findings",
    List,
    "the same as data: a finding each, and how many times it came",
);
const VERDICT: (&str, Kind, &str) = (
    "verdict",
    Text,
    "passed, failed, error, skipped, inconclusive or aborted",
);
const INDEX: (&str, Kind, &str) = ("index", Whole, "place of the step in the procedure, from 0");
const TURN: (&str, Kind, &str) = ("turn", Whole, "which repetition of the step, from 1");
const TURNS: (&str, Kind, &str) = ("turns", Whole, "of so many");
const LOG: &[(&str, Kind, &str)] = &[
    (
        "source",
        Text,
        "unit or tcms: whose log the event stands in",
    ),
    ("code", Whole, "its number, as in the dictionary of events"),
    ("parameter", Whole, "its parameter"),
    (
        "unit_ms",
        Whole,
        "time of whoever logged it, ms since its start",
    ),
];

/// Keys that every line has.
pub const COMMON: &[(&str, Kind, &str)] = &[
    ("seq", Whole, "number of the line, from 0"),
    ("event", Text, "which event it is"),
    (
        "procedure",
        TextOrNull,
        "procedure that it belongs to, as atp/overspeed; run of what is said of the run as a whole, and null of the run's own lines",
    ),
];

pub const EVENTS: &[EventKeys] = &[
    (
        "stream_started",
        "the first line",
        &[
            ("version", Whole, "version of the stream"),
            ("app_version", Text, "version of the program"),
        ],
    ),
    (
        "procedure_started",
        "a procedure begins with its set-up",
        &[AT, ("steps", Whole, "steps to be run, repetitions counted")],
    ),
    (
        "step_started",
        "a step begins",
        &[AT, INDEX, ("name", Text, "its name"), TURN, TURNS],
    ),
    (
        "paused",
        "the run is paused, and the next step waits",
        &[AT, ("next", Text, "name of that step")],
    ),
    (
        "waiting",
        "something is waited for; sent twice a second",
        &[
            ("what", Text, "what is waited for"),
            ("left_us", Whole, "how long it may still take"),
        ],
    ),
    (
        "prompt",
        "the operator is asked",
        &[
            ("text", Text, "the question"),
            ("left_us", Whole, "how long the answer may take"),
        ],
    ),
    (
        "measured",
        "a measurement is done",
        &[
            INDEX,
            ("name", Text, "its name"),
            (
                "value",
                Number,
                "what was measured; null if nothing could be",
            ),
            (
                "unit",
                Text,
                "unit of value and limits; empty of counts and states",
            ),
            ("low", Number, "least value allowed; null if there is none"),
            (
                "high",
                Number,
                "greatest value allowed; null if there is none",
            ),
            ("limit_source", TextOrNull, "where the limits come from"),
            VERDICT,
        ],
    ),
    (
        "step_finished",
        "a step is done",
        &[
            INDEX,
            ("name", Text, "its name"),
            TURN,
            TURNS,
            VERDICT,
            MESSAGE,
            FINDINGS,
            (
                "repeated",
                Bit,
                "it was not tested and is begun again; another line follows",
            ),
            (
                "again",
                Bit,
                "it was run again only for the state that it leaves, and shows something else",
            ),
            ("suspect", TextOrNull, "part to suspect if it failed"),
            ("started_us", Whole, "bench time at which it began, µs"),
            ("bench_time_us", Whole, "how long it took on the bench"),
            ("script_line", Whole, "line of its call in the script"),
        ],
    ),
    (
        "unsolicited_event",
        "unit or TCMS logged an event that no step provoked",
        LOG,
    ),
    (
        "unsolicited_brake",
        "the emergency brake was applied in a step that did not ask for it",
        &[AT],
    ),
    (
        "unit_clock_wrong",
        "the unit's clock goes wrong, as the bench's tells",
        &[
            AT,
            (
                "by_permille",
                Whole,
                "by how much it is faster, thousandths",
            ),
        ],
    ),
    (
        "outside_step",
        "something failed that belongs to no step",
        &[
            AT,
            ("place", Text, "where, such as bring-up or clean-up"),
            VERDICT,
            MESSAGE,
            FINDINGS,
        ],
    ),
    (
        "procedure_finished",
        "a procedure is over, and outputs are safe, or an error says that they are not",
        &[AT, VERDICT, MESSAGE, FINDINGS],
    ),
    (
        "fault",
        "a fault was found",
        &[
            AT,
            ("code", Whole, "its number"),
            ("name", Text, "its name"),
            ("part", TextOrNull, "part that it points at"),
            ("severity", Text, "critical, major, minor or info"),
            (
                "step",
                WholeOrNull,
                "step under way, by its turn in the procedure",
            ),
            MESSAGE,
            FINDINGS,
            (
                "freeze",
                List,
                "all signals at that moment: name, value, unit, label",
            ),
        ],
    ),
    (
        "trace",
        "the signals around faults are recorded",
        &[
            (
                "faults",
                List,
                "faults that it shows, by their number in the procedure, from 0",
            ),
            ("rows", Whole, "rows, one for each 50 ms"),
            ("trigger_row", Whole, "row at which it was triggered"),
            ("partial", Bit, "it ends before its time was over"),
            ("began_us", WholeOrNull, "bench time of its first row, µs"),
        ],
    ),
    (
        "recording",
        "what was done to the bench in the procedure is recorded",
        &[("began_us", Whole, "bench time at which it begins, µs")],
    ),
    (
        "link_lost",
        "nothing can be judged any more",
        &[("reason", Text, "why"), FINDINGS],
    ),
    (
        "bench_failed",
        "an instrument of the bench failed, and nothing can be judged any more",
        &[("reason", Text, "why"), FINDINGS],
    ),
    (
        "ended",
        "nothing more comes of the procedure",
        &[(
            "bench_time_us",
            Whole,
            "bench time that it took, bring-up included",
        )],
    ),
    (
        "run_finished",
        "the last line of a run that ended; without it the run was broken off, or the stream was",
        &[
            ("run", Text, "id of the run in the database"),
            VERDICT,
            ("bench_time_us", Whole, "bench time of all procedures"),
            ("exit", Whole, "exit code of the run"),
            ("steps", Whole, "different steps that were due"),
            ("run_steps", Whole, "of these, steps that were run"),
            (
                "passed",
                Whole,
                "of these, steps that passed whenever they were run",
            ),
            ("failed", Whole, "steps that failed at least once"),
            (
                "error",
                Whole,
                "steps that did not fail and could not be tested to their end",
            ),
            ("not_run", Whole, "steps that were due and not run"),
            (
                "attempts",
                Whole,
                "results of steps that were run, each repetition by itself",
            ),
            ("outside", Whole, "what did not pass outside steps"),
        ],
    ),
];

/// The schema of a line (JSON Schema 2020-12), made of the table.
pub fn schema() -> Value {
    let types = |kind: Kind| match kind {
        Text => json!("string"),
        TextOrNull => json!(["string", "null"]),
        Whole => json!("integer"),
        WholeOrNull => json!(["integer", "null"]),
        Number => json!(["number", "null"]),
        Bit => json!("boolean"),
        List => json!("array"),
    };
    let of_event = |(name, doc, keys): &EventKeys| {
        let mut properties = Map::new();
        for (key, kind, doc) in COMMON.iter().chain(*keys) {
            properties.insert(
                (*key).into(),
                json!({ "type": types(*kind), "description": doc }),
            );
        }
        properties.insert("event".into(), json!({ "const": name }));
        let required: Vec<_> = properties.keys().cloned().collect();
        json!({
            "title": name, "description": doc, "type": "object",
            "properties": properties, "required": required,
        })
    };
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": format!("A line of `ptu run --json`, version {VERSION}"),
        "oneOf": EVENTS.iter().map(of_event).collect::<Vec<_>>(),
    })
}
