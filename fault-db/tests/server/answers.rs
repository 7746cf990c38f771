//! Every question gets the same answer from a file and from the server it was synced with.

use crate::common::{Deeds, filter, refused, repair_of, with};
use std::fmt::Debug;

use fault_db::{
    CauseRecord, FaultFilter, FaultState, QueryBounds, QueryLimit, RecordingRecord, RepairsOf,
    RunFilter, RunWriter, StatQuery, Store, StoreError, TrendQuery, Verdict,
};

use crate::common;
use crate::laptop::{Laptop, day, read_only};
use crate::private::shared;

/// Two months of three units: faults that come back, repairs, notes in two languages, trains, traces.
fn history(laptop: &Laptop) {
    let store = laptop.open();
    for n in 0..24_i64 {
        let mut record = common::run_record(["U-1", "U-2", "부품-3"][(n % 3) as usize]);
        record.started_at_us = day(2 * n) + n * 1_000_000;
        record.line = ["line6", "line8"][(n % 2) as usize].to_owned();
        record.train = ["", "T1", "T2"][(n % 3) as usize].to_owned();
        record.source = ["sim", "serial:/dev/ttyS0"][(n % 2) as usize].to_owned();
        let mut run = RunWriter::begin(&store, &record).expect("a run");
        for index in 0..4 {
            let mut step = common::step(index);
            step.procedure = ["atp/a", "door/b"][(index % 2) as usize].to_owned();
            let value = 0.42 + 0.002 * n as f64 + 0.01 * f64::from(index);
            step.measurements
                .push(common::measurement("eb_reaction", value));
            let mut nothing = common::measurement("door_time", 0.0);
            nothing.value = None;
            step.measurements.push(nothing);
            run.step(step).expect("a step");
        }
        for (code, every) in [(101, 2), (102, 3), (103, 5)] {
            if n % every != 0 {
                continue;
            }
            let mut fault = common::fault(code, record.started_at_us + code * 1_000_000);
            fault.lru = ["ATP-RX", "eb_relay", ""][(code % 3) as usize].to_owned();
            let stored = run.fault(&fault).expect("a fault");
            if n < 6 {
                let trace = common::realistic_trace(50, code.unsigned_abs());
                let trace = run.trace(&[stored.occurrence], &trace).expect("a trace");
                let recording = RecordingRecord {
                    ordinal: u32::try_from(code - 101).expect("small"),
                    procedure: "atp/a".to_owned(),
                    t0_bench_us: 5,
                    bench_json: "{\"seed\":1}".to_owned(),
                    stimuli_json: "[1,2,3]".to_owned(),
                };
                run.recording(&recording, &[trace]).expect("a recording");
            }
        }
        let mut end = common::end([Verdict::Failed, Verdict::Passed][(n % 2) as usize]);
        end.finished_at_us = record.started_at_us + 300_000_000;
        run.finish(&end).expect("an end");
        let id = store.resolve_run("latest").expect("a run");
        if n % 6 == 0 {
            let text = format!("K{n} 릴레이 늦음, clicks late");
            store.put_run_note(id, "kim", &text, end.finished_at_us);
        }
        if n % 5 == 0 {
            let seen = store.run_occurrences(id).expect("its faults");
            let seen: Vec<_> = seen.iter().map(|seen| seen.fault).collect();
            let cause = with(|it: &mut CauseRecord| it.part = "eb_relay".to_owned());
            store.put_diagnosed(&seen, &cause, end.finished_at_us);
        }
        if n % 4 == 3 {
            people(&store, end.finished_at_us + 3_600_000_000);
        }
    }
}

fn people(store: &Store, at_us: i64) {
    let open = store.faults(&FaultFilter::default()).expect("faults");
    let open = open
        .iter()
        .filter(|fault| fault.state != FaultState::Closed);
    for (n, fault) in (0..).zip(open) {
        let say = |state| {
            store
                .set_state(fault.id, state, "lee", "", at_us + n)
                .map(drop)
        };
        let done = match (n % 3, fault.state) {
            (0, FaultState::Open) => {
                let repair = repair_of(" EB_Relay ", "", &format!("SN-{n}"), "부품 교체함");
                store
                    .record_repair(fault.id, &repair, "lee", at_us + n)
                    .map(drop)
            }
            (_, FaultState::Repaired) => {
                let run = store.resolve_run("latest").expect("a run");
                let proven = [(fault.id, "by a run".to_owned())];
                store.confirm_repairs(run, &proven).map(drop)
            }
            (0 | 1, FaultState::Verified) => say(FaultState::Closed),
            (1, FaultState::Open) => say(FaultState::Closed),
            _ => store.add_note(fault.id, "kim", "seen near PSM2; wait", at_us + n),
        };
        done.expect("people may");
    }
}

type Question = (
    &'static str,
    Box<dyn Fn(&Store) -> Result<String, StoreError>>,
);

fn question<T: Debug>(
    name: &'static str,
    ask: impl Fn(&Store) -> Result<T, StoreError> + 'static,
) -> Question {
    (
        name,
        Box::new(move |store| Ok(rounded(&format!("{:#?}", ask(store)?)))),
    )
}

/// Sums of the same numbers in another order differ in their last digits.
fn rounded(text: &str) -> String {
    let line = |line: &str| {
        let body = line.trim_end_matches(',');
        let start = body.rfind(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c)));
        let (before, number) = body.split_at(start.map_or(0, |at| {
            at + body[at..].chars().next().map_or(1, char::len_utf8)
        }));
        match number.parse::<f64>() {
            Ok(value) if number.contains('.') => format!("{before}{value:.9e}\n"),
            _ => format!("{line}\n"),
        }
    };
    text.lines().map(line).collect()
}

/// Lists, and everything in them one by one.
fn lists() -> Vec<Question> {
    vec![
        question("runs", |store| store.runs(&RunFilter::default())),
        question("runs of a unit", |store| {
            store.runs(&with(|it: &mut RunFilter| {
                (it.unit, it.verdict) = (Some("부품-3".to_owned()), Some(Verdict::Failed));
                (it.since_us, it.until_us, it.limit) = (Some(day(3)), Some(day(40)), Some(3));
            }))
        }),
        question("every run", |store| {
            let runs = store.runs(&RunFilter::default())?;
            let each = |run: &fault_db::RunSummary| {
                let detail = store.run(run.id)?;
                let mut traces = store.traces(run.id)?;
                traces.sort_by_key(|trace| trace.id);
                Ok((detail, store.run_occurrences(run.id)?, traces))
            };
            runs.iter()
                .map(each)
                .collect::<Result<Vec<_>, StoreError>>()
        }),
        question("every fault", |store| {
            let faults = store.faults(&FaultFilter::default())?;
            let details = faults.iter().map(|fault| store.fault(fault.id));
            details.collect::<Result<Vec<_>, StoreError>>()
        }),
        question("a trace", |store| {
            let id = store.resolve_trace("latest")?;
            Ok((
                store.trace_head(id)?,
                store.trace(id)?,
                store.trace_channels(id, &["speed", "bit_3"])?,
                store.trace_window(id, &["position", "enum_1"], 7..31)?,
                store.trace_channels(id, &["no_such"]).is_err(),
                store.recording(id)?,
            ))
        }),
        question("ids by their ends", |store| {
            let id = store.resolve_run("latest")?;
            let (text, fault) = (id.to_string(), store.resolve_fault("latest")?.to_string());
            Ok((
                store.resolve_run(&text)?,
                store.resolve_run(&id.short())?,
                store.resolve_fault(&fault[28..])?,
                store
                    .resolve_fault(&fault[30..])
                    .map_err(|error| error.to_string()),
            ))
        }),
        question("codes and parts", |store| {
            Ok((store.known_codes()?, store.known_lrus()?))
        }),
        question("names", |store| {
            let names = [
                store.known_parts()?,
                store.known_units()?,
                store.known_trains()?,
                store.known_lines()?,
                store.known_procedures()?,
                store.known_part_serials()?,
            ];
            assert!(names.iter().all(|names| !names.is_empty()), "{names:?}");
            Ok(names)
        }),
        question("a unit's history", |store| {
            let parts = store.part_history("U-1", (0, day(60)), None)?;
            let spans = store.tested_spans("U-2")?;
            let known = store.knows_occurrence("U-1", (101, "speed code lost"), None)?;
            Ok((parts, spans, known))
        }),
        question("lives by serial number", |store| {
            let serials = ["U-1", "부품-3", "T1", "SN-0", "nothing"];
            let lives = serials.map(|serial| store.lives(serial));
            let lives = lives.into_iter().collect::<Result<Vec<_>, _>>()?;
            let known: Vec<_> = lives.iter().map(Vec::len).collect();
            assert_eq!(known, [1, 1, 1, 1, 0]);
            Ok(lives)
        }),
        question("what confirmed repairs tell", |store| {
            let of = RepairsOf {
                before_us: day(60),
                unit_type: "default",
                practice: true,
            };
            let repairs = store.confirmed_repairs(of)?;
            let cases = store.confirmed_cases(of, 20)?;
            assert!(repairs.values().any(|of| of.named > 0) && !cases.is_empty());
            Ok((repairs, cases))
        }),
    ]
}

fn filters() -> Vec<FaultFilter> {
    let text = |text: &str| Some(text.to_owned());
    vec![
        FaultFilter::default(),
        filter(|f| f.unit = text("U-1")),
        filter(|f| f.code = text("fault_102")),
        filter(|f| f.code = text("0x65")),
        filter(|f| f.code = text("102, FAULT_101,101,4711")),
        filter(|f| f.states = vec![FaultState::Repaired, FaultState::Closed]),
        filter(|f| f.lru = text("EB_RELAY")),
        filter(|f| f.cause = text("EB_RELAY")),
        filter(|f| f.severity = text("MAJOR")),
        filter(|f| f.states = vec![FaultState::Open]),
        filter(|f| f.line = text("line6")),
        filter(|f| f.train = text("T1")),
        filter(|f| f.procedure = text("door/b")),
        filter(|f| f.serial = text("SN-0")),
        filter(|f| f.note = text("교체")),
        filter(|f| f.note = text("clicks rel")),
        filter(|f| f.note = text("psm2 wai")),
        filter(|f| (f.since_us, f.until_us) = (Some(day(10)), Some(day(31)))),
        filter(|f| (f.limit, f.unit) = (Some(2), text("U-2"))),
    ]
}

fn trends() -> Vec<TrendQuery> {
    let of = |measurement: &str| TrendQuery {
        measurement: measurement.to_owned(),
        ..TrendQuery::default()
    };
    let eb = |change: &dyn Fn(&mut TrendQuery)| {
        let mut query = of("eb_reaction");
        change(&mut query);
        query
    };
    vec![
        of("eb_reaction"),
        of("door_time"),
        eb(&|q| q.unit = Some("U-1".to_owned())),
        eb(&|q| q.line = Some("line8".to_owned())),
        eb(&|q| (q.procedure, q.since_us) = (Some("atp/a".to_owned()), Some(day(5)))),
        eb(&|q| (q.train, q.until_us) = (Some("T2".to_owned()), Some(day(40)))),
    ]
}

#[test]
fn a_server_gives_the_answers_its_files_give() {
    let laptop = Laptop::new("answers");
    history(&laptop);
    let address = shared().database();
    laptop.sync(&address);
    let file = Store::open_read_only(&laptop.path()).expect("its file");
    let server = read_only(&address).expect("a server");

    let mut questions = lists();
    for filter in filters() {
        let name = "faults by a filter";
        let wanted = filter.clone();
        questions.push(question(name, move |store| {
            Ok((wanted.clone(), store.faults(&wanted)?))
        }));
        for by in common::STAT_KEYS {
            let mut filter = filter.clone();
            filter.limit = None;
            let query = StatQuery {
                by,
                filter,
                now_us: day(60),
                back_within_days: 10,
            };
            questions.push(question("stats", move |store| {
                Ok((query.clone(), store.stats(&query)?))
            }));
        }
    }
    for query in trends() {
        questions.push(question("trend", move |store| {
            let points = (store.trend(&query)?, store.trend_by_day(&query)?);
            let units = (store.trend_by_unit(&query)?, store.trend_limits(&query)?);
            Ok((query.clone(), points, units))
        }));
    }
    questions.push(question("measurements", |store| {
        let names = store.measurement_names()?;
        let of_values = store.measuring_procedures("eb_reaction")?;
        let of_no_value = store.measuring_procedures("door_time")?;
        let repaired = store.last_repair("U-1", "eb_relay")?;
        Ok((
            names,
            of_values,
            of_no_value,
            repaired,
            store.history_span()?,
        ))
    }));

    let mut differ = Vec::new();
    for (name, ask) in &questions {
        let (of_file, of_server) = (ask(&file).expect(name), ask(&server));
        match of_server {
            Ok(of_server) if of_server == of_file => {}
            Ok(of_server) => {
                let lines = of_file.lines().zip(of_server.lines());
                let (n, first) = lines
                    .enumerate()
                    .find(|(_, (a, b))| a != b)
                    .unwrap_or_default();
                let about = of_file.lines().take(60).collect::<Vec<_>>().join(" ");
                differ.push(format!("{name}: line {n}: {first:?} in {about}"));
            }
            Err(error) => differ.push(format!("{name}: {error}")),
        }
        assert!(of_file.len() > 4, "{name}: an empty answer proves nothing");
    }
    assert!(
        differ.is_empty(),
        "{} of {}:\n{}",
        differ.len(),
        questions.len(),
        differ.join("\n\n")
    );
}

/// Numbers of halves and thirds may differ in their last digits.
fn row_text(row: &[fault_db::SqlValue]) -> String {
    let value = |value: &fault_db::SqlValue| match value {
        fault_db::SqlValue::Real(real) => format!("{real:.9e}"),
        other => format!("{other:?}"),
    };
    row.iter().map(value).collect::<Vec<_>>().join(" | ")
}

#[test]
fn views_say_the_same_on_a_server_as_in_a_file() {
    let laptop = Laptop::new("views");
    history(&laptop);
    let address = shared().database();
    laptop.sync(&address);
    let file = Store::open_read_only(&laptop.path()).expect("its file");
    let server = read_only(&address).expect("a server");
    let names = "SELECT name FROM sqlite_schema WHERE type = 'view' ORDER BY name";
    let names = file.query_read_only(names, 100).expect("views").rows;
    assert!(names.len() > 4, "{names:?}");
    for name in names {
        let fault_db::SqlValue::Text(name) = &name[0] else {
            panic!("{name:?}")
        };
        let [here, there] = [&file, &server].map(|store| {
            let answer = store.query_read_only(&format!("SELECT * FROM {name}"), 10_000);
            let answer = answer.unwrap_or_else(|error| panic!("{name}: {error}"));
            let mut rows: Vec<_> = answer.rows.iter().map(|row| row_text(row)).collect();
            rows.sort();
            (answer.columns, rows)
        });
        assert!(!here.1.is_empty(), "{name}");
        assert_eq!(there, here, "{name}");
    }
}

#[test]
fn an_sql_query_on_a_server_is_answered_and_cannot_change_anything() {
    let laptop = Laptop::new("sql");
    laptop.run("U-1", day(0), &[101, 102], false);
    let address = shared().database();
    laptop.sync(&address);
    let server = read_only(&address).expect("a server");
    let asked = "SELECT f.id, f.code, f.lru, sum(f.occurrences) AS seen, avg(f.code), NULL
        FROM fault f GROUP BY f.id, f.code, f.lru ORDER BY f.code";
    let answer = server.query_read_only(asked, 1).expect("an answer");
    let file = Store::open_read_only(&laptop.path()).expect("its file");
    let of_file = file.query_read_only(asked, 1).expect("an answer");
    assert_eq!(answer.rows, of_file.rows);
    assert_eq!(answer.columns[..4], ["id", "code", "lru", "seen"]);
    assert!(answer.truncated);

    let repairs = server
        .query_read_only("SELECT * FROM repair", 10)
        .expect("an answer");
    assert_eq!(repairs.columns.len(), 10);
    // Whoever may write may not do it here either.
    let owner = address.replace("laptop@", "ptu@");
    let writer = crate::laptop::connect(&owner).expect("a server");
    for (sql, words) in [
        ("DELETE FROM laptop", "more than read"),
        (
            "INSERT INTO meta VALUES ('a', 'b') RETURNING key",
            "more than read",
        ),
        ("SELECT nextval('run_seq_seq')", "more than read"),
        ("COMMIT", "more than read"),
        ("SELECT 1; DROP TABLE run", "second statement"),
        (" ; ", "empty"),
        ("SELEC 1", "syntax error"),
        ("SELECT * FROM no_such", "does not exist"),
        ("SELECT now()", "CAST it to TEXT"),
    ] {
        refused!(writer.query_read_only(sql, 10), _, words);
    }
    let sleeps = "SELECT CAST(pg_sleep(600) AS TEXT)";
    for (sql, server_ms, limit) in [
        (sleeps, Some(200), QueryLimit::Stopped),
        ("SELECT repeat('x', 20000000)", None, QueryLimit::Row),
    ] {
        let bounds = QueryBounds {
            rows: 10,
            server_ms,
            ..QueryBounds::default()
        };
        let stopped = writer.query_within(sql, bounds, || true);
        refused!(stopped, StoreError::QueryExceeds(found) if *found == limit);
    }
    let alive = writer.query_read_only("SELECT 1", 10);
    assert_eq!(alive.expect("still alive").rows.len(), 1);
}
