//! A file and a server: what the file recorded goes there, and what others said about its faults comes
//! back. The file has everything at all times; the server is told when it can be reached.
//!
//! Every entry of the file's outbox is sent once it is there, in batches of one transaction each, and
//! rows on the server are only added. So a sync that breaks off anywhere is taken up by the next, and
//! one that has nothing new changes nothing.

mod adopt;
mod batch;
mod heads;
mod ledger;
mod outcome;
mod pull;
mod rows;
mod tables;
mod traces;

use crate::base::{Base, Server, SqlError, SqlResult, values};
use crate::error::StoreError;
use crate::id::Id;
use crate::server::schema::server_id;
use crate::store::Store;
pub(crate) use heads::refusal;
use heads::{Chain, HeadsError};
use ledger::{Cursors, Laptop};
pub use outcome::{Different, SyncOptions, SyncOutcome, SyncPhase, SyncProgress};

const SENDING: &str = "sending";
const RECEIVING: &str = "receiving";

impl Store {
    /// Brings this file and a server together: sends what the server has not, and gets what was said
    /// about this file's faults elsewhere.
    ///
    /// # Errors
    /// The server is away, or the file cannot be written. What was sent until then stays sent.
    pub fn sync(
        &self,
        server: &Store,
        options: &mut SyncOptions<'_>,
    ) -> Result<SyncOutcome, StoreError> {
        const DOING: &str = "beginning a sync";
        let mut file_id = self.file_id()?;
        let wire = server.server()?;
        let id = server_id(server.base()).map_err(|error| server.failed(DOING, error))?;
        let id = id.ok_or_else(|| StoreError::ServerForeign {
            path: server.path().to_path_buf(),
        })?;
        let remembered = self.change(DOING, |file| {
            let adopt = || {
                adopt::interrupted_runs(file, options.is_alive)?;
                adopt::earlier_rows(file)?;
                ledger::remembered(file, id)
            };
            adopt().map_err(|error| self.failed(DOING, error))
        })?;
        if options.as_copy {
            let (minted, at_us) = (self.mint()?, (options.now_us)());
            let parted = self.change(DOING, |file| {
                heads::part(file, server.base(), file_id, minted, at_us)
                    .map_err(|error| self.either(server, DOING, error))
            })?;
            file_id = parted.unwrap_or(file_id);
        }
        let chains = heads::look(self.base(), server.base(), file_id, self.path());
        let chains = chains.map_err(|error| match error {
            HeadsError::Sql(error) => self.either(server, DOING, error),
            HeadsError::Refused(error) => error,
        })?;
        let laptop = server.change(DOING, |base| {
            let known = ledger::introduce(base, file_id, options);
            known.map_err(|error| server.failed(DOING, error))
        })?;
        let mut sync = Sync {
            file: self,
            server,
            wire,
            id,
            cursors: remembered.common(laptop.cursors),
            // The file is behind what it once got: it came back from a backup.
            own_too: remembered.received < laptop.cursors.received,
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

/// One sync under way.
struct Sync<'a> {
    file: &'a Store,
    server: &'a Store,
    wire: &'a Server,
    /// The server's own name.
    id: Id,
    laptop: Laptop,
    cursors: Cursors,
    own_too: bool,
    chains: Vec<Chain>,
    outcome: SyncOutcome,
}

impl Sync<'_> {
    fn all(&mut self, options: &mut SyncOptions<'_>) -> Result<(), StoreError> {
        let reach = self.send(options)?;
        if !self.outcome.stopped {
            self.send_seals()?;
        }
        if !self.outcome.stopped && options.traces {
            self.send_traces(reach, options)?;
        }
        if !self.outcome.stopped {
            self.receive(options)?;
        }
        self.outcome.waiting = self.waiting()?;
        self.outcome.conflicts = self.file.conflicts()?;
        Ok(())
    }

    /// Sends all but traces; up to which entry of the outbox that is.
    fn send(&mut self, options: &mut SyncOptions<'_>) -> Result<i64, StoreError> {
        let total = self.entries_after(self.cursors.sent, "what <> 'trace'")?;
        let mut done = 0;
        loop {
            // Asked first: what is recorded from now on may be a trace whose run has not been sent.
            let reach = self.of_file(SENDING, batch::last)?;
            let entries = self.of_file(SENDING, |file| batch::entries(file, self.cursors.sent))?;
            if entries.is_empty() || self.outcome.stopped {
                return Ok(reach);
            }
            done += self.send_batch(options, |sync, base, cursors| {
                let batch = batch::Batch::gather(sync.file.base(), sync.wire, &entries)?;
                cursors.sent = batch.through;
                let count = batch.entries;
                Ok((count, batch.send(base, sync.wire, &sync.laptop)?))
            })?;
            let phase = SyncPhase::Sending;
            self.tell(SyncProgress { phase, done, total }, options);
        }
    }

    /// Sends the seals of what has been sent.
    fn send_seals(&mut self) -> Result<(), StoreError> {
        let (file, server, wire) = (self.file, self.server, self.wire);
        for chain in &mut self.chains {
            loop {
                let sent = server.change(SENDING, |_| {
                    heads::send(file.base(), wire, chain)
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

    /// Sends traces up to an entry of the outbox up to which all runs have been sent.
    fn send_traces(&mut self, reach: i64, options: &mut SyncOptions<'_>) -> Result<(), StoreError> {
        let total = self.entries_after(self.cursors.sent_traces, "what = 'trace'")?;
        let mut done = 0;
        loop {
            let after = self.cursors.sent_traces;
            let entries = self.of_file(SENDING, |file| traces::entries(file, after, reach))?;
            if entries.is_empty() || self.outcome.stopped {
                return Ok(());
            }
            done += self.send_batch(options, |sync, _, cursors| {
                let batch = traces::Batch::gather(sync.file.base(), sync.wire, &entries)?;
                cursors.sent_traces = batch.through;
                let count = batch.entries;
                Ok((count, batch.send(sync.wire, sync.laptop.seq)?))
            })?;
            let phase = SyncPhase::SendingTraces;
            self.tell(SyncProgress { phase, done, total }, options);
        }
    }

    /// Gathers and sends a batch in one transaction of the server, with the cursor that goes with it; how
    /// many entries it had.
    fn send_batch(
        &mut self,
        options: &SyncOptions<'_>,
        work: impl FnOnce(&Self, &Base, &mut Cursors) -> SqlResult<(u64, SyncOutcome)>,
    ) -> Result<u64, StoreError> {
        let mut cursors = self.cursors;
        let (count, outcome) = self.server.change(SENDING, |base| {
            let sent = work(self, base, &mut cursors).and_then(|sent| {
                ledger::note(base, self.laptop.seq, cursors)?;
                Ok(sent)
            });
            sent.map_err(|error| self.file.either(self.server, SENDING, error))
        })?;
        self.cursors = cursors;
        self.remember(options)?;
        self.outcome.add(outcome);
        Ok(count)
    }

    /// Tells how far it is, and hears whether to go on.
    fn tell(&mut self, progress: SyncProgress, options: &mut SyncOptions<'_>) {
        self.outcome.stopped |= !(options.go_on)(progress);
    }

    fn receive(&mut self, options: &mut SyncOptions<'_>) -> Result<(), StoreError> {
        let until = self.of_server(RECEIVING, pull::last)?;
        let new = self.of_server(RECEIVING, |base| pull::fresh(base, self.laptop.seq))?;
        let asked = pull::Asked {
            laptop: self.laptop.seq,
            until,
            fresh: false,
            own: self.own_too,
        };
        let mut done = 0;
        // Who asks from the beginning is told of all faults anyway.
        if self.cursors.received > 0 {
            let fresh = pull::Asked {
                fresh: true,
                ..asked
            };
            done = self.receive_from(0, fresh, done, options)?;
        }
        if !self.outcome.stopped {
            self.receive_from(self.cursors.received, asked, done, options)?;
        }
        if self.outcome.stopped {
            return Ok(());
        }
        self.cursors.received = until;
        self.server.change(RECEIVING, |_| {
            pull::told(self.wire, self.laptop.seq, &new, until)
                .map_err(|error| self.server.failed(RECEIVING, error))
        })?;
        self.remember(options)
    }

    fn receive_from(
        &mut self,
        after: i64,
        asked: pull::Asked,
        mut done: u64,
        options: &mut SyncOptions<'_>,
    ) -> Result<u64, StoreError> {
        let mut after = Some(after);
        while let Some(from) = after {
            let batch = self.of_server(RECEIVING, |base| pull::events(base, asked, from))?;
            after = batch.next;
            self.outcome.refused.extend(batch.refused);
            let events = batch.events;
            if events.is_empty() {
                continue;
            }
            let added = self.file.change(RECEIVING, |file| {
                pull::add(file, &events).map_err(|error| self.file.failed(RECEIVING, error))
            })?;
            self.outcome.add(added);
            done += events.len() as u64;
            let phase = SyncPhase::Receiving;
            let total = 0;
            self.tell(SyncProgress { phase, done, total }, options);
            if self.outcome.stopped {
                break;
            }
        }
        Ok(done)
    }

    /// Keeps the cursors in the file.
    fn remember(&self, options: &SyncOptions<'_>) -> Result<(), StoreError> {
        const DOING: &str = "remembering a sync";
        let address = self.server.path().to_string_lossy().into_owned();
        let now_us = (options.now_us)();
        self.file.change(DOING, |file| {
            ledger::remember(file, self.id, &address, self.cursors, now_us)
                .map_err(|error| self.file.failed(DOING, error))
        })
    }

    fn waiting(&self) -> Result<u64, StoreError> {
        let rest = self.entries_after(self.cursors.sent, "what <> 'trace'")?;
        Ok(rest + self.entries_after(self.cursors.sent_traces, "what = 'trace'")?)
    }

    fn entries_after(&self, cursor: i64, which: &str) -> Result<u64, StoreError> {
        let sql = format!("SELECT count(*) FROM outbox WHERE seq > ?1 AND {which}");
        let found = self.of_file("counting what waits", |file| {
            file.first(&sql, &values![cursor], |row| row.get(0))
        })?;
        Ok(found.unwrap_or_default())
    }

    fn of_file<T>(
        &self,
        doing: &'static str,
        ask: impl FnOnce(&Base) -> SqlResult<T>,
    ) -> Result<T, StoreError> {
        ask(self.file.base()).map_err(|error| self.file.failed(doing, error))
    }

    fn of_server<T>(
        &self,
        doing: &'static str,
        ask: impl FnOnce(&Base) -> SqlResult<T>,
    ) -> Result<T, StoreError> {
        ask(self.server.base()).map_err(|error| self.server.failed(doing, error))
    }
}

impl Store {
    /// An error of this file or of the server, as it says itself.
    fn either(&self, server: &Store, doing: &'static str, error: SqlError) -> StoreError {
        match error {
            SqlError::File(_) | SqlError::Value { .. } => self.failed(doing, error),
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
