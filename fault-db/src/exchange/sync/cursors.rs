//! Replication cursors: how far a file and a server have exchanged their entries. Both sides store them, the server in
//! the transaction that inserts the rows, the file right after. The smaller value of both counts: so after a crash, or
//! with a file or server restored from a backup, entries are sent again, which changes nothing if they are known.

use super::outcome::SyncOptions;
use crate::backend::{Backend, SqlResult, from_row, values};
use crate::id::Id;

/// Positions in a file's outbox, and in a server's events.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Cursors {
    pub sent: i64,
    pub sent_traces: i64,
    pub received: i64,
}

/// The server's record of a file.
pub(super) struct FileRecord {
    /// The server's row number of the file.
    pub seq: i64,
    pub cursors: Cursors,
    pub clock_offset_us: i64,
}

/// Registers the file with the server, and measures the clock offset.
pub(super) fn register_laptop(
    backend: &Backend,
    file_id: Id,
    options: &SyncOptions<'_>,
) -> SqlResult<FileRecord> {
    let clock = "SELECT CAST(extract(epoch FROM clock_timestamp()) * 1000000 AS bigint)";
    let asked_us = (options.now_us)();
    let theirs_us = backend.first(clock, &[], |row| row.get::<i64>(0))?;
    let answered_us = (options.now_us)();
    let theirs_us = theirs_us.unwrap_or(answered_us);
    let clock_offset_us = asked_us + (answered_us - asked_us) / 2 - theirs_us;
    let found = backend.first(
        "SELECT number, through, traces_through, told FROM meet_laptop(?1, ?2, ?3)",
        &values![file_id, options.laptop, clock_offset_us],
        |row| {
            let cursors = from_row!(row => Cursors: _, sent, sent_traces, received);
            Ok((row.get(0)?, cursors))
        },
    )?;
    let (seq, cursors) = found.unwrap_or_default();
    Ok(FileRecord {
        seq,
        cursors,
        clock_offset_us,
    })
}

/// The file's cursors for this server; zero if file and server never met.
pub(super) fn load(file: &Backend, server_id: Id) -> SqlResult<Cursors> {
    let found = file.first(
        "SELECT sent, sent_traces, received FROM sync_server WHERE id = ?1",
        &values![server_id],
        |row| Ok(from_row!(row => Cursors: sent, sent_traces, received)),
    )?;
    Ok(found.unwrap_or_default())
}

/// Whether the file has ever been synced with any server.
pub(super) fn has_met_a_server(file: &Backend) -> SqlResult<bool> {
    file.has("SELECT 1 FROM sync_server LIMIT 1", &[])
}

/// Stores the cursors in the file.
pub(super) fn save(
    file: &Backend,
    server_id: Id,
    address: &str,
    cursors: Cursors,
    now_us: i64,
) -> SqlResult<()> {
    file.execute(
        "INSERT INTO sync_server(id, address, sent, sent_traces, received, last_at_us)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6)
         ON CONFLICT (id) DO UPDATE SET address = excluded.address, sent = excluded.sent,
            sent_traces = excluded.sent_traces, received = excluded.received,
            last_at_us = excluded.last_at_us",
        &values![
            server_id,
            address,
            cursors.sent,
            cursors.sent_traces,
            cursors.received,
            now_us
        ],
    )?;
    Ok(())
}

/// Stores the cursors on the server, in the transaction that inserts the rows. `received` is stored only when
/// everything was received: after an interrupted sync all of it is received again.
pub(super) fn save_on_server(backend: &Backend, laptop: i64, cursors: Cursors) -> SqlResult<()> {
    backend.execute(
        "SELECT note_sent(?1, ?2, ?3)",
        &values![laptop, cursors.sent, cursors.sent_traces],
    )?;
    Ok(())
}

impl Cursors {
    /// The cursor of traces sent, or of all other entries sent.
    pub fn of(&mut self, traces: bool) -> &mut i64 {
        match traces {
            true => &mut self.sent_traces,
            false => &mut self.sent,
        }
    }

    /// The smaller of both sides' cursors, each.
    pub fn minimum(self, other: Self) -> Self {
        Self {
            sent: self.sent.min(other.sent),
            sent_traces: self.sent_traces.min(other.sent_traces),
            received: self.received.min(other.received),
        }
    }
}
