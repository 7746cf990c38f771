//! Traces as MCAP: one message of JSON per row, under one topic, for Foxglove, PlotJuggler and the like.
//!
//! One field per signal, called as [`column_name`] says, null where a sample is not known; enumerations are words, bits
//! numbers. The schema has each signal's unit and words, the file's metadata [`TraceInfo`](super::TraceInfo) under its name.

use std::collections::BTreeMap;
use std::io::{self, Seek, Write};
use std::path::Path;

use fault_db::{Channel, ChannelKind};
use mcap::records::{MessageHeader, Metadata};
use mcap::{Compression, McapError, WriteOptions, Writer};
use serde_json::{Map, Value, json};

use super::about::NAME;
use super::column::{column_name, word};
use super::part::TracePart;
use ptu_runs::failure::Failure;
use ptu_runs::new_file::cannot_write;

/// The topic of all messages.
const TOPIC: &str = "trace";
/// Bytes of messages that are compressed together.
const CHUNK_BYTES: u64 = 1 << 20;

pub(super) fn put(
    out: &mut (impl Write + Seek),
    chosen: &TracePart<'_>,
    to: &Path,
) -> Result<(), Failure> {
    let failed = |error: McapError| cannot_write(to, &error);
    let about = &chosen.about;
    let mut file = options().create(out).map_err(failed)?;
    let metadata = Metadata {
        name: NAME.to_owned(),
        metadata: BTreeMap::from([("about".to_owned(), about.json())]),
    };
    file.write_metadata(&metadata).map_err(failed)?;
    let schema = schema(&about.channels).to_string();
    let mut topic = Topic::add(&mut file, TOPIC, &schema).map_err(failed)?;
    let keys = keys(&about.channels);
    let mut message = Vec::new();
    chosen.each_block(|first, columns| {
        for row in 0..columns.first().map_or(0, Vec::len) {
            message.clear();
            let samples = columns.iter().map(|column| column[row]);
            put_row(&mut message, &about.channels, &keys, samples)
                .map_err(|error| failed(error.into()))?;
            let later_us = ((first + row) as i64).saturating_mul(about.period_us);
            let at_us = about.t0_us.saturating_add(later_us);
            topic.put(&mut file, at_us, &message).map_err(failed)?;
        }
        Ok(())
    })?;
    file.finish().map_err(failed)?;
    Ok(())
}

/// A topic of JSON messages in a file, and the number of its messages so far.
pub(super) struct Topic {
    channel: u16,
    count: u32,
}

impl Topic {
    /// Adds a topic without messages, whose schema is called `ptu.` and its name.
    pub fn add<W: Write + Seek>(
        file: &mut Writer<W>,
        name: &str,
        schema: &str,
    ) -> Result<Self, McapError> {
        let schema = file.add_schema(&format!("ptu.{name}"), "jsonschema", schema.as_bytes())?;
        let channel = file.add_channel(schema, name, "json", &BTreeMap::new())?;
        Ok(Self { channel, count: 0 })
    }

    /// Adds a message of this time, µs since 1970; an earlier time counts as 1970.
    pub fn put<W: Write + Seek>(
        &mut self,
        file: &mut Writer<W>,
        at_us: i64,
        message: &[u8],
    ) -> Result<(), McapError> {
        let at_ns = u64::try_from(at_us).unwrap_or(0).saturating_mul(1000);
        let header = MessageHeader {
            channel_id: self.channel,
            sequence: self.count,
            log_time: at_ns,
            publish_time: at_ns,
        };
        self.count = self.count.wrapping_add(1);
        file.write_to_known_channel(&header, message)
    }
}

/// Packing of every file that this program writes.
pub(super) fn options() -> WriteOptions {
    WriteOptions::new()
        .library("ptu")
        .compression(Some(Compression::Zstd))
        .compression_threads(0)
        .chunk_size(Some(CHUNK_BYTES))
}

/// Each signal's name as JSON has it before a value; the same in every row.
pub(super) fn keys(channels: &[Channel]) -> Vec<String> {
    let name = |channel: &Channel| Value::from(column_name(channel)).to_string();
    channels.iter().map(|c| name(c) + ":").collect()
}

/// A message with the samples of one row, in the order of their channels.
pub(super) fn put_row(
    message: &mut Vec<u8>,
    channels: &[Channel],
    keys: &[String],
    samples: impl Iterator<Item = f64>,
) -> io::Result<()> {
    message.push(b'{');
    let fields = keys.iter().zip(channels).zip(samples);
    for (place, ((key, channel), sample)) in fields.enumerate() {
        let before = if place == 0 { "" } else { "," };
        let value = word(channel, sample).map_or_else(|| number(sample), Value::from);
        write!(message, "{before}{key}{value}")?;
    }
    message.push(b'}');
    Ok(())
}

/// A sample as JSON: a whole number without a point, an unknown or infinite sample as null.
fn number(sample: f64) -> Value {
    if sample.fract() == 0.0 && sample.abs() < 1e15 {
        Value::from(sample as i64)
    } else {
        serde_json::Number::from_f64(sample).map_or(Value::Null, Value::Number)
    }
}

/// Form of a message, as JSON Schema.
pub(super) fn schema(channels: &[Channel]) -> Value {
    let properties: Map<String, Value> = channels
        .iter()
        .map(|channel| (column_name(channel), property(channel)))
        .collect();
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": NAME,
        "type": "object",
        "properties": properties,
    })
}

fn property(channel: &Channel) -> Value {
    match &channel.kind {
        ChannelKind::Number { .. } => {
            json!({"type": ["number", "null"], "unit": channel.unit, "description": channel.unit})
        }
        ChannelKind::Bit => json!({"type": ["integer", "null"], "minimum": 0, "maximum": 1}),
        ChannelKind::Enum { labels } => {
            let words: Vec<_> = labels.values().collect();
            // A value without a word is a number.
            json!({"anyOf": [{"enum": words}, {"type": ["number", "null"]}]})
        }
    }
}
