//! Imports MCAP files: our own exports, or any messages in JSON.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;
use std::io::Read;
use std::path::Path;

use fault_db::{Channel, open_regular_file};
use mcap::McapError;
use mcap::records::{Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use serde_json::Value;

use super::about::{NAME, TraceInfo};
use super::known::{Known, KnownSignals};
use super::run_mcap::{EVENTS, SIGNALS};
use super::series::{Import, Table, check_size, in_order, plain, wrong};
use super::times::Columns;
use ptu_runs::failure::{Failure, FileTrouble};

/// Longest record, or chunk of compressed messages, bytes: a longer one is refused instead of being held in memory.
const MAX_RECORD: usize = 32 << 20;
/// Greatest length of all records unpacked, bytes: several times what the permitted samples take as text.
const MAX_BYTES: usize = 512 << 20;
/// Bytes of a record beside its content.
const RECORD: usize = 64;
/// Longest message of signals, bytes; a longer one is refused.
const MAX_MESSAGE: usize = 1 << 20;
/// Longest name of a topic or signal, bytes; a longer one is refused.
const MAX_NAME: usize = 256;
/// Longest description that this program writes, bytes; a longer one is passed over.
const MAX_ABOUT: usize = 4 << 20;
/// Most encodings that are named in the error on a file without a message that can be read.
const MAX_ENCODINGS: usize = 8;
/// Fields within fields are looked at this deep.
const MAX_DEPTH: usize = 8;

/// Messages of one topic.
struct Topic {
    name: String,
    table: Table,
    /// Index of the column of a field, by the field's path.
    places: BTreeMap<String, usize>,
    /// Number of signal names known to be short enough.
    checked: usize,
}

fn check_name(file: &Path, name: &str) -> Result<(), Failure> {
    if name.len() <= MAX_NAME {
        return Ok(());
    }
    let begin: String = name.chars().take(20).collect();
    let what = format!("the name \"{begin}…\" is longer than {MAX_NAME} bytes");
    Err(wrong(file, &what))
}

/// Reads a file. Each number, bit, null or word of a signal in a message is a sample of the signal that its field
/// names; messages in another encoding than JSON are passed over.
pub(super) fn read(file: &Path, known: &[Channel], asked: &Columns) -> Result<Import, Failure> {
    let cannot = |error: std::io::Error| Failure::usage(FileTrouble::unread(file, error));
    let mut input = open_regular_file(file).map_err(cannot)?;
    let options = LinearReaderOptions::default()
        .with_record_length_limit(MAX_RECORD)
        .with_prevalidate_chunk_crcs(true);
    let mut reader = LinearReader::new_with_options(options);
    let mut reading = Reading {
        file,
        known,
        asked,
        names: KnownSignals::of(&[known], &asked.names),
        topics: BTreeMap::new(),
        others: BTreeSet::new(),
        about: None,
        messages: 0,
        signals: 0,
        samples: 0,
    };
    let (mut bytes, mut unpacked) = (0, 0);
    while let Some(event) = reader.next_event() {
        let damaged = |error: McapError| {
            let why = told(&error);
            wrong(
                file,
                &format!("damaged, or no MCAP file, before byte {bytes}: {why}"),
            )
        };
        match event.map_err(damaged)? {
            LinearReadEvent::ReadRequest(need) => {
                let read = input.read(reader.insert(need)).map_err(cannot)?;
                reader.notify_read(read);
                bytes += read;
            }
            LinearReadEvent::Record { opcode, data } => {
                unpacked += data.len() + RECORD;
                if unpacked > MAX_BYTES {
                    let what = format!("it unpacks to more than {MAX_BYTES} bytes");
                    return Err(wrong(file, &what));
                }
                if !texts_fit(opcode, data) {
                    return Err(damaged(McapError::UnexpectedEof));
                }
                if matches!(opcode, op::CHANNEL | op::MESSAGE | op::METADATA) {
                    reading.take(mcap::parse_record(opcode, data).map_err(damaged)?)?;
                }
            }
        }
    }
    reading.finish()
}

/// Whether each text of a record is as long as its length field says: the library allocates that length, up to 4 GB,
/// before it reads the text.
fn texts_fit(opcode: u8, data: &[u8]) -> bool {
    let (numbers, texts) = match opcode {
        op::CHANNEL => (4, 2),
        op::METADATA => (0, 1),
        _ => return true,
    };
    let fit = || {
        let mut rest = data.get(numbers..)?;
        for _ in 0..texts {
            rest = text(rest)?.1;
        }
        // A map follows the texts: the length of its bytes, as a text has, and texts.
        let mut map = text(rest)?.0;
        while !map.is_empty() {
            map = text(map)?.1;
        }
        Some(())
    };
    fit().is_some()
}

/// A text that follows its length in bytes, and the bytes after the text.
fn text(data: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = data.split_first_chunk()?;
    rest.split_at_checked(usize::try_from(u32::from_le_bytes(*length)).ok()?)
}

/// Message on an error, with its cause.
fn told(error: &McapError) -> String {
    match error {
        McapError::UnsupportedCompression(name) => {
            format!("it is compressed with {name}, which is not read here; lz4 and zstd are")
        }
        McapError::Parse(inner) => inner.to_string(),
        other => other.to_string(),
    }
}

struct Reading<'a> {
    file: &'a Path,
    known: &'a [Channel],
    asked: &'a Columns,
    names: KnownSignals,
    /// Topics by the number of the file's channel.
    topics: BTreeMap<u16, Topic>,
    /// Encodings of messages that are passed over.
    others: BTreeSet<String>,
    about: Option<TraceInfo>,
    messages: usize,
    signals: usize,
    samples: usize,
}

impl Reading<'_> {
    fn take(&mut self, record: Record<'_>) -> Result<(), Failure> {
        match record {
            Record::Channel(channel) if channel.message_encoding == "json" => {
                check_name(self.file, &channel.topic)?;
                self.topics.entry(channel.id).or_insert_with(|| Topic {
                    name: channel.topic.trim_start_matches('/').to_owned(),
                    table: Table::default(),
                    places: BTreeMap::new(),
                    checked: 0,
                });
            }
            Record::Channel(channel) => {
                check_name(self.file, &channel.message_encoding)?;
                if self.others.len() < MAX_ENCODINGS {
                    self.others.insert(channel.message_encoding);
                }
            }
            Record::Message { header, data } => {
                self.messages += 1;
                let Some(topic) = self.topics.get_mut(&header.channel_id) else {
                    return Ok(());
                };
                let (number, name) = (self.messages, &topic.name);
                let wrong = |what: &dyn Display| {
                    let what = format!("message {number}, topic \"{name}\": {what}");
                    wrong(self.file, &what)
                };
                if data.len() > MAX_MESSAGE {
                    return Err(wrong(&format!("it is longer than {MAX_MESSAGE} bytes")));
                }
                let message: Value =
                    serde_json::from_slice(&data).map_err(|error| wrong(&error))?;
                let at_us = i64::try_from(header.log_time / 1000).unwrap_or(i64::MAX);
                self.signals -= topic.table.columns.len();
                self.samples -= topic.table.samples();
                topic.take(at_us, &message, &self.names);
                self.signals += topic.table.columns.len();
                self.samples += topic.table.samples();
                check_size(self.file, self.signals, self.samples)?;
                topic.check_names(self.file)?;
            }
            Record::Metadata(metadata) if metadata.name == NAME && self.about.is_none() => {
                let about = metadata.metadata.get("about");
                let about = about.filter(|about| about.len() <= MAX_ABOUT);
                let about: Option<TraceInfo> =
                    about.and_then(|about| serde_json::from_str(about).ok());
                let own = about.as_ref().map_or(&[][..], |about| &about.channels);
                self.names = KnownSignals::of(&[own, self.known], &self.asked.names);
                self.about = about;
            }
            _ => {}
        }
        Ok(())
    }

    fn finish(self) -> Result<Import, Failure> {
        // In a recorded run, the events repeat what its rows hold as signals.
        let is_run = self.topics.values().any(|topic| topic.name == SIGNALS);
        let read = (self.topics.into_values()).filter(|topic| !is_run || topic.name != EVENTS);
        let mut tables: Vec<Table> = read.map(|topic| topic.table).collect();
        tables.retain(|table| !table.columns.is_empty());
        if tables.is_empty() {
            let mut what = format!(
                "{} messages, none of them JSON with numbers in it",
                self.messages
            );
            if !self.others.is_empty() {
                let others: Vec<_> = self.others.into_iter().collect();
                what = format!("{what}; {}: only json is read", others.join(", "));
            }
            return Err(wrong(self.file, &what));
        }
        let mut is_utc = true;
        let own: BTreeMap<&str, &Channel> = (self.about.iter())
            .flat_map(|about| &about.channels)
            .map(|channel| (channel.name.as_str(), channel))
            .collect();
        for table in &mut tables {
            in_order(table);
            if let Some(about) = &self.about {
                is_utc = false;
                let trigger_us = about.t0_us.saturating_sub(about.time_us(0));
                for time_us in &mut table.times_us {
                    *time_us = time_us.saturating_sub(trigger_us);
                }
                for channel in &mut table.channels {
                    if let Some(own) = own.get(channel.name.as_str()) {
                        *channel = (*own).clone();
                    }
                }
            }
        }
        Ok(Import {
            tables,
            is_utc,
            about: self.about,
        })
    }
}

impl Topic {
    fn take(&mut self, at_us: i64, message: &Value, known: &KnownSignals) {
        self.table.times_us.push(at_us);
        self.fields(&mut String::new(), message, 0, known);
        let rows = self.table.times_us.len();
        for column in &mut self.table.columns {
            column.resize(rows, f64::NAN);
        }
    }

    /// Refuses names that are too long; called after each message, which brought the names that are not checked yet.
    fn check_names(&mut self, file: &Path) -> Result<(), Failure> {
        while self.checked < self.table.channels.len() {
            check_name(file, &self.table.channels[self.checked].name)?;
            self.checked += 1;
        }
        Ok(())
    }

    fn fields(&mut self, path: &mut String, value: &Value, depth: usize, known: &KnownSignals) {
        let sample = match value {
            Value::Object(fields) if depth < MAX_DEPTH => {
                for (name, value) in fields {
                    let length = path.len();
                    if length > 0 {
                        path.push('.');
                    }
                    path.push_str(name);
                    self.fields(path, value, depth + 1, known);
                    path.truncate(length);
                }
                return;
            }
            Value::Number(number) => number.as_f64().unwrap_or(f64::NAN),
            Value::Bool(bit) => f64::from(*bit),
            Value::Null => f64::NAN,
            Value::String(word) => {
                let signal = signal(&self.name, path, known);
                match signal.and_then(|signal| signal.number(word)) {
                    Some(number) => number,
                    None => return,
                }
            }
            _ => return,
        };
        let before = self.table.times_us.len() - 1;
        let place = match self.places.get(path.as_str()) {
            Some(place) => *place,
            None => {
                let name = &self.name;
                let channel = match (signal(name, path, known), path.as_str()) {
                    (Some(signal), _) => signal.channel.clone(),
                    (None, "") => plain(name),
                    (None, path) => plain(&format!("{name}.{path}")),
                };
                self.table.channels.push(channel);
                self.table.columns.push(Vec::new());
                let place = self.table.columns.len() - 1;
                self.places.insert(path.clone(), place);
                place
            }
        };
        let column = &mut self.table.columns[place];
        column.resize(before, f64::NAN);
        column.push(sample);
    }
}

/// The signal of a field: the signal with the name of the field; or with the name of the topic, if the field is `value`
/// or `data` or the whole message; or with both names joined.
fn signal<'a>(topic: &str, path: &str, known: &'a KnownSignals) -> Option<&'a Known> {
    let is_value = matches!(path, "" | "value" | "data");
    let of_topic = || is_value.then(|| known.named(topic)).flatten();
    let of_both = || known.named(&format!("{topic}.{path}"));
    known.named(path).or_else(of_topic).or_else(of_both)
}
