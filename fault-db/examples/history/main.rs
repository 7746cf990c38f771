//! Writes a made-up history of a metro's fleet, as its depots would have recorded it:
//!
//! ```text
//! cargo run --release -p fault-db --example history -- FILE [--faults 1000000] [--runs 100000]
//!     [--units 150] [--years 3] [--until 2026-06-30] [--traces 0] [--seed 1]
//! cargo run --release -p fault-db --example history -- FILE --year
//! ```
//!
//! Units in trains of four lines age, fail by season, get the right part or a wrong one, are found good,
//! and are tested again. All of it goes through the calls the program itself uses. The same seed makes
//! the same history, ids included.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "what a benchmark or an example is for"
)]

mod bench;
mod catalogue;
mod chance;
#[path = "../../tests/common/mod.rs"]
mod common;
mod fleet;
mod options;
mod people;
mod runs;
mod words;

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::Instant;

use fault_db::{IdSource, OpenOptions, Store, StoreError, Synchronous};

use chance::Chance;
use fleet::Fleet;
use options::Options;
use people::People;
use runs::{DAY_US, Visit};

/// Runs committed at once.
const BATCH: usize = 40;
/// Of all runs that only read the unit's log; how many faults are seen in one against all runs, and in
/// one that tests.
const LOGS: f64 = 0.35;
const FAULTS_OF_LOG: f64 = 2.4;
const FAULTS_OF_TEST: f64 = (1.0 - LOGS * FAULTS_OF_LOG) / (1.0 - LOGS);

fn main() -> ExitCode {
    let made = Options::read(std::env::args().skip(1)).and_then(|options| {
        let begun = Instant::now();
        let made = write(&options).map_err(|error| error.to_string())?;
        Ok((made, begun.elapsed().as_secs_f64()))
    });
    match made {
        Ok((made, seconds)) => {
            println!(
                "{} runs, {} occurrences, {} traces in {seconds:.0} s",
                made.runs, made.occurrences, made.traces
            );
            ExitCode::SUCCESS
        }
        Err(why) => {
            eprintln!("{why}");
            ExitCode::from(2)
        }
    }
}

/// How much there is.
#[derive(Default)]
struct Made {
    runs: usize,
    occurrences: usize,
    traces: usize,
}

fn write(options: &Options) -> Result<Made, StoreError> {
    let start_us = options.until_us - options.days * DAY_US;
    let clock = Arc::new(AtomicI64::new(start_us));
    let ids = ids(options.seed, Arc::clone(&clock));
    let opening = OpenOptions::new(ids).synchronous(Synchronous::Normal);
    let store = Store::open(&options.file, opening)?;
    let mut chance = Chance::new(options.seed);
    let mut fleet = Fleet::new(options.units, start_us, &mut chance);
    let mut people = People::default();
    let mut made = Made::default();
    while made.runs < options.runs {
        store.transaction(|| {
            for _ in 0..BATCH.min(options.runs - made.runs) {
                let visit = next_visit(options, &made, &fleet, start_us, &mut chance);
                while people
                    .next_us()
                    .is_some_and(|next_us| next_us < visit.at_us)
                {
                    clock.store(people.next_us().unwrap_or(start_us), Ordering::Relaxed);
                    people.act(&store, &mut fleet, &mut chance)?;
                }
                clock.store(visit.at_us, Ordering::Relaxed);
                let seen = runs::record(&store, &mut fleet, &mut people, &visit, &mut chance)?;
                made.runs += 1;
                made.occurrences += seen.occurrences;
                made.traces += seen.traces;
                if chance.happens(0.002) {
                    fleet.swap(&mut chance);
                }
            }
            Ok(())
        })?;
        if made.runs % (BATCH * 250) == 0 {
            eprintln!("{} runs, {} occurrences", made.runs, made.occurrences);
        }
    }
    store.close()?;
    Ok(made)
}

/// The next run: evenly over the years, mostly in the daytime, first of units whose repair is not proven.
fn next_visit(
    options: &Options,
    made: &Made,
    fleet: &Fleet,
    start_us: i64,
    chance: &mut Chance,
) -> Visit {
    let left = options.runs - made.runs;
    let place = (made.runs as f64 + chance.part()) / options.runs as f64;
    let at_us = start_us + ((options.days * DAY_US) as f64 * place) as i64;
    let unit = (0..4)
        .map(|_| chance.below(fleet.units.len()))
        .max_by_key(|&unit| {
            let unit = &fleet.units[unit];
            let repaired = |slot: &&fleet::Slot| slot.state == fault_db::FaultState::Repaired;
            let unproven = unit.slots.iter().filter(repaired).count() as i64;
            (at_us - unit.seen_us) / DAY_US + unproven
        })
        .unwrap_or(0);
    let of_log = chance.happens(LOGS);
    let mean = options.faults.saturating_sub(made.occurrences) as f64 / left as f64;
    let share = if of_log {
        FAULTS_OF_LOG
    } else {
        FAULTS_OF_TEST
    };
    let faults = if left == 1 {
        options.faults.saturating_sub(made.occurrences)
    } else {
        chance.count(mean * share * fleet.units[unit].factor)
    };
    let traced = !of_log && (made.traces as f64) < options.traces as f64 * place;
    Visit {
        unit,
        at_us,
        of_log,
        faults,
        traced,
    }
}

/// Ids as they would have been minted at the time.
fn ids(seed: u64, clock: Arc<AtomicI64>) -> IdSource {
    let mut chance = Chance::new(seed ^ 0x1D5);
    IdSource::new(move || {
        let mut random = [0; 10];
        random[..8].copy_from_slice(&chance.bits().to_be_bytes());
        random[8..].copy_from_slice(&chance.bits().to_be_bytes()[..2]);
        (clock.load(Ordering::Relaxed).unsigned_abs() / 1000, random)
    })
}
