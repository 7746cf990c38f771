//! Small files of other programs that unpack to very much: refused, or read, in the memory that any file may take.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::sync::Arc;

use fault_db::{Channel, ChannelKind};
use parquet::basic::{Compression, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

use crate::common::{Place, Said};
use crate::trace_files::{kept, trace};

/// Memory that a file of at most 10 MB may take, KiB.
const MOST_KIB: u32 = 512 * 1024;
/// And the processor's time, s.
const MOST_S: u32 = 10;

/// The file beside the latest trace, in the memory and time that any may take.
fn beside(place: &Place, file: &str, bytes: &[u8]) -> Said {
    assert!(bytes.len() <= 10 << 20, "{file} has {} bytes", bytes.len());
    std::fs::write(place.path(file), bytes).expect("written");
    let limits = format!("ulimit -d {MOST_KIB}; ulimit -t {MOST_S};");
    place.shell(&format!("{limits} exec ptu trace diff latest {file}"))
}

/// Seconds and a text each row, in pages of about so many bytes.
fn texts(rows: usize, text: &[u8], page: usize) -> Vec<u8> {
    let schema = "message m { required double time_s; required binary mode (UTF8); }";
    let schema = Arc::new(parse_message_type(schema).expect("a schema"));
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(3).expect("a level")))
        .set_dictionary_enabled(false)
        .set_data_page_size_limit(page)
        .build();
    let mut file = Vec::new();
    let writer = SerializedFileWriter::new(&mut file, schema, Arc::new(properties));
    let mut writer = writer.expect("begun");
    let mut group = writer.next_row_group().expect("a group");
    let times: Vec<_> = (0..rows).map(|row| row as f64).collect();
    let mut column = group.next_column().expect("a column").expect("of times");
    let written = column.typed::<DoubleType>().write_batch(&times, None, None);
    written.expect("written");
    column.close().expect("closed");
    let mut column = group.next_column().expect("a column").expect("of texts");
    let text = ByteArray::from(text.to_vec());
    for _ in 0..rows {
        let one = std::slice::from_ref(&text);
        let written = column.typed::<ByteArrayType>().write_batch(one, None, None);
        written.expect("written");
    }
    column.close().expect("closed");
    group.close().expect("closed");
    writer.close().expect("finished");
    file
}

/// A chunk that says it has so many bytes, and has as many zeros.
fn zeros(bytes: u64) -> Vec<u8> {
    let packed = zstd::encode_all(std::io::repeat(0).take(bytes), 3).expect("packed");
    let text = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    let chunk = [
        &[0; 16][..],
        &bytes.to_le_bytes(),
        &[0; 4],
        &text("zstd"),
        &(packed.len() as u64).to_le_bytes(),
        &packed,
    ]
    .concat();
    let record = |kind: u8, content: &[u8]| {
        [&[kind], &(content.len() as u64).to_le_bytes()[..], content].concat()
    };
    let header = [text(""), text("")].concat();
    [
        &b"\x89MCAP0\r\n"[..],
        &record(1, &header),
        &record(6, &chunk),
    ]
    .concat()
}

/// A file of `count` messages of ten texts and a number.
fn messages(count: u32, encoding: &str) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    let options = mcap::WriteOptions::new().compression(Some(mcap::Compression::Lz4));
    let mut writer = options.create(&mut file).expect("begun");
    let channel = writer.add_channel(0, "t", encoding, &BTreeMap::new());
    let channel_id = channel.expect("a channel");
    let texts: Vec<_> = (0..10).map(|n| format!("\"text_{n}\":\"w\"")).collect();
    for sequence in 0..count {
        let header = mcap::records::MessageHeader {
            channel_id,
            sequence,
            log_time: u64::from(sequence) * 1000,
            publish_time: 0,
        };
        let message = format!("{{{},\"n\":1}}", texts.join(","));
        let written = writer.write_to_known_channel(&header, message.as_bytes());
        written.expect("written");
    }
    writer.finish().expect("finished");
    drop(writer);
    file.into_inner()
}

/// Goal: who gives a recording of a kind that is not read learns which it is, and a run's own is read.
#[test]
#[cfg(unix)]
fn recordings_are_read_or_named_by_their_encoding() {
    let place = Place::new();
    let run = "run atp/overspeed --inject eb_relay.slow -q --mcap run.mcap";
    place.ptu(run).exits(1);
    let compared = place.ptu("trace diff latest run.mcap");
    assert!(compared.out.contains("compared from"), "{}", compared.all());
    beside(&place, "x.mcap", &messages(10, "ros2msg"))
        .exits(2)
        .explains(&["ros2msg: only json is read"]);
}

/// Goal: what a file unpacks to is bounded, whatever it says. Method: long texts, a page that is longer than any, and a chunk
/// of zeros, each in a process with limits on memory and time.
#[test]
#[cfg(unix)]
fn a_small_file_that_unpacks_to_very_much_is_refused() {
    let place = Place::new();
    kept(&place, &trace(600));
    let megabyte = vec![0; 1 << 20];
    for (file, bytes, told) in [
        (
            "texts.parquet",
            texts(100, &megabyte, 1 << 20),
            "is no sample",
        ),
        (
            "page.parquet",
            texts(100, &megabyte, 1 << 30),
            "a page unpacks to",
        ),
        ("zeros.mcap", zeros(1 << 30), "it unpacks to more than"),
    ] {
        beside(&place, file, &bytes)
            .exits(2)
            .explains(&[file, told]);
    }
}

/// Goal: texts cost no search through all signals. Method: many texts beside a trace of very many signals.
#[test]
#[cfg(unix)]
fn texts_are_found_at_once_among_many_signals() {
    let place = Place::new();
    let mut many = trace(600);
    for n in 0..2_000 {
        many.channels.push(Channel {
            name: format!("signal_{n}"),
            unit: "km/h".into(),
            kind: ChannelKind::Bit,
        });
        many.columns.push(vec![0.0; 600]);
    }
    kept(&place, &many);
    let said = beside(&place, "texts.mcap", &messages(20_000, "json")).exits(2);
    said.explains(&["none of its signals"]);
}
