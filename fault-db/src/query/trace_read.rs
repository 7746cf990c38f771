//! Reads traces: whole, selected channels, or selected rows.

use std::ops::Range;
use std::sync::Arc;

use rusqlite::MAIN_DB;
use rusqlite::blob::Blob;

use super::traces::{GAPS, PARTIAL, sha256};
use crate::backend::{Backend, Row, SqlResult, from_row, values};
use crate::error::StoreError;
use crate::id::Id;
use crate::store::Store;
use crate::trace::{Channel, Layout, Shape, TraceData, TraceError, check_size};

const DOING: &str = "reading a trace";

/// Blobs up to this size, bytes, are read whole, which is faster than reading parts of them.
const FETCHED_WHOLE: usize = 32 << 10;
/// Bytes read of a blob to get its directory; a longer directory takes a second read.
const HEAD_GUESS: usize = 4096;

/// The description of a trace, without its samples.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceHead {
    /// The trace.
    pub id: Id,
    /// The run it was recorded in.
    pub run_id: Id,
    /// Serial number of the unit.
    pub unit_serial: String,
    /// Bench time of row 0.
    pub t0_bench_us: i64,
    /// UTC of row 0.
    pub t0_us: i64,
    /// Time from row to row.
    pub period_us: i64,
    /// Rows.
    pub rows: usize,
    /// The row at which the trace was triggered.
    pub trigger_row: Option<u32>,
    /// The trace ends earlier than planned: the link dropped or the program was closed.
    pub partial: bool,
    /// Some samples are missing.
    pub gaps: bool,
    /// All channels of the trace.
    pub channels: Vec<Channel>,
}

/// A row of the table, without its samples.
struct TraceRow {
    seq: i64,
    t0_bench_us: i64,
    t0_us: i64,
    period_us: i64,
    rows: usize,
    trigger_row: Option<u32>,
    flags: i64,
    channel_set: i64,
    encoding: i64,
    bytes: usize,
}

impl Store {
    /// A trace with all its channels.
    pub fn trace(&self, id: Id) -> Result<TraceData, StoreError> {
        self.read_trace(id, None, None)
    }

    /// A trace with the named channels only, in that order; the others are not decompressed.
    pub fn trace_channels(&self, id: Id, names: &[&str]) -> Result<TraceData, StoreError> {
        self.read_trace(id, Some(names), None)
    }

    /// Some rows of the named channels, in the order of the names; of all channels if none is named. Rows that the
    /// trace does not have are left out. Other channels, and distant rows of a long trace, are neither read nor
    /// decompressed.
    ///
    /// Times and the trigger's row count from the first row returned; there is no trigger if its row is not returned.
    pub fn trace_window(
        &self,
        id: Id,
        names: &[&str],
        rows: Range<usize>,
    ) -> Result<TraceData, StoreError> {
        self.read_trace(id, (!names.is_empty()).then_some(names), Some(rows))
    }

    /// The description of a trace, without reading its samples.
    pub fn trace_head(&self, id: Id) -> Result<TraceHead, StoreError> {
        let row = self.row_of(id)?;
        let origin = self.first(
            DOING,
            "SELECT r.id, u.serial FROM trace t JOIN run r ON r.seq = t.run
             JOIN unit u ON u.seq = r.unit WHERE t.seq = ?1",
            &values![row.seq],
            |row| Ok((row.get(0)?, row.get(1)?)),
        )?;
        let (run_id, unit_serial) = origin.ok_or_else(|| StoreError::not_found("trace", id))?;
        Ok(TraceHead {
            id,
            run_id,
            unit_serial,
            t0_bench_us: row.t0_bench_us,
            t0_us: row.t0_us,
            period_us: row.period_us,
            rows: row.rows,
            trigger_row: row.trigger_row,
            partial: row.flags & PARTIAL != 0,
            gaps: row.flags & GAPS != 0,
            channels: self.channel_set(id, row.channel_set)?.to_vec(),
        })
    }

    fn row_of(&self, id: Id) -> Result<TraceRow, StoreError> {
        const SQL: &str =
            "SELECT seq, t0_bench_us, t0_us, period_us, row_count, trigger_row, flags,
            channel_set, encoding, length(data) FROM trace WHERE id = ?1";
        let row = self.first(DOING, SQL, &values![id], read_row)?;
        row.ok_or_else(|| StoreError::not_found("trace", id))
    }

    fn read_trace(
        &self,
        id: Id,
        names: Option<&[&str]>,
        rows: Option<Range<usize>>,
    ) -> Result<TraceData, StoreError> {
        // A server's connection answers one query at a time, so the samples are read last.
        let row = self.row_of(id)?;
        let all = self.channel_set(id, row.channel_set)?;
        let failed = |source| StoreError::Trace { trace: id, source };
        let wanted = places(&all, names).map_err(failed)?;
        let shape = Shape {
            encoding: row.encoding,
            rows: row.rows,
            channels: &all,
        };
        let is_part = names.is_some() || rows.is_some();
        let rows = rows.map_or(0..row.rows, |rows| {
            rows.start.min(row.rows)..rows.end.min(row.rows)
        });
        let columns = if is_part && row.bytes > FETCHED_WHOLE {
            self.parts(id, &row, &shape, &wanted, &rows)?
        } else {
            self.fetched(id, row.seq, &shape, &wanted, &rows, is_part)?
        };
        let trigger_row = row
            .trigger_row
            .filter(|trigger| rows.contains(&(*trigger as usize)))
            .map(|trigger| trigger - rows.start as u32);
        let later_us = (rows.start as i64).saturating_mul(row.period_us);
        Ok(TraceData {
            t0_bench_us: row.t0_bench_us.saturating_add(later_us),
            t0_us: row.t0_us.saturating_add(later_us),
            period_us: row.period_us,
            trigger_row,
            partial: row.flags & PARTIAL != 0,
            gaps: row.flags & GAPS != 0,
            channels: wanted.iter().map(|place| all[*place].clone()).collect(),
            columns,
        })
    }

    /// Columns of a blob that is read whole, directly from SQLite's memory.
    fn fetched(
        &self,
        id: Id,
        seq: i64,
        shape: &Shape<'_>,
        wanted: &[usize],
        rows: &Range<usize>,
        is_part: bool,
    ) -> Result<Vec<Vec<f64>>, StoreError> {
        const SQL: &str = "SELECT sha256, data FROM trace WHERE seq = ?1";
        let read = self.first(DOING, SQL, &values![seq], |row| {
            let (Ok(hash), Ok(data)) = (row.get::<&[u8]>(0), row.get::<&[u8]>(1)) else {
                return Ok(Err(TraceError::Checksum));
            };
            // If only a part is wanted, the checksums of its pieces suffice.
            let whole = !is_part;
            let columns = self.codec().decode(data, shape, wanted, rows.clone());
            // Damage with a known place is reported before damage without.
            Ok(match columns {
                Ok(_) if whole && hash != sha256(data) => Err(TraceError::Checksum),
                columns => columns,
            })
        })?;
        // Another program may prune between two queries.
        let read = read.ok_or_else(|| StoreError::not_found("trace", id))?;
        read.map_err(|source| StoreError::Trace { trace: id, source })
    }

    /// Columns of a blob of which only the directory and the parts needed are read.
    fn parts(
        &self,
        id: Id,
        row: &TraceRow,
        shape: &Shape<'_>,
        wanted: &[usize],
        rows: &Range<usize>,
    ) -> Result<Vec<Vec<f64>>, StoreError> {
        let failed = |source| StoreError::Trace { trace: id, source };
        check_size(row.rows, 1)
            .and_then(|()| check_size(rows.len(), wanted.len()))
            .map_err(failed)?;
        let reader = self.reader(row.seq)?;
        let mut head = self.bytes(id, &reader, 0..HEAD_GUESS.min(row.bytes))?;
        let length = Layout::head_length(&head, row.bytes, shape).map_err(failed)?;
        if length > head.len() {
            head = self.bytes(id, &reader, 0..length)?;
        }
        let layout = Layout::read(&head[..length], row.bytes, shape).map_err(failed)?;
        let column = |place: &usize| {
            let bytes = self.bytes(id, &reader, layout.span(*place, rows))?;
            let column = self.codec().part(&layout, shape, *place, rows, &bytes);
            column.map_err(failed)
        };
        wanted.iter().map(column).collect()
    }

    fn reader(&self, seq: i64) -> Result<Reader<'_>, StoreError> {
        match &self.backend {
            Backend::File(conn) => conn
                .blob_open(MAIN_DB, "trace", "data", seq, true)
                .map(Reader::File)
                .map_err(|error| self.failed(DOING, error)),
            Backend::Server(_) => Ok(Reader::Server(seq)),
        }
    }

    fn bytes(
        &self,
        id: Id,
        reader: &Reader<'_>,
        range: Range<usize>,
    ) -> Result<Vec<u8>, StoreError> {
        match reader {
            Reader::File(blob) => {
                let mut bytes = vec![0; range.len()];
                blob.read_at_exact(&mut bytes, range.start)
                    .map_err(|error| self.failed(DOING, error))?;
                Ok(bytes)
            }
            Reader::Server(seq) => {
                // PostgreSQL counts bytes from 1, as a 32-bit integer.
                let found = self.first(
                    DOING,
                    "SELECT substr(data, CAST(?2 AS INTEGER), CAST(?3 AS INTEGER))
                     FROM trace WHERE seq = ?1",
                    &values![*seq, range.start as i64 + 1, range.len() as i64],
                    |row| row.get(0),
                )?;
                found.ok_or_else(|| StoreError::not_found("trace", id))
            }
        }
    }

    /// A channel list, parsed once per store.
    fn channel_set(&self, trace: Id, seq: i64) -> Result<Arc<[Channel]>, StoreError> {
        if let Some(known) = self.channel_sets.borrow().get(&seq) {
            return Ok(Arc::clone(known));
        }
        let found = self.first(
            "reading a channel list",
            "SELECT sha256, json FROM channel_set WHERE seq = ?1",
            &values![seq],
            |row| Ok((row.get::<Vec<u8>>(0)?, row.get::<String>(1)?)),
        )?;
        let failed = |detail| {
            let source = TraceError::ChannelSet { detail };
            StoreError::Trace { trace, source }
        };
        let (hash, json) = found.ok_or_else(|| failed("it is missing".to_owned()))?;
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

/// Reads a range of bytes of a blob.
enum Reader<'s> {
    File(Blob<'s>),
    Server(i64),
}

fn read_row(row: Row<'_>) -> SqlResult<TraceRow> {
    Ok(from_row!(row => TraceRow:
        seq, t0_bench_us, t0_us, period_us, rows, trigger_row, flags, channel_set, encoding,
        bytes
    ))
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
