//! Replication between a file and a server: sends what the file recorded, and receives the events that
//! other laptops and users added to its faults. The file is complete at all times and works without a
//! server.
//!
//! Each entry of the file's outbox is sent once, in batches of one transaction each, and rows are only inserted on the
//! server. So the next sync continues an interrupted one, and a sync without new entries changes nothing.

mod batch;
mod cursors;
mod last;
mod outbox;
mod outcome;
mod receive;
mod seal_chains;

use crate::backend::{Backend, Server, SqlError, values};
use crate::error::StoreError;
use crate::exchange::tables::TableId;
use crate::exchange::to_server::ServerApplier;
use crate::id::Id;
use crate::seal::known_heads;
use crate::server::schema::server_id;
use crate::store::Store;
use batch::Batch;
use cursors::{Cursors, FileRecord};
pub use last::LastSync;
pub use outcome::{Difference, SyncOptions, SyncOutcome, SyncPhase, SyncProgress};
use seal_chains::Chain;
pub(crate) use seal_chains::chain_error;

const SENDING: &str = "sending";
const RECEIVING: &str = "receiving";

impl Store {
    /// Replicates in both directions: sends what the server does not have, and receives the events that
    /// others added to this file's faults.
    ///
    /// # Errors
    /// The server is away, or the file cannot be written. What was sent stays sent.
    pub fn sync(
        &self,
        server: &Store,
        options: &mut SyncOptions<'_>,
    ) -> Result<SyncOutcome, StoreError> {
        const DOING: &str = "beginning a sync";
        let mut file_id = self.file_id()?;
        let wire = server.server()?;
        let id = server.ask(DOING, server_id)?;
        let id = id.ok_or_else(|| StoreError::ServerForeign(server.path().to_path_buf()))?;
        let known = self.change(DOING, |_| {
            self.ask(DOING, |file| {
                outbox::enqueue_interrupted_runs(self)?;
                outbox::enqueue_rows_before_outbox(file)?;
                cursors::load(file, id)
            })
        })?;
        if options.as_copy {
            let (minted, at_us) = (self.mint()?, (options.now_us)());
            let parted = self.change(DOING, |file| {
                seal_chains::rename_copy(file, &server.backend, file_id, minted, at_us)
                    .map_err(|error| self.either(server, DOING, error))
            })?;
            file_id = parted.unwrap_or(file_id);
        }
        let chains = seal_chains::look(&self.backend, &server.backend, file_id);
        let chains = chains.map_err(|error| self.either(server, DOING, error))?;
        if let Some(stands) = &chains.refused {
            return Err(chain_error(self.path(), stands));
        }
        let laptop = server.change(DOING, |_| {
            server.ask(DOING, |server| {
                cursors::register_laptop(server, file_id, options)
            })
        })?;
        let mut sync = Sync {
            file: self,
            server,
            wire,
            id,
            cursors: known.minimum(laptop.cursors),
            // The file has received less than the server knows of: it was restored from a backup.
            own_too: known.received < laptop.cursors.received,
            outcome: SyncOutcome {
                clock_offset_us: laptop.clock_offset_us,
                different: chains.different,
                ..SyncOutcome::default()
            },
            laptop,
            chains: chains.chains,
        };
        sync.all(options)?;
        Ok(sync.outcome)
    }
}

struct Sync<'a> {
    file: &'a Store,
    server: &'a Store,
    wire: &'a Server,
    /// The server's id.
    id: Id,
    laptop: FileRecord,
    cursors: Cursors,
    own_too: bool,
    chains: Vec<Chain>,
    outcome: SyncOutcome,
}

impl Sync<'_> {
    fn all(&mut self, options: &mut SyncOptions<'_>) -> Result<(), StoreError> {
        let reach = self.send(SyncPhase::Sending, None, options)?;
        if !self.outcome.stopped {
            self.send_seals()?;
        }
        if !self.outcome.stopped && options.traces {
            // Traces are sent only up to the entry up to which all runs were sent.
            self.send(SyncPhase::SendingTraces, Some(reach), options)?;
        }
        if !self.outcome.stopped {
            self.receive(options)?;
            self.receive_heads((options.now_us)())?;
        }
        self.outcome.waiting = self.waiting()?;
        self.outcome.conflicts = self.file.conflicts()?;
        Ok(())
    }

    /// Sends traces, or all but traces, up to the outbox entry `until` or to the end; returns the last entry covered.
    /// Each batch is read and sent in one transaction of the server, together with its cursor.
    fn send(
        &mut self,
        phase: SyncPhase,
        until: Option<i64>,
        options: &mut SyncOptions<'_>,
    ) -> Result<i64, StoreError> {
        let traces = phase == SyncPhase::SendingTraces;
        let total = self.entries_waiting(traces)?;
        let mut done = 0;
        loop {
            // Read before sending: an entry recorded from now on may be a trace whose run was not sent.
            let reach = match until {
                Some(reach) => reach,
                None => self.file.ask(SENDING, batch::last)?,
            };
            let after = *self.cursors.of(traces);
            let entries = |file: &Backend| batch::entries(file, traces, after, reach);
            let entries = self.file.ask(SENDING, entries)?;
            if entries.is_empty() || self.outcome.stopped {
                return Ok(reach);
            }
            let mut cursors = self.cursors;
            let outcome = self.server.change(SENDING, |backend| {
                let mut send = || {
                    let batch = Batch::gather(&self.file.backend, self.wire, &entries)?;
                    *cursors.of(traces) = batch.through;
                    done += batch.entries;
                    let new = self.applier(self.laptop.seq).apply(&batch.set)?;
                    cursors::save_on_server(backend, self.laptop.seq, cursors)?;
                    Ok(batch.outcome(&new))
                };
                send().map_err(|error| self.file.either(self.server, SENDING, error))
            })?;
            self.cursors = cursors;
            self.save(options)?;
            self.outcome.add(outcome);
            self.tell(SyncProgress { phase, done, total }, options);
        }
    }

    fn applier(&self, laptop: i64) -> ServerApplier<'_> {
        ServerApplier {
            backend: &self.server.backend,
            server: self.wire,
            laptop,
        }
    }

    /// Sends the seals of what was sent.
    fn send_seals(&mut self) -> Result<(), StoreError> {
        let (file, server) = (self.file, self.server);
        for mut chain in std::mem::take(&mut self.chains) {
            loop {
                let sent = server.change(SENDING, |_| {
                    seal_chains::send(&file.backend, &self.applier(0), &mut chain)
                        .map_err(|error| file.either(server, SENDING, error))
                })?;
                match sent {
                    Some(bytes) => self.outcome.bytes += bytes,
                    None => break,
                }
            }
        }
        Ok(())
    }

    /// Reports progress, and stops if the caller says so.
    fn tell(&mut self, progress: SyncProgress, options: &mut SyncOptions<'_>) {
        self.outcome.stopped |= !(options.go_on)(progress);
    }

    fn receive(&mut self, options: &mut SyncOptions<'_>) -> Result<(), StoreError> {
        let until = self.server.ask(RECEIVING, receive::last)?;
        let new = self.server.ask(RECEIVING, |backend| {
            receive::fresh(backend, self.laptop.seq)
        })?;
        let scope = receive::PullScope {
            laptop: self.laptop.seq,
            until,
            fresh: false,
            own_events: self.own_too,
        };
        let mut done = 0;
        // A pull from the beginning includes all faults anyway.
        if self.cursors.received > 0 {
            let fresh = receive::PullScope {
                fresh: true,
                ..scope
            };
            done = self.receive_from(0, fresh, done, options)?;
        }
        if !self.outcome.stopped {
            self.receive_from(self.cursors.received, scope, done, options)?;
        }
        if self.outcome.stopped {
            return Ok(());
        }
        self.cursors.received = until;
        self.server.change(RECEIVING, |_| {
            self.server.ask(RECEIVING, |_| {
                receive::acknowledge(self.wire, self.laptop.seq, &new, until)
            })
        })?;
        self.save(options)
    }

    /// Receives the ends of all laptops' chains. A chain on the server that lacks an entry which this file has seen is
    /// listed in the outcome.
    fn receive_heads(&mut self, now_us: i64) -> Result<(), StoreError> {
        let known = self.file.ask(RECEIVING, known_heads::of_file)?;
        let broken = |server: &Backend| known_heads::broken(server, &known, None);
        for (id, _) in self.server.ask(RECEIVING, broken)? {
            let (what, id) = ("chain", id);
            self.outcome.different.push(Difference { what, id });
        }
        let heads = |server: &Backend| known_heads::of_server(server, now_us);
        let heads = self.server.ask(RECEIVING, heads)?;
        self.file.change(RECEIVING, |_| {
            self.file.ask(RECEIVING, |file| {
                (heads.iter()).try_for_each(|head| known_heads::keep(file, head))
            })
        })
    }

    fn receive_from(
        &mut self,
        after: i64,
        scope: receive::PullScope,
        mut done: u64,
        options: &mut SyncOptions<'_>,
    ) -> Result<u64, StoreError> {
        let mut after = Some(after);
        while let Some(from) = after {
            let batch = self
                .server
                .ask(RECEIVING, |backend| receive::events(backend, scope, from))?;
            after = batch.next;
            self.outcome.refused.extend(batch.refused);
            let events = batch.set.rows(TableId::Event).count();
            if events == 0 {
                continue;
            }
            let added = self.file.write(RECEIVING, |conn| {
                self.file
                    .ask(RECEIVING, |file| receive::add(file, conn, &batch.set))
            })?;
            self.outcome.add(added);
            done += events as u64;
            let phase = SyncPhase::Receiving;
            let total = 0;
            self.tell(SyncProgress { phase, done, total }, options);
            if self.outcome.stopped {
                break;
            }
        }
        Ok(done)
    }

    /// Stores the cursors in the file.
    fn save(&self, options: &SyncOptions<'_>) -> Result<(), StoreError> {
        const DOING: &str = "remembering a sync";
        let address = self.server.path().to_string_lossy().into_owned();
        let now_us = (options.now_us)();
        self.file.change(DOING, |_| {
            self.file.ask(DOING, |file| {
                cursors::save(file, self.id, &address, self.cursors, now_us)
            })
        })
    }

    fn waiting(&self) -> Result<u64, StoreError> {
        Ok(self.entries_waiting(false)? + self.entries_waiting(true)?)
    }

    /// Number of entries still to be sent: traces, or all but traces.
    fn entries_waiting(&self, traces: bool) -> Result<u64, StoreError> {
        let sql = "SELECT count(*) FROM outbox WHERE seq > ?1 AND (what = 'trace') = ?2";
        let after = *{ self.cursors }.of(traces);
        let found = self.file.ask("counting what waits", |file| {
            file.first(sql, &values![after, traces], |row| row.get(0))
        })?;
        Ok(found.unwrap_or_default())
    }
}

impl Store {
    /// Attributes an error to this file or to the server.
    fn either(&self, server: &Store, doing: &'static str, error: SqlError) -> StoreError {
        match error {
            SqlError::File(_) | SqlError::Value { .. } | SqlError::Refused(_) => {
                self.failed(doing, error)
            }
            SqlError::Server(_) => server.failed(doing, error),
        }
    }
}

impl SyncOutcome {
    fn add(&mut self, other: Self) {
        self.runs += other.runs;
        self.occurrences += other.occurrences;
        self.events += other.events;
        self.notes += other.notes;
        self.traces += other.traces;
        self.already_there += other.already_there;
        self.events_received += other.events_received;
        self.faults_changed += other.faults_changed;
        self.bytes += other.bytes;
        self.different.extend(other.different);
        self.damaged_traces.extend(other.damaged_traces);
        self.refused.extend(other.refused);
    }
}
