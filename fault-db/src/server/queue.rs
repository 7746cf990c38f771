//! A server's tables as a queue of runs for many workers: each run is lent to a worker for a time, and to another one if
//! it does not come back by then. The tables lie in a schema of their own, `ptu_queue`, in any database.

use std::borrow::Cow;
use std::path::PathBuf;

use super::address::Address;
use super::connect::open;
use crate::backend::{Backend, SqlResult, Value, values};
use crate::error::StoreError;

const DOING: &str = "working on the queue";

/// A run that was lent this often and never came back is not lent again.
pub const MOST_TRIES: u32 = 5;

const TABLES: &str = "
    CREATE SCHEMA IF NOT EXISTS ptu_queue;
    CREATE TABLE IF NOT EXISTS ptu_queue.campaign (
        id text PRIMARY KEY,
        what text NOT NULL,
        made_at timestamptz NOT NULL DEFAULT now()
    );
    CREATE TABLE IF NOT EXISTS ptu_queue.run (
        campaign text NOT NULL REFERENCES ptu_queue.campaign ON DELETE CASCADE,
        number bigint NOT NULL,
        tries bigint NOT NULL DEFAULT 0,
        lent_until timestamptz,
        record bytea,
        PRIMARY KEY (campaign, number)
    );
    CREATE INDEX IF NOT EXISTS run_open ON ptu_queue.run (campaign, number) WHERE record IS NULL";

/// Two workers never wait for each other: a row that another one looks at is passed over.
const CLAIM: &str = "
    UPDATE ptu_queue.run SET tries = tries + 1, lent_until = now() + ?2 * interval '1 second'
    WHERE campaign = ?1 AND number = (
        SELECT number FROM ptu_queue.run
        WHERE campaign = ?1 AND record IS NULL AND tries < ?3 AND (lent_until IS NULL OR lent_until < now())
        ORDER BY number LIMIT 1 FOR UPDATE SKIP LOCKED)
    RETURNING number";

/// A run that is open, those lent out last; whether it is lent no more.
const OPEN: &str = "
    SELECT number, tries >= ?2 AND lent_until < now() FROM ptu_queue.run
    WHERE campaign = ?1 AND record IS NULL ORDER BY 2 DESC, number LIMIT 1";

const FINISH: &str = "
    UPDATE ptu_queue.run SET record = ?3, lent_until = NULL
    WHERE campaign = ?1 AND number = ?2 AND record IS NULL";

const GIVE_BACK: &str = "
    UPDATE ptu_queue.run SET tries = tries - 1, lent_until = NULL
    WHERE campaign = ?1 AND number = ?2 AND record IS NULL";

/// A campaign's runs on a server.
pub struct Queue {
    backend: Backend,
    path: PathBuf,
    campaign: String,
    lease_s: u32,
}

/// What there is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Claim {
    /// The run of this number.
    Run(u64),
    /// Nothing now: other workers have the rest.
    Wait,
    /// Nothing more: all runs are there.
    Done,
    /// The run of this number was lent [`MOST_TRIES`] times and never came back.
    GivenUp(u64),
}

impl Queue {
    /// Connects, and enters the campaign's runs if they are not there yet: `campaign` tells it from all others, `what` is for people.
    ///
    /// # Errors
    /// The server cannot be reached, or lets this account make no tables.
    pub fn open(
        address: &Address,
        (campaign, what): (&str, &str),
        runs: u64,
        lease_s: u32,
    ) -> Result<Self, StoreError> {
        let (backend, path) = open(address)?;
        let queue = Self {
            backend,
            path,
            campaign: campaign.to_owned(),
            lease_s,
        };
        queue.ask(|queue| queue.enter(what, runs))?;
        Ok(queue)
    }

    fn enter(&self, what: &str, runs: u64) -> SqlResult<()> {
        let Backend::Server(server) = &self.backend else {
            return Ok(());
        };
        // One worker makes the tables, and the others wait for it.
        server.begin()?;
        let entered = server.batch(TABLES).and_then(|()| {
            let campaign = "INSERT INTO ptu_queue.campaign (id, what) VALUES (?1, ?2) ON CONFLICT DO NOTHING";
            let new = (self.backend).execute(campaign, &values![&self.campaign, what])?;
            let all = "INSERT INTO ptu_queue.run (campaign, number) SELECT ?1, * FROM generate_series(0, ?2 - 1)";
            let runs = i64::try_from(runs).unwrap_or(i64::MAX);
            if new > 0 {
                self.backend.execute(all, &values![&self.campaign, runs])?;
            }
            server.batch("COMMIT")
        });
        entered.inspect_err(|_| {
            // The error says more than a failed rollback would.
            let _ = server.batch("ROLLBACK");
        })
    }

    /// Takes a run, which no other process gets for the time of the lease.
    ///
    /// # Errors
    /// The server's.
    pub fn claim(&self) -> Result<Claim, StoreError> {
        self.ask(|queue| {
            let asked = values![&queue.campaign, queue.lease_s, MOST_TRIES];
            let number = |number: i64| u64::try_from(number).unwrap_or_default();
            if let Some(run) = (queue.backend).first(CLAIM, &asked, |row| row.get(0))? {
                return Ok(Claim::Run(number(run)));
            }
            let asked = values![&queue.campaign, MOST_TRIES];
            let read =
                |row: crate::backend::Row<'_>| Ok((row.get(0)?, row.get::<Option<bool>>(1)?));
            Ok(match queue.backend.first(OPEN, &asked, read)? {
                None => Claim::Done,
                Some((run, Some(true))) => Claim::GivenUp(number(run)),
                Some(_) => Claim::Wait,
            })
        })
    }

    /// Brings a run's record. False if another worker, which had it after this one, has brought another record.
    ///
    /// # Errors
    /// The server's.
    pub fn finish(&self, run: u64, record: &[u8]) -> Result<bool, StoreError> {
        self.ask(|queue| {
            let run = i64::try_from(run).unwrap_or(i64::MAX);
            let asked = [
                Value::from(&queue.campaign),
                Value::from(run),
                Value::Bytes(Cow::Borrowed(record)),
            ];
            if queue.backend.execute(FINISH, &asked)? > 0 {
                return Ok(true);
            }
            let there = "SELECT record FROM ptu_queue.run WHERE campaign = ?1 AND number = ?2";
            let asked = values![&queue.campaign, run];
            let there = queue
                .backend
                .first(there, &asked, |row| row.get::<Vec<u8>>(0))?;
            Ok(there.is_some_and(|there| there == record))
        })
    }

    /// Gives a run back that is not made.
    ///
    /// # Errors
    /// The server's.
    pub fn give_back(&self, run: u64) -> Result<(), StoreError> {
        let run = i64::try_from(run).unwrap_or(i64::MAX);
        self.ask(|queue| {
            let asked = values![&queue.campaign, run];
            queue.backend.execute(GIVE_BACK, &asked).map(drop)
        })
    }

    /// All records there are.
    ///
    /// # Errors
    /// The server's.
    pub fn records(&self) -> Result<Vec<Vec<u8>>, StoreError> {
        self.ask(|queue| {
            let all = "SELECT record FROM ptu_queue.run WHERE campaign = ?1 AND record IS NOT NULL ORDER BY number";
            (queue.backend).select(all, &values![&queue.campaign], |row| row.get(0))
        })
    }

    fn ask<T>(&self, question: impl FnOnce(&Self) -> SqlResult<T>) -> Result<T, StoreError> {
        question(self).map_err(|error| StoreError::from_sql(&self.path, DOING, error))
    }
}
