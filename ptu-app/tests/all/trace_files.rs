//! Traces in other programs' files: written by this one, read by each format's own reader in Python; and
//! other programs' files read by this one.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::{Place, list, number, text};
use fault_db::{
    Channel, ChannelKind, Id, IdSource, OpenOptions, RunRecord, RunWriter, Store, TraceData,
    UnitRecord,
};
use serde_json::{Value, json};

/// Names of the signals of [`trace`] in every format.
const HEADINGS: [&str; 6] = ["speed_kmh", "jerk_m_s3", "effort", "mode", "eb", "empty_v"];
/// Where `scripts/test full` puts the readers, under the target directory.
const READERS: &str = "readers";
/// 2026-03-01 00:00:00 UTC.
const T0_US: i64 = 1_772_323_200_000_000;
const PERIOD_US: i64 = 50_000;

/// The Python that has the readers. Without them nothing would be tested, so that fails.
pub fn python() -> PathBuf {
    if let Some(python) = std::env::var_os("PTU_TEST_PYTHON") {
        return python.into();
    }
    // TARGET/debug/deps/this-test
    let program = std::env::current_exe().expect("a path of its own");
    let target = program.ancestors().nth(3).expect("a target directory");
    let python = target.join(READERS).join("bin/python");
    assert!(
        python.exists(),
        "{} is missing: run scripts/test full once, it installs the readers, or name a Python that has pyarrow, \
         mcap, duckdb, polars and jsonschema in PTU_TEST_PYTHON",
        python.display()
    );
    python
}

pub fn run_python(script: &str, arguments: &[&str]) -> String {
    let script = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/readers")
        .join(script);
    let output = Command::new(python())
        .arg(script)
        .args(arguments)
        .output()
        .expect("Python starts");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {error}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

fn number_channel(name: &str, unit: &str, lsb: f64) -> Channel {
    Channel {
        name: name.into(),
        unit: unit.into(),
        kind: ChannelKind::Number { lsb },
    }
}

/// Every kind of signal, with gaps, over more rows than any writer takes at once (4 096).
pub fn trace(rows: usize) -> TraceData {
    let mode = Channel {
        name: "mode".into(),
        unit: String::new(),
        kind: ChannelKind::Enum {
            labels: [
                (0, "off".into()),
                (1, "자동, ATO".into()),
                (-2, "\"x\"".into()),
            ]
            .into(),
        },
    };
    let bit = Channel {
        name: "eb".into(),
        unit: String::new(),
        kind: ChannelKind::Bit,
    };
    let gap = |row: usize, sample: f64| {
        // One row in eleven, and a long one across the writers' blocks.
        if row % 11 == 3 || (4_000..4_200).contains(&row) {
            f64::NAN
        } else {
            sample
        }
    };
    let column = |f: &dyn Fn(usize) -> f64| (0..rows).map(|row| gap(row, f(row))).collect();
    TraceData {
        t0_bench_us: 12_345_000,
        t0_us: T0_US,
        period_us: PERIOD_US,
        trigger_row: Some(200),
        partial: false,
        gaps: true,
        channels: vec![
            number_channel("speed", "km/h", 0.1),
            number_channel("jerk", "m/s³", 0.001),
            number_channel("effort", "", 1.0),
            mode,
            bit,
            number_channel("empty", "V", 0.1),
        ],
        columns: vec![
            column(&|row| (row % 700) as f64 / 10.0),
            column(&|row| ((row as f64) * 0.37).sin() / 3.0),
            column(&|row| (row % 2049) as f64 - 1024.0),
            // 7 has no word.
            column(&|row| [0.0, 1.0, -2.0, 7.0][row / 50 % 4]),
            column(&|row| f64::from(row >= 200)),
            vec![f64::NAN; rows],
        ],
    }
}

/// A history with one trace; gives its id.
pub fn kept(place: &Place, trace: &TraceData) -> Id {
    let mut next = 0u8;
    let ids = IdSource::new(move || {
        next += 1;
        (T0_US as u64 / 1000, [next; 10])
    });
    let store = Store::open(&place.path("history.db"), OpenOptions::new(ids)).expect("opened");
    let run = RunRecord {
        unit: UnitRecord {
            serial: "BTU-7".into(),
            ..UnitRecord::default()
        },
        line: "line6".into(),
        source: "sim".into(),
        started_at_us: T0_US,
        ..RunRecord::default()
    };
    let mut writer = RunWriter::begin(&store, &run).expect("begun");
    let id = writer.trace(&[], trace).expect("stored");
    drop(writer);
    store.close().expect("closed");
    id
}

/// Goal: what a reader of each format's makers finds is what was recorded: samples, gaps, units, times and
/// whose it is.
#[test]
#[ignore = "long suite: readers of other makers"]
fn each_formats_own_reader_finds_what_was_recorded() {
    let place = Place::new();
    let trace = trace(9_000);
    let id = kept(&place, &trace);
    for file in ["t.csv", "t.parquet", "t.mcap"] {
        let said = place.ptu(&format!("trace export latest --out {file}"));
        said.exits(0).prints(&["9000 rows of 6 signals"]);
        let found = run_python("read_trace.py", &[&place.text_path(file)]);
        let found: Value = serde_json::from_str(&found).expect("JSON");
        assert_eq!(found["headings"], json!(HEADINGS), "{file}");
        let about = &found["about"];
        assert_eq!(text(&about["trace_id"]), id.to_string());
        assert_eq!(text(&about["unit_serial"]), "BTU-7");
        assert_eq!(text(&about["t0"]), "2026-03-01T00:00:00.000Z");
        assert_eq!(about["t0_us"], T0_US);
        assert_eq!(about["t0_bench_us"], 12_345_000);
        assert_eq!(about["period_us"], PERIOD_US);
        assert_eq!(about["trigger_row"], 200);
        assert_eq!(about["gaps"], true);
        let channels: Vec<Channel> =
            serde_json::from_value(about["channels"].clone()).expect("channels");
        assert_eq!(channels, trace.channels, "{file}");
        let run = place.json("runs show latest --json");
        assert_eq!(about["run_id"], run["run"]["id"]);

        for (row, time_s) in list(&found["times_s"]).iter().enumerate() {
            let expected = (row as f64 - 200.0) * 0.05;
            assert!(
                (number(time_s) - expected).abs() < 1e-9,
                "{file} row {row}: {time_s}"
            );
        }
        assert_eq!(list(&found["times_s"]).len(), 9_000);
        if let Some(utc) = found["utc_us"].as_array() {
            for (row, at_us) in utc.iter().enumerate() {
                assert_eq!(*at_us, T0_US + row as i64 * PERIOD_US, "{file} row {row}");
            }
        }
        for (channel, column) in trace.channels.iter().zip(&trace.columns) {
            let name = channel.name.as_str();
            assert_eq!(text(&found["units"][name]), channel.unit, "{file} {name}");
            let samples = list(&found["columns"][name]);
            assert_eq!(samples.len(), column.len(), "{file} {name}");
            for (row, (sample, expected)) in samples.iter().zip(column).enumerate() {
                // Missing is null, all else the same to the last bit.
                let expected = (!expected.is_nan()).then_some(*expected);
                assert_eq!(sample.as_f64(), expected, "{file} {name} row {row}");
            }
        }
    }
}

#[test]
#[ignore = "long suite: readers of other makers"]
fn a_part_has_its_signals_and_its_span() {
    let place = Place::new();
    let is_the_same = |file: &str, span: &str| {
        let said = place.ptu(&["trace", "diff", "latest", file]).exits(0);
        said.prints(&["no signal differs", &format!("compared from {span}")]);
    };
    let trace = trace(600);
    kept(&place, &trace);
    for file in ["t.csv", "t.parquet", "t.mcap"] {
        let part = "--signal mode,speed --window -0.5..1";
        let export = format!("trace export latest --out {file} {part}");
        place.ptu(&export).exits(0);
        let found = run_python("read_trace.py", &[&place.text_path(file)]);
        let found: Value = serde_json::from_str(&found).expect("JSON");
        let times = list(&found["times_s"]);
        assert_eq!(times.len(), 31, "{file}");
        assert!((number(&times[0]) + 0.5).abs() < 1e-9 && (number(&times[30]) - 1.0).abs() < 1e-9);
        assert_eq!(found["about"]["trigger_row"], 10);
        assert_eq!(found["about"]["t0_us"], T0_US + 190 * PERIOD_US);
        let samples = list(&found["columns"]["speed"]);
        assert_eq!(samples[1].as_f64(), Some(trace.columns[0][191]));
        assert_eq!(found["columns"].as_object().map(|c| c.len()), Some(2));
        // Laid at the trace again it is the same.
        is_the_same(file, "-0.50 s to 1.00 s");
    }
    // A part that does not have the trigger.
    let late = "trace export latest --out late.csv --window 5..6";
    place.ptu(late).exits(0);
    is_the_same("late.csv", "5.00 s to 6.00 s");
    let shown = place.ptu("trace show latest --window 5..6 --signal eb");
    assert!(shown.exits(0).out.contains("1.1 s, without the trigger"));
}

/// Goal: a table of another program, sampled by a clock of its own, is compared at the trace's rows. Method:
/// one each 20 ms of the trace's own speed, but 5 km/h more from 2 s after the trigger.
#[test]
fn a_foreign_table_is_laid_at_the_traces_rows() {
    let place = Place::new();
    let mut data = trace(600);
    for (row, sample) in data.columns[0].iter_mut().enumerate() {
        *sample = row as f64 / 10.0;
    }
    kept(&place, &data);
    let mut table = String::from("Time;speed;Scope 1\n");
    for n in -100..1000 {
        let t_s = f64::from(n) * 0.02;
        let wrong = if t_s >= 2.0 { 5.0 } else { 0.0 };
        table += &format!("{:.2};{:.3};1\n", t_s + 0.35, 20.0 + t_s * 2.0 + wrong);
    }
    place.write("scope.csv", &table);
    let diff = "trace diff latest scope.csv --shift -0.35";
    let said = place.ptu(&format!("{diff} --json")).exits(1);
    let found: Value = serde_json::from_str(&said.out).expect("JSON");
    let deviations = list(&found["deviations"]);
    assert_eq!(deviations.len(), 1, "{found}");
    assert_eq!(text(&deviations[0]["signal"]), "speed");
    let first_s = number(&deviations[0]["at_s"]);
    assert!((1.9..2.2).contains(&first_s), "{first_s}");
    assert_eq!(found["from_s"], -2.0);
    assert_eq!(found["missing_in_a"][0], "Scope 1");
    let said = place.ptu(diff).exits(1);
    said.prints(&["speed", "not in B: effort"]);
}

#[test]
#[ignore = "long suite: readers of other makers"]
fn messages_of_another_program_are_laid_at_their_time_of_day() {
    let place = Place::new();
    let mut data = trace(600);
    for (row, sample) in data.columns[0].iter_mut().enumerate() {
        *sample = 60.0 + (row as f64 - 100.0) * 0.05;
    }
    data.channels[0].kind = ChannelKind::Number { lsb: 0.01 };
    kept(&place, &data);
    // From row 100 on, 5 s before the trigger.
    let t0 = (T0_US + 100 * PERIOD_US).to_string();
    run_python("write_mcap.py", &[&place.text_path("m.mcap"), &t0]);
    let found = place.json("trace diff latest m.mcap --json");
    assert_eq!(found["from_s"], -5.0);
    assert_eq!(list(&found["deviations"]), [] as [Value; 0], "{found}");
    assert_eq!(found["missing_in_a"][0], "door/left.open");
    let far = place.ptu("trace diff latest m.mcap --shift 3600");
    far.exits(2).explains(&["no time in common", "--shift"]);
}

/// An MCAP file: each message on a topic of its own with this many fields, all of other names.
fn wide_mcap(messages: usize, fields: usize, name: &str) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    let mut writer = mcap::WriteOptions::new().create(&mut file).expect("begun");
    for topic in 0..messages {
        let field = |n: usize| format!("\"{name}{n}\":{n}");
        let message = (0..fields).map(field).collect::<Vec<_>>().join(",");
        let channel = writer.add_channel(0, &format!("t{topic}"), "json", &BTreeMap::new());
        let header = mcap::records::MessageHeader {
            channel_id: channel.expect("a channel"),
            sequence: 0,
            log_time: T0_US as u64 * 1000,
            publish_time: 0,
        };
        let message = format!("{{{message}}}");
        writer
            .write_to_known_channel(&header, message.as_bytes())
            .expect("written");
    }
    writer.finish().expect("finished");
    drop(writer);
    file.into_inner()
}

/// Goal: a small file with very much in it is refused at once by what it has altogether, not by topic.
#[test]
fn a_file_of_very_many_signals_is_refused_at_once() {
    let place = Place::new();
    kept(&place, &trace(600));
    let write =
        |name: &str, bytes: &[u8]| std::fs::write(place.path(name), bytes).expect("written");
    write("wide.mcap", &wide_mcap(1, 60_000, "f"));
    write("topics.mcap", &wide_mcap(5_000, 1, "f"));
    write("long.mcap", &wide_mcap(1, 1, &"f".repeat(300)));
    let headings: Vec<_> = (0..150_000).map(|n| format!("{n}")).collect();
    write("wide.csv", format!("{}\n", headings.join(",")).as_bytes());
    for (file, told) in [
        ("wide.mcap", "it has more than 4096 signals"),
        ("topics.mcap", "it has more than 4096 signals"),
        ("long.mcap", "is longer than 256 bytes"),
        ("wide.csv", "it has more than 4096 signals"),
    ] {
        let began = std::time::Instant::now();
        let said = place.ptu(&["trace", "diff", "latest", file]);
        said.exits(2).explains(&[file, told]);
        assert!(
            began.elapsed() < std::time::Duration::from_secs(10),
            "{file}"
        );
    }
    // As many as are allowed are no trouble either.
    write("some.mcap", &wide_mcap(1, 4_000, "f"));
    let began = std::time::Instant::now();
    let said = place.ptu("trace diff latest some.mcap");
    said.exits(2).explains(&["none of its signals", "(+3990)"]);
    assert!(began.elapsed() < std::time::Duration::from_secs(10));
}

/// Runs `ptu` where no file may grow beyond a limit, after these words of the shell.
fn short_of_disk(place: &Place, before: &str, arguments: &[&str]) -> crate::common::Said {
    // Blocks of 512 bytes; what SQLite keeps beside an open file takes 64 of them.
    let arguments = arguments.join(" ");
    place.shell(&format!("{before} ulimit -f 80; exec ptu {arguments}"))
}

/// Goal: what a file held before is there, whole, until the new one is; a program that is killed halfway leaves
/// only what the next one that writes into the folder takes away. Method: a limit on the length of files, which
/// kills or fails a write halfway.
#[test]
fn a_file_that_breaks_off_leaves_the_one_before_it() {
    let place = Place::new();
    kept(&place, &trace(40_000));
    place.ptu("runs show latest --report s.html").exits(0);
    let export = |to: &'static str| ["trace", "export", "latest", "--force", "--out", to];
    let names = |place: &Place| {
        let entries = std::fs::read_dir(place.path("")).expect("read");
        let names = entries.map(|entry| entry.expect("an entry").file_name());
        let names: Vec<_> = names
            .map(|name| name.to_string_lossy().into_owned())
            .collect();
        names
            .into_iter()
            .filter(|name| name.ends_with(".part"))
            .count()
    };
    for to in ["t.csv", "t.parquet", "t.mcap"] {
        place.write(to, "old");
        // Whoever starts it may let the signal of the limit end it, or not.
        for before in ["trap '' XFSZ;", ""] {
            let said = short_of_disk(&place, before, &export(to)).exits(3);
            said.explains(&["cannot write", to]);
            assert_eq!(
                (place.read(to), names(&place)),
                ("old".to_owned(), 0),
                "{to}"
            );
        }
    }
    place.write("s.csv", "run,unit_serial,old");
    let report = ["runs", "show", "latest", "--report", "s.csv"];
    place.ptu(&report).exits(0);
    assert!(!place.read("s.csv").contains("old"));
    assert_eq!(names(&place), 0, "what was killed is cleaned");
    place.ptu(&export("t.csv")).exits(0);
    assert_eq!(place.read("t.csv").lines().count(), 40_001);
}
