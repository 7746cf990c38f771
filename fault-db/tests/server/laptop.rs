//! Laptops for the tests: a file each, with runs, faults and people who say something about them.

use std::path::{Path, PathBuf};

use fault_db::{
    Address, FaultDetail, FaultFilter, FaultState, Id, OpenOptions, RunWriter, Store, StoreError,
    SyncOptions, SyncOutcome, SyncProgress, Verdict,
};
use tempfile::TempDir;

use crate::common::{self, Deeds, T0_US};
use crate::private::{name_of, shared};

/// A laptop with its file.
pub struct Laptop {
    pub name: &'static str,
    folder: TempDir,
    seed: std::cell::Cell<u64>,
    /// Time by which the laptop's clock is ahead of the true time, µs.
    pub clock_ahead_us: std::cell::Cell<i64>,
    /// Further syncs give the file a name of its own, if the file is a copy.
    pub as_copy: std::cell::Cell<bool>,
}

impl Laptop {
    pub fn new(name: &'static str) -> Self {
        let letters = name
            .bytes()
            .fold(7, |sum: u64, byte| sum * 31 + u64::from(byte));
        Self {
            name,
            folder: tempfile::tempdir().expect("a folder"),
            // Each opening of the file takes one more: names next to each other stay apart.
            seed: (letters * 100_003).into(),
            clock_ahead_us: 0.into(),
            as_copy: false.into(),
        }
    }

    pub fn path(&self) -> PathBuf {
        self.folder.path().join("history.db")
    }

    pub fn open(&self) -> Store {
        self.seed.set(self.seed.get() + 1);
        common::open_as(&self.path(), self.seed.get())
    }

    /// Syncs with a server, samples and all.
    pub fn sync(&self, address: &str) -> SyncOutcome {
        self.try_sync(address, &mut |_| true).expect("a sync")
    }

    pub fn try_sync(
        &self,
        address: &str,
        go_on: &mut dyn FnMut(SyncProgress) -> bool,
    ) -> Result<SyncOutcome, StoreError> {
        let mut options = SyncOptions {
            laptop: self.name,
            traces: true,
            as_copy: self.as_copy.get(),
            now_us: &|| system_now_us() + self.clock_ahead_us.get(),
            go_on,
        };
        self.open().sync(&connect(address)?, &mut options)
    }

    /// Holds the file to its own checks: checksums, seals, and counts that fit the rows.
    pub fn is_whole(&self) {
        assert_eq!(common::problems(&self.open()), [], "{}", self.name);
    }

    /// Another laptop with the same name and a copy of the file.
    pub fn copy(&self) -> Self {
        let copy = Self::new(self.name);
        std::fs::copy(self.path(), copy.path()).expect("a copy");
        copy
    }

    /// Changes the file by hand.
    pub fn alter(&self, sql: &str) {
        let file = rusqlite::Connection::open(self.path()).expect("its file");
        file.execute_batch(sql).expect("changed by hand");
    }

    /// Somebody gives the only fault this state.
    pub fn judge(&self, state: FaultState, at_us: i64) {
        let store = self.open();
        store.put_state(only_fault(&store).fault.id, state, "kim", "", at_us);
    }

    /// A run of three steps that sees these faults of a unit, one trace each if wanted.
    pub fn run(&self, serial: &str, at_us: i64, codes: &[i64], traces: bool) -> Id {
        record(&self.open(), serial, at_us, codes, traces)
    }
}

/// Syncs a file with a server, samples and all, in a process of its own.
pub fn sync(
    file: &Path,
    address: &str,
    laptop: &str,
    go_on: &mut dyn FnMut(SyncProgress) -> bool,
) -> Result<(), StoreError> {
    let server = connect(address)?;
    let ids = common::ids(system_now_us().unsigned_abs());
    let store = Store::open(file, OpenOptions::new(ids))?;
    let mut options = SyncOptions {
        laptop,
        traces: true,
        as_copy: false,
        now_us: &system_now_us,
        go_on,
    };
    store.sync(&server, &mut options)?;
    store.close()
}

/// Records a run of three steps that sees these faults of a unit.
pub fn record(store: &Store, serial: &str, at_us: i64, codes: &[i64], traces: bool) -> Id {
    let mut record = common::run_record(serial);
    record.started_at_us = at_us;
    record.train = "T7".to_owned();
    let mut writer = RunWriter::begin(store, &record).expect("a run");
    for index in 0..3 {
        let mut step = common::step(index);
        let value = 0.42 + 0.01 * f64::from(index) + (at_us % 97) as f64 * 1e-4;
        step.measurements
            .push(common::measurement("eb_reaction", value));
        writer.step(step).expect("a step");
    }
    for (number, code) in (0..).zip(codes) {
        let fault = common::fault(*code, at_us + 1_000_000 * (number + 1));
        let stored = writer.fault(&fault).expect("a fault");
        if traces {
            let mut trace = common::realistic_trace(60, code.unsigned_abs());
            trace.t0_us = at_us;
            writer.trace(&[stored.occurrence], &trace).expect("a trace");
        }
    }
    let passed = codes.is_empty();
    let mut end = common::end([Verdict::Failed, Verdict::Passed][usize::from(passed)]);
    end.finished_at_us = at_us + 60_000_000;
    writer.finish(&end).expect("an end");
    writer.id()
}

pub fn open_faults(store: &Store) -> Vec<Id> {
    let all = store.faults(&FaultFilter::default()).expect("faults");
    all.iter().map(|fault| fault.id).collect()
}

pub fn only_fault(store: &Store) -> FaultDetail {
    let all = open_faults(store);
    assert_eq!(all.len(), 1, "{all:?}");
    store.fault(all[0]).expect("the fault")
}

pub fn connect(address: &str) -> Result<Store, StoreError> {
    let address: Address = address.parse()?;
    Store::connect(&address, common::ids(system_now_us().unsigned_abs()))
}

/// The owner of a server's database changes it by hand.
pub fn as_owner(address: &str, sql: &str) {
    let done = shared().client(name_of(address)).batch_execute(sql);
    done.expect("the owner may");
}

pub fn read_only(address: &str) -> Result<Store, StoreError> {
    Store::connect_read_only(&address.parse()?)
}

pub fn system_now_us() -> i64 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    since.expect("a clock after 1970").as_micros() as i64
}

/// The `n`th day of the tests, µs.
pub fn day(n: i64) -> i64 {
    T0_US + n * 86_400_000_000
}
