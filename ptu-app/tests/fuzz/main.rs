//! Every reader of bytes from outside, fed with damaged ones: none panics, takes longer than 10 s, or takes more
//! than 512 MB. Each is fed as often as a check has time for; `CAMPAIGN=50` feeds each fifty times as often.

#[path = "../common/mod.rs"]
mod common;

mod signals;
mod signed;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use ::matrix::{Matrix, read_outcomes};
use btu_rig::bench_scatter::BenchScatter;
use btu_rig::drive::Load;
use btu_rig::drive::Scatter;
use btu_rig::train::TrainData;
use common::Place;
use diagnosis::{Dictionary, Settings as DiagnosisSettings};
use fault_db::trace::{ENCODING, Shape, TraceCodec};
use fault_db::{
    Address, Channel, ChannelKind, FaultFilter, FaultState, OpenOptions, RunFilter, Store,
    TraceData, Verdict,
};
use fuzzing::Fuzz;
use protocol::config::UnitConfig;
use protocol::frame::{self, Decoder, Header};
use protocol::injection::FaultCatalogue;
use protocol::line::{self, Line};
use protocol::link::{End, Link};
use protocol::message::{Address as Party, CATALOGUE, Channel as WireChannel, Message};
use protocol::{Backlog, Duration, Instant};
use ptu_report::Target;
use ptu_report::trace_io::{Columns, Seconds, import};
use ptu_runs::clock::{self, Span};
use ptu_runs::drive::{SectionChoice, Setting};
use ptu_runs::failure::Failure;
use ptu_runs::link::Endpoint;
use ptu_runs::run::{BenchContents, Stimuli, loading};

fn fuzz(name: &str, examples: impl IntoIterator<Item = impl Into<Vec<u8>>>) -> Fuzz {
    Fuzz::new(name, env!("CARGO_MANIFEST_DIR"), examples)
}

/// A reader of texts: of what is no text the readable part.
fn fuzz_text(
    name: &str,
    examples: impl IntoIterator<Item = impl Into<Vec<u8>>>,
    runs: u64,
    read: impl Fn(&str),
) {
    fuzz(name, examples).run(runs, |bytes| read(&String::from_utf8_lossy(bytes)));
}

/// The texts with this ending under a folder of the scripts directory.
fn shipped(folder: &str, ending: &str) -> BTreeMap<String, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scripts");
    let (mut folders, mut texts) = (vec![root.join(folder)], BTreeMap::new());
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("shipped") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|found| found == ending) {
                let name = path
                    .strip_prefix(&root)
                    .expect("under it")
                    .display()
                    .to_string();
                texts.insert(name, std::fs::read_to_string(&path).expect("a text"));
            }
        }
    }
    assert!(!texts.is_empty(), "{folder}/*.{ending}");
    texts
}

/// One payload of each message, its fields counting up.
fn payloads() -> impl Iterator<Item = (WireChannel, Vec<u8>)> {
    CATALOGUE.iter().map(|spec| {
        let fields = (1..spec.payload_len()).map(|place| place as u8);
        (
            spec.channel,
            std::iter::once(spec.code).chain(fields).collect(),
        )
    })
}

#[test]
fn frames_and_the_link() {
    let frames = payloads().enumerate().map(|(seq, (channel, payload))| {
        let mut out = Vec::new();
        let header = Header {
            channel,
            source: Party::Tester,
            destination: Party::Unit,
            seq: seq as u16,
            stamp_ms: 50 * seq as u32,
        };
        frame::encode(&header, &payload, &mut out);
        out
    });
    let frames: Vec<_> = frames.collect();
    let all = frames.concat();
    let mut decoder = Decoder::new();
    let mut links = [Link::new(End::Unit), Link::new(End::Bench)];
    let mut backlog = Backlog::default();
    let mut waiting = 0;
    let mut now = Instant::ZERO;
    fuzz("frames", frames.into_iter().chain([all])).run(100_000, |bytes| {
        decoder.push(bytes);
        while decoder.next_frame().is_some() {}
        now += Duration::from_ms(10);
        for link in &mut links {
            link.push(bytes);
            while let Some(received) = link.poll(now) {
                received.message.encode(&mut Vec::new());
            }
        }
        let behind = u64::from(bytes.first().copied().unwrap_or(0) % 100);
        let mut shared = Vec::new();
        backlog.share(bytes, Duration::from_ms(behind), &mut shared);
        waiting = (waiting + bytes.len())
            .checked_sub(shared.len())
            .expect("no more than came");
        assert!(behind >= 10 || waiting == 0);
    });
}

#[test]
fn messages_of_every_layout() {
    let examples = payloads().map(|(channel, payload)| [vec![channel.code()], payload].concat());
    fuzz("messages", examples).run(1_000_000, |bytes| {
        let Some((channel, payload)) = bytes.split_first() else {
            return;
        };
        let Some(channel) = WireChannel::from_code(channel % 5) else {
            return;
        };
        if let Ok(message) = Message::decode(channel, payload) {
            let mut again = Vec::new();
            message.encode(&mut again);
            assert_eq!(again, payload, "nothing is lost of it");
            if payload.len() % 16 == 0 {
                message.show();
            }
        }
    });
}

#[test]
fn unit_configurations_lines_and_faults() {
    let mut units = shipped("units", "toml");
    let faults = units.remove("units/faults.toml").expect("shipped");
    fuzz_text("unit-config", units.into_values(), 4_000, |text| {
        let _ = UnitConfig::from_toml(text);
    });
    fuzz_text(
        "line",
        shipped("lines", "toml").into_values(),
        1_500,
        |text| {
            let _ = Line::from_toml(text).map(|_| line::checksum(text));
        },
    );
    fuzz_text("faults", [faults], 300, |text| {
        let _ = FaultCatalogue::from_toml(text);
    });
}

#[test]
fn trains_scatter_and_sequences() {
    fuzz_text(
        "train",
        shipped("trains", "toml").into_values(),
        4_000,
        |text| {
            let _ = TrainData::from_toml(text);
        },
    );
    let top = |name: &str| {
        let file = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../scripts")
            .join(name);
        std::fs::read_to_string(file).expect("shipped")
    };
    fuzz_text("scatter", [top("scatter.toml")], 4_000, |text| {
        let _ = Scatter::from_toml(text);
    });
    fuzz_text(
        "bench-scatter",
        [top("bench_scatter.toml")],
        4_000,
        |text| {
            let _ = BenchScatter::from_toml(text);
        },
    );
    fuzz_text(
        "diagnosis-settings",
        [top("diagnosis.toml")],
        4_000,
        |text| {
            let read = toml::from_str::<DiagnosisSettings>(text);
            let _ = read.map(|settings| settings.check());
        },
    );
}

/// Scripts are fed a folder at a time, as the program loads them: in a process with limits.
#[test]
fn scripts() {
    const FOLDER: usize = 40;
    loading::load_apart(env!("CARGO_BIN_EXE_ptu").into());
    let texts = shipped("", "star");
    let toml = |folder: &str, name: &str| shipped(folder, "toml")[name].clone();
    let unit = UnitConfig::from_toml(&toml("units", "units/sg100.toml")).expect("shipped");
    let line = Line::from_toml(&toml("lines", "lines/line8.toml")).expect("shipped");
    let libraries = texts.iter().filter(|(path, _)| path.starts_with('_'));
    let libraries: BTreeMap<_, _> = libraries
        .map(|(path, text)| (path.clone(), text.clone()))
        .collect();
    let mut folder = libraries.clone();
    fuzz("scripts", texts.values().map(String::as_str)).run(800, |bytes| {
        let name = format!("s{}.star", folder.len());
        folder.insert(name, String::from_utf8_lossy(bytes).into_owned());
        if folder.len() == libraries.len() + FOLDER {
            let loaded = loading::load(&folder, &unit, &line, &TrainData::line6());
            let loaded = loaded.unwrap_or_else(|failure| panic!("{failure}: {folder:?}"));
            for error in &loaded.errors {
                assert!(
                    !error.message.contains("the script language broke off"),
                    "{error}: {:?}",
                    folder[&error.file]
                );
            }
            folder.clone_from(&libraries);
        }
    });
}

/// A folder in memory, where the system has one.
fn memory() -> tempfile::TempDir {
    let in_memory = Path::new("/dev/shm");
    match in_memory.is_dir() {
        true => tempfile::tempdir_in(in_memory),
        false => tempfile::tempdir(),
    }
    .expect("a folder")
}

fn channel(name: &str, kind: ChannelKind) -> Channel {
    Channel {
        name: name.into(),
        unit: "km/h".into(),
        kind,
    }
}

fn trace(rows: usize) -> TraceData {
    let labels = [(0, "off".to_owned()), (1, "ato".to_owned())].into();
    TraceData {
        t0_us: 1_772_323_200_000_000,
        period_us: 50_000,
        trigger_row: Some(2),
        gaps: true,
        channels: vec![
            channel("speed", ChannelKind::Number { lsb: 0.01 }),
            channel("eb", ChannelKind::Bit),
            channel("mode", ChannelKind::Enum { labels }),
        ],
        columns: vec![
            (0..rows)
                .map(|row| (row as f64 / 7.0).sin() * 80.0)
                .collect(),
            (0..rows).map(|row| f64::from(row % 9 == 0)).collect(),
            (0..rows)
                .map(|row| if row % 5 == 0 { f64::NAN } else { 1.0 })
                .collect(),
        ],
        ..TraceData::default()
    }
}

#[test]
fn tables_and_messages_of_other_programs() {
    let folder = memory();
    let known = trace(1).channels;
    let file = |name: &str| folder.path().join(name);
    let read = |file: &PathBuf, bytes: &[u8]| {
        std::fs::write(file, bytes).expect("written");
        let read = import(file, &known, &Columns::default());
        let tables = refused_by_name(file, read).map_or_else(Vec::new, |read| read.tables);
        for table in &tables {
            let rows = table.times_us.len();
            assert!(table.times_us.is_sorted() && table.channels.len() == table.columns.len());
            assert!(table.columns.iter().all(|column| column.len() == rows));
        }
        let columns = tables.into_iter().flat_map(|table| table.columns);
        let samples = columns.flatten().filter(|sample| sample.is_finite());
        samples.collect::<Vec<_>>()
    };
    let tables = [
        "time_s,speed (km/h),eb,mode\n-0.1,1.5,0,off\n-0.05,2,1,ato\n0,,true,1\n",
        "\u{feff}t;\"a \"\"b\"\"\";mode\r\n-0.5;1e3;ato\r\n1;nan;0\r\n",
        "t\ta\n0\t1\n",
    ];
    let csv = file("t.csv");
    fuzz("csv", tables).run(60_000, |bytes| drop(read(&csv, bytes)));
    // What is read stands there: no number comes of two halves, or of another column's unit.
    fuzz("csv-numbers", ["time_s,speed\n-2,20\n-1,10.5\n3,7e1\n"]).run(8_000, |bytes| {
        // A cell that is no UTF-8 is read as Latin-1, which has a space of its own.
        let latin: String = bytes.iter().copied().map(char::from).collect();
        let text = String::from_utf8_lossy(bytes).into_owned() + "\n" + &latin;
        let text = text.replace(['\u{feff}', '\0'], "");
        let cells: Vec<_> = (text.split([',', ';', '\t', '\n', '\r', '"']))
            .chain(text.split([';', '\t', '\n', '\r', '"']))
            .filter_map(|cell| cell.trim().replacen(',', ".", 1).parse::<f64>().ok())
            .collect();
        let found = read(&csv, bytes);
        let astray = found.iter().find(|sample| !cells.contains(sample));
        assert_eq!(astray, None, "{text:?}: {found:?}");
    });
    std::fs::write(&csv, tables[0]).expect("written");
    let about = r#"{"notes":[{"trace_id":"a","run_id":"b","unit_serial":"c","t0":"d","t0_us":1,"t0_bench_us":2,
        "period_us":50000,"rows":3,"trigger_row":1,"partial":false,"gaps":true,"channels":
        [{"name":"speed","unit":"km/h","kind":{"number":{"lsb":0.1}}}]}]}"#;
    let beside = file("t.csv-metadata.json");
    fuzz("csv-description", [about]).run(20_000, |bytes| {
        std::fs::write(&beside, bytes).expect("written");
        let _ = import(&csv, &known, &Columns::default());
    });
    let mcap = file("t.mcap");
    let examples = [mcap_file(None), mcap_file(Some(mcap::Compression::Zstd))];
    fuzz("mcap", examples.clone()).run(40_000, |bytes| drop(read(&mcap, bytes)));
    // Chunks have checksums: a number in them is that of the example, or the file is refused.
    fuzz("mcap-numbers", examples).run(8_000, |bytes| {
        let found = read(&mcap, bytes);
        let is_written = |sample: &f64| [0.5, 1.0, 1.5, 2.5, 3.5].contains(sample);
        assert!(found.iter().all(is_written), "{found:?}");
    });
    let parquet = file("t.parquet");
    fuzz("parquet", [parquet_file()]).run(20_000, |bytes| drop(read(&parquet, bytes)));
}

/// Result of reading a file; an error names the file.
fn refused_by_name<T>(file: &Path, read: Result<T, Failure>) -> Option<T> {
    let name = file.display().to_string();
    read.inspect_err(|error| assert!(error.to_string().contains(&name), "{error}"))
        .ok()
}

/// A trace of a run, as the program itself exports it.
fn parquet_file() -> Vec<u8> {
    let place = Place::new();
    place
        .ptu("run atp/overspeed --inject eb_relay.slow")
        .exits(1);
    let export = ["trace", "export", "latest", "--out", "t.parquet"];
    let part = ["--signal", "speed,eb,mode", "--window", "-0.2..0.2"];
    place.ptu(&[&export[..], &part].concat()).exits(0);
    std::fs::read(place.path("t.parquet")).expect("written")
}

fn mcap_file(compression: Option<mcap::Compression>) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    let options = mcap::WriteOptions::new().compression(compression);
    let mut writer = options
        .compression_threads(0)
        .create(&mut file)
        .expect("begun");
    let channel = writer
        .add_channel(0, "/drive", "json", &BTreeMap::new())
        .expect("a channel");
    for n in 0..4u32 {
        let header = mcap::records::MessageHeader {
            channel_id: channel,
            sequence: n,
            log_time: 1_000_000 * u64::from(n),
            publish_time: 0,
        };
        let message = format!(r#"{{"speed":{n}.5,"door":{{"left":true,"n":null}},"text":"x"}}"#);
        writer
            .write_to_known_channel(&header, message.as_bytes())
            .expect("written");
    }
    let metadata = BTreeMap::from([("about".to_owned(), "{}".to_owned())]);
    let name = "ptu.trace".to_owned();
    writer
        .write_metadata(&mcap::records::Metadata { name, metadata })
        .expect("written");
    writer.finish().expect("finished");
    drop(writer);
    file.into_inner()
}

#[test]
fn packed_traces() {
    let mut codec = TraceCodec::new().expect("a codec");
    let examples: Vec<_> = [3, 40, 700]
        .map(|rows| (rows, codec.encode(&trace(rows)).expect("packed")))
        .into();
    let channels = trace(1).channels;
    // What the table says of the rows may be of another trace.
    let rows: BTreeMap<usize, usize> = examples
        .iter()
        .map(|(rows, blob)| (blob.len(), *rows))
        .collect();
    let mut turn = 0;
    fuzz("trace-codec", examples.into_iter().map(|(_, blob)| blob)).run(100_000, |blob| {
        turn += 1;
        let rows = rows
            .get(&blob.len())
            .copied()
            .unwrap_or([3, 40, 700, 0, 1 << 20][turn % 5]);
        let shape = Shape {
            encoding: if turn % 7 == 0 { 1 } else { ENCODING },
            rows,
            channels: &channels,
        };
        let _ = codec.decode(blob, &shape, &[0, 1, 2], 0..rows);
    });
}

#[test]
fn matrices_and_dictionaries() {
    let matrix = r#"{"states":[{"id":"a","p":0.5},{"id":"b","p":0.25}],"tests":[{"id":"t","cost":1.5},{"id":"u","cost":2}],
        "outcomes":{"t":{"a":1,"b":0.5},"u":{"b":1}}}"#;
    fuzz_text("matrix", [matrix], 60_000, |text| {
        let _ = Matrix::from_json(text);
    });
    let table = "state;p;flow;noise\ncost;;5;2,5\nsound;0.5;ok;0\nleak;0.5;low;1\n";
    fuzz_text("matrix-table", [table], 60_000, |text| {
        let _ = Matrix::from_csv(text);
    });
    fuzz_text(
        "outcomes",
        [r#"{"t":"pass","u":"fail"}"#, r#"{"t":0,"u":1}"#],
        60_000,
        |text| {
            let _ = read_outcomes(text);
        },
    );
    let packed = Dictionary::new(Default::default(), vec![1, 2], Vec::new())
        .to_bytes()
        .expect("packed");
    fuzz("dictionary-packed", [packed]).run(20_000, |bytes| {
        let _ = Dictionary::from_bytes(bytes);
    });
}

#[test]
fn recordings() {
    let made = r#"{"source":"sim","serial":"S","unit_config":{"name":"sg100","sha256":"a"},"line":{"name":"line8","sha256":"b"},
        "train":{"name":"line6","sha256":"c"},"seed":1,"scatter":null,"realtime":false}"#;
    fuzz_text("bench-made", [made], 60_000, |text| {
        let _ = serde_json::from_str::<BenchContents>(text);
    });
    let stimuli = r#"{"began_us":5,"tape":{"deeds":[{"at_us":1,"act":{"stimulus":{"speed":{"to_mps":1.5,"accel_mps2":1.0}}}},
        {"at_us":2,"act":{"stimulus":"code_off"}}],"lost":0}}"#;
    fuzz_text("stimuli", [stimuli], 60_000, |text| {
        if let Ok(stimuli) = serde_json::from_str::<Stimuli>(text) {
            let _ = serde_json::to_string(&stimuli);
        }
    });
}

#[test]
fn words_of_the_command_line() {
    let addresses = [
        "postgres://kim@host:5432/history?sslmode=require&sslrootcert=/a.pem",
        "postgresql:///h?host=/var/run&user=a%20b",
        "postgres://[::1]:1/x",
    ];
    fuzz_text("address", addresses, 100_000, |text| {
        let _ = Address::is_meant(text);
        if let Ok(address) = text.parse::<Address>() {
            let _ = address.to_string();
        }
    });
    let words = [
        "30d",
        "12h",
        "2026-03",
        "2026-03-21",
        "2026-03..2026-05",
        "..2026",
        "-2..5",
        "1.5..",
        "sim",
        "serial:/dev/tty@9600",
        "tcp:[::1]:7000",
        "tcp:host:7000",
        "ato.servo.s_curve_s=12",
        "54-65",
        "all",
        "full",
        "12000",
        "a.junit.xml",
        "failed",
        "open",
        "262143-01-01",
        "9999999999999999d",
    ];
    fuzz_text("words", words, 100_000, |text| {
        let _ = text.parse::<Span>();
        let _ = text.parse::<Seconds>();
        let _ = text.parse::<Endpoint>();
        let _ = text.parse::<Setting>();
        let _ = text.parse::<SectionChoice>();
        let _ = text.parse::<Load>();
        let _ = text.parse::<Target>();
        let _ = text.parse::<Verdict>();
        let _ = text.parse::<FaultState>();
    });
}

/// A file of the history with some bytes that are others: it is read as far as it goes, or refused.
#[test]
fn databases() {
    let place = Place::new();
    place
        .ptu("run tcms/link atp/overspeed --inject eb_relay.slow")
        .exits(1);
    place.ptu("db prune --older-than 99999d");
    let whole = std::fs::read(place.path("history.db")).expect("recorded");
    let folder = memory();
    let file = folder.path().join("a.db");
    fuzz("database", [whole]).run(150, |bytes| {
        for entry in std::fs::read_dir(folder.path()).expect("read").flatten() {
            std::fs::remove_file(entry.path()).expect("removed");
        }
        std::fs::write(&file, bytes).expect("written");
        let Ok(store) = Store::open_read_only(&file) else {
            return;
        };
        let _ = store.check();
        let _ = store.faults(&FaultFilter::default());
        for run in store.runs(&RunFilter::default()).unwrap_or_default() {
            let _ = store.run(run.id);
            for trace in store.traces(run.id).unwrap_or_default() {
                let _ = store.trace(trace.id);
                let _ = store
                    .recording(trace.id)
                    .map(|kept| kept.map(|kept| BenchContents::read(&kept)));
            }
        }
        drop(store);
        let options = OpenOptions::new(clock::ids()).busy_timeout_ms(1);
        let _ = Store::open(&file, options).map(Store::close);
    });
}
