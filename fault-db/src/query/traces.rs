//! Traces: packed in, unpacked out, whole or some channels.

use std::sync::Arc;

use rusqlite::{OptionalExtension, Row, params};
use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::error::StoreError;
use crate::id::Id;
use crate::store::Store;
use crate::trace::{Channel, ENCODING, TraceData, TraceError};

const PARTIAL: i64 = 1;
const GAPS: i64 = 2;

/// A trace in a list.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TraceSummary {
    /// The trace.
    pub id: Id,
    /// The run it was recorded in.
    pub run_id: Id,
    /// UTC of row 0.
    pub t0_us: i64,
    /// Time from row to row.
    pub period_us: i64,
    /// Rows.
    pub rows: u32,
    /// Size in the file.
    pub size_bytes: u64,
    /// Fault occurrences it shows.
    pub occurrences: u32,
}

/// A trace's row but for its samples.
struct Head {
    t0_bench_us: i64,
    t0_us: i64,
    period_us: i64,
    rows: usize,
    trigger_row: Option<u32>,
    flags: i64,
    channel_set: i64,
    encoding: i64,
}

impl Store {
    /// A trace with all its channels.
    pub fn trace(&self, id: Id) -> Result<TraceData, StoreError> {
        self.read_trace(id, None)
    }

    /// A trace with the named channels only, in that order; the others are not unpacked.
    pub fn trace_channels(&self, id: Id, names: &[&str]) -> Result<TraceData, StoreError> {
        self.read_trace(id, Some(names))
    }

    /// The traces of a run, in order.
    pub fn traces(&self, run: Id) -> Result<Vec<TraceSummary>, StoreError> {
        let list = || -> rusqlite::Result<Vec<_>> {
            self.conn
                .prepare_cached(
                    "SELECT t.id, r.id, t.t0_us, t.period_us, t.row_count, length(t.data),
                        (SELECT count(*) FROM fault_occurrence o WHERE o.trace = t.seq)
                     FROM trace t JOIN run r ON r.seq = t.run WHERE r.id = ?1 ORDER BY t.seq",
                )?
                .query_map([run], |row| {
                    Ok(TraceSummary {
                        id: row.get(0)?,
                        run_id: row.get(1)?,
                        t0_us: row.get(2)?,
                        period_us: row.get(3)?,
                        rows: row.get(4)?,
                        size_bytes: row.get(5)?,
                        occurrences: row.get(6)?,
                    })
                })?
                .collect()
        };
        list().map_err(|error| self.failed("listing traces", error))
    }

    /// Packs and commits a trace of a run, and hangs it on the occurrences.
    pub(crate) fn insert_trace(
        &self,
        run: i64,
        occurrences: &[Id],
        trace: &TraceData,
    ) -> Result<Id, StoreError> {
        const DOING: &str = "storing a trace";
        let id = self.mint()?;
        let data = self.codec().encode(trace);
        let data = data.map_err(|source| StoreError::Trace { trace: id, source })?;
        let gaps = trace.gaps || trace.columns.iter().flatten().any(|sample| sample.is_nan());
        let flags = i64::from(trace.partial) * PARTIAL + i64::from(gaps) * GAPS;
        let json = serde_json::to_string(&trace.channels).map_err(|error| {
            let source = TraceError::ChannelSet {
                detail: error.to_string(),
            };
            StoreError::Trace { trace: id, source }
        })?;
        self.write(DOING, |conn| {
            let failed = |error| self.failed(DOING, error);
            let channel_set = self.channel_set_seq(&json).map_err(failed)?;
            let seq = conn
                .prepare_cached(
                    "INSERT INTO trace(id, run, t0_bench_us, t0_us, period_us, row_count,
                        trigger_row, flags, channel_set, encoding, sha256, data)
                     VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12)",
                )
                .and_then(|mut insert| {
                    insert.insert(params![
                        id,
                        run,
                        trace.t0_bench_us,
                        trace.t0_us,
                        trace.period_us,
                        trace.rows(),
                        trace.trigger_row,
                        flags,
                        channel_set,
                        ENCODING,
                        sha256(&data),
                        data
                    ])
                })
                .map_err(failed)?;
            for occurrence in occurrences {
                self.hang_trace(seq, *occurrence)?;
            }
            Ok(id)
        })
    }

    fn hang_trace(&self, trace: i64, occurrence: Id) -> Result<(), StoreError> {
        const SQL: &str = "UPDATE fault_occurrence SET trace = ?1 WHERE id = ?2";
        let hung = self
            .conn
            .prepare_cached(SQL)
            .and_then(|mut update| update.execute(params![trace, occurrence]))
            .map_err(|error| self.failed("storing a trace", error))?;
        if hung == 0 {
            let asked = occurrence.to_string();
            return Err(StoreError::NotFound {
                what: "fault occurrence",
                asked,
            });
        }
        Ok(())
    }

    /// The row of a channel list; the same list is stored once however many traces have it.
    fn channel_set_seq(&self, json: &str) -> rusqlite::Result<i64> {
        let hash = sha256(json.as_bytes());
        let known = self
            .conn
            .prepare_cached("SELECT seq FROM channel_set WHERE sha256 = ?1")?
            .query_row([&hash[..]], |row| row.get(0))
            .optional()?;
        match known {
            Some(seq) => Ok(seq),
            None => self
                .conn
                .prepare_cached("INSERT INTO channel_set(sha256, json) VALUES (?1, ?2)")?
                .insert(params![hash, json]),
        }
    }

    fn read_trace(&self, id: Id, names: Option<&[&str]>) -> Result<TraceData, StoreError> {
        const SQL: &str = "SELECT t0_bench_us, t0_us, period_us, row_count, trigger_row, flags,
            channel_set, encoding, sha256, data FROM trace WHERE id = ?1";
        let select = self.conn.prepare_cached(SQL);
        let mut select = select.map_err(|error| self.failed("reading a trace", error))?;
        let mut rows = select
            .query([id])
            .map_err(|error| self.failed("reading a trace", error))?;
        let row = rows
            .next()
            .map_err(|error| self.failed("reading a trace", error))?;
        let Some(row) = row else {
            return Err(StoreError::NotFound {
                what: "trace",
                asked: id.to_string(),
            });
        };
        let head = head(row).map_err(|error| self.failed("reading a trace", error))?;
        let all = self.channel_set(id, head.channel_set)?;
        let samples = || {
            let wanted = places(&all, names)?;
            let blob = checked_blob(row, &head)?;
            let columns = self.codec().decode(blob, &all, head.rows, &wanted)?;
            Ok((
                wanted.iter().map(|place| all[*place].clone()).collect(),
                columns,
            ))
        };
        let (channels, columns) =
            samples().map_err(|source| StoreError::Trace { trace: id, source })?;
        Ok(TraceData {
            t0_bench_us: head.t0_bench_us,
            t0_us: head.t0_us,
            period_us: head.period_us,
            trigger_row: head.trigger_row,
            partial: head.flags & PARTIAL != 0,
            gaps: head.flags & GAPS != 0,
            channels,
            columns,
        })
    }

    /// A channel list, parsed once per open file.
    fn channel_set(&self, trace: Id, seq: i64) -> Result<Arc<[Channel]>, StoreError> {
        if let Some(known) = self.channel_sets.borrow().get(&seq) {
            return Ok(Arc::clone(known));
        }
        const SQL: &str = "SELECT sha256, json FROM channel_set WHERE seq = ?1";
        let (hash, json) = self
            .conn
            .prepare_cached(SQL)
            .and_then(|mut select| {
                let both = |row: &Row<'_>| Ok((row.get::<_, Vec<u8>>(0)?, row.get(1)?));
                select.query_row::<(_, String), _, _>([seq], both)
            })
            .map_err(|error| self.failed("reading a channel list", error))?;
        let failed = |detail| {
            let source = TraceError::ChannelSet { detail };
            StoreError::Trace { trace, source }
        };
        if hash != sha256(json.as_bytes()) {
            return Err(failed("it does not match its checksum".to_owned()));
        }
        let channels: Vec<Channel> =
            serde_json::from_str(&json).map_err(|error| failed(error.to_string()))?;
        let channels: Arc<[Channel]> = channels.into();
        self.channel_sets
            .borrow_mut()
            .insert(seq, Arc::clone(&channels));
        Ok(channels)
    }
}

fn sha256(bytes: &[u8]) -> [u8; 32] {
    Sha256::digest(bytes).into()
}

fn head(row: &Row<'_>) -> rusqlite::Result<Head> {
    Ok(Head {
        t0_bench_us: row.get(0)?,
        t0_us: row.get(1)?,
        period_us: row.get(2)?,
        rows: row.get(3)?,
        trigger_row: row.get(4)?,
        flags: row.get(5)?,
        channel_set: row.get(6)?,
        encoding: row.get(7)?,
    })
}

/// The packed samples in SQLite's own memory, once they are known to be what was written.
fn checked_blob<'a>(row: &'a Row<'_>, head: &Head) -> Result<&'a [u8], TraceError> {
    if head.encoding != ENCODING {
        return Err(TraceError::Encoding {
            found: head.encoding,
        });
    }
    let bytes = |column| {
        row.get_ref(column)
            .ok()
            .and_then(|value| value.as_blob().ok())
    };
    match (bytes(8), bytes(9)) {
        (Some(hash), Some(data)) if hash == sha256(data) => Ok(data),
        _ => Err(TraceError::Checksum),
    }
}

fn places(all: &[Channel], names: Option<&[&str]>) -> Result<Vec<usize>, TraceError> {
    let Some(names) = names else {
        return Ok((0..all.len()).collect());
    };
    let place = |name: &&str| {
        all.iter()
            .position(|channel| channel.name == *name)
            .ok_or_else(|| TraceError::UnknownChannel {
                channel: (*name).to_owned(),
                known: all.iter().map(|channel| channel.name.clone()).collect(),
            })
    };
    names.iter().map(place).collect()
}
