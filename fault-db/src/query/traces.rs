//! Lists traces, and stores them.

use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::backend::{Backend, SqlResult, Value, from_row, values};
use crate::error::StoreError;
use crate::id::Id;
use crate::seal;
use crate::store::Store;
use crate::trace::{Channel, ENCODING, TraceData, TraceError};

pub(super) const PARTIAL: i64 = 1;
pub(super) const GAPS: i64 = 2;

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
    /// Number of rows.
    pub rows: u32,
    /// Size in the file, bytes.
    pub size_bytes: u64,
    /// Number of fault occurrences that the trace shows.
    pub occurrences: u32,
}

impl Store {
    /// The traces of a run, in order.
    pub fn traces(&self, run: Id) -> Result<Vec<TraceSummary>, StoreError> {
        self.listed_traces("WHERE r.id = ?1 ORDER BY t.seq", &values![run])
    }

    /// The traces that were recorded last, newest first.
    pub fn newest_traces(&self, limit: u32) -> Result<Vec<TraceSummary>, StoreError> {
        self.listed_traces("ORDER BY t.seq DESC LIMIT ?1", &values![limit])
    }

    fn listed_traces(
        &self,
        which: &str,
        values: &[Value],
    ) -> Result<Vec<TraceSummary>, StoreError> {
        self.select(
            "listing traces",
            &format!(
                "SELECT t.id, r.id, t.t0_us, t.period_us, t.row_count, length(t.data),
                        (SELECT count(*) FROM fault_occurrence o WHERE o.trace = t.seq)
                     FROM trace t JOIN run r ON r.seq = t.run {which}"
            ),
            values,
            |row| {
                Ok(from_row!(row => TraceSummary:
                    id, run_id, t0_us, period_us, rows, size_bytes, occurrences
                ))
            },
        )
    }

    /// Compresses and commits a trace of a run, and links it to occurrences; returns the trace's digest.
    pub(crate) fn insert_trace(
        &self,
        id: Id,
        run: i64,
        occurrences: &[Id],
        trace: &TraceData,
    ) -> Result<[u8; 32], StoreError> {
        const DOING: &str = "storing a trace";
        let data = self.codec().encode(trace);
        let data = data.map_err(|source| StoreError::Trace { trace: id, source })?;
        let gaps = trace.gaps || trace.has_gaps();
        let flags = i64::from(trace.partial) * PARTIAL + i64::from(gaps) * GAPS;
        let known = self.known_channel_set(&trace.channels);
        let json = serde_json::to_string(&trace.channels).map_err(|error| {
            let source = TraceError::ChannelSet {
                detail: error.to_string(),
            };
            StoreError::Trace { trace: id, source }
        })?;
        let (hash, hash_of_list) = (sha256(&data), sha256(json.as_bytes()));
        let mut fields = values![
            id,
            trace.t0_bench_us,
            trace.t0_us,
            trace.period_us,
            trace.rows() as i64,
            trace.trigger_row,
            flags,
            ENCODING,
            &hash[..],
            &hash_of_list[..],
        ]
        .to_vec();
        let digest = seal::trace::of(&fields, occurrences);
        let channel_set = self.write(DOING, |_| {
            // A channel list is never changed or deleted, so a known one need not be looked up.
            let channel_set = match known {
                Some(seq) => seq,
                None => self.ask(DOING, |file| channel_set_seq(file, &json))?,
            };
            fields[9] = channel_set.into();
            fields.extend(values![run, &data[..]]);
            let seq = self.ask(DOING, |file| {
                file.insert(
                    "INSERT INTO trace(id, t0_bench_us, t0_us, period_us, row_count, trigger_row,
                        flags, encoding, sha256, channel_set, run, data)
                     VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12) RETURNING seq",
                    &fields,
                )
            })?;
            for occurrence in occurrences {
                self.link_trace(seq, *occurrence)?;
            }
            Ok(channel_set)
        })?;
        if known.is_none() {
            let channels = trace.channels.as_slice().into();
            self.channel_sets.borrow_mut().insert(channel_set, channels);
        }
        Ok(digest)
    }

    /// The row number of a channel list that was read or written before.
    fn known_channel_set(&self, channels: &[Channel]) -> Option<i64> {
        let known = self.channel_sets.borrow();
        let found = known.iter().find(|(_, known)| known[..] == *channels);
        found.map(|(seq, _)| *seq)
    }

    fn link_trace(&self, trace: i64, occurrence: Id) -> Result<(), StoreError> {
        const SQL: &str = "UPDATE fault_occurrence SET trace = ?1 WHERE id = ?2";
        let values = values![trace, occurrence];
        let linked = self.ask("storing a trace", |file| file.execute(SQL, &values))?;
        if linked == 0 {
            let asked = occurrence.to_string();
            return Err(StoreError::NotFound {
                what: "fault occurrence",
                asked,
            });
        }
        Ok(())
    }
}

/// The row number of a channel list; equal lists are stored once.
fn channel_set_seq(file: &Backend, json: &str) -> SqlResult<i64> {
    let hash = sha256(json.as_bytes());
    let known = "SELECT seq FROM channel_set WHERE sha256 = ?1";
    match file.first(known, &values![&hash[..]], |row| row.get(0))? {
        Some(seq) => Ok(seq),
        None => file.insert(
            "INSERT INTO channel_set(sha256, json) VALUES (?1, ?2) RETURNING seq",
            &values![&hash[..], json],
        ),
    }
}

pub(super) fn sha256(bytes: &[u8]) -> [u8; 32] {
    Sha256::digest(bytes).into()
}
