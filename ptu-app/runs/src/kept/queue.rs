//! Runs from a queue on a server: any number of workers, of which any may be killed.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use fault_db::{Address, Claim, MOST_TRIES, Queue};
use serde::Serialize;

use super::Head;
use super::record::of_run;
use crate::data::sha256;
use crate::failure::Failure;
use crate::pool;
use crate::stop::Stop;

/// Time between two questions where other workers have the last runs.
const PATIENCE: Duration = Duration::from_millis(250);

/// A queue on a server.
#[derive(Clone, Debug)]
pub struct QueueAt {
    /// The server.
    pub address: Address,
    /// For how long a run is lent to a worker, s: longer than any run takes.
    pub lease_s: u32,
}

/// What this worker did.
pub(super) struct Worked {
    /// Runs made here.
    pub made: usize,
    /// All records of the queue; none after a stop.
    pub records: Option<Vec<Vec<u8>>>,
}

/// Takes runs until all are there, or a stop.
pub(super) fn work<R: Serialize + Send>(
    at: &QueueAt,
    head: &Head,
    (jobs, stop): (usize, &Stop),
    tell: &mut dyn FnMut(usize),
    run: impl Fn(usize) -> Option<R> + Sync,
) -> Result<Worked, Failure> {
    let plan = &head.plan;
    let names = (&plan.names, plan.seeds);
    let id = sha256(&format!("{} {} {names:?}", head.app_version, head.made_by));
    let queue = Queue::open(
        &at.address,
        (&id, &plan.what),
        plan.len() as u64,
        at.lease_s,
    )?;
    let queue = Mutex::new(queue);
    let asked = || queue.lock().unwrap_or_else(PoisonError::into_inner);
    let (over, made) = (AtomicBool::new(false), AtomicUsize::new(0));
    let one = || -> Result<(), Failure> {
        while stop.may_begin() && !over.load(Ordering::Relaxed) {
            let claim = asked().claim()?;
            let number = match claim {
                Claim::Run(number) => number,
                Claim::Wait => {
                    std::thread::sleep(PATIENCE);
                    continue;
                }
                Claim::Done => {
                    over.store(true, Ordering::Relaxed);
                    break;
                }
                Claim::GivenUp(number) => return Err(given_up(number, plan.name(number as usize))),
            };
            let Some(run) = run(number as usize) else {
                asked().give_back(number)?;
                break;
            };
            let record = of_run(plan.name(number as usize), &run);
            if !asked().finish(number, &record)? {
                return Err(Failure::bench(format!(
                    "another worker's run {number} has another result: it is of another build of the program"
                )));
            }
            made.fetch_add(1, Ordering::Relaxed);
            break;
        }
        Ok(())
    };
    let failure = Mutex::new(None);
    pool::run(plan.len(), jobs, stop, tell, |_| {
        if let Err(why) = one() {
            stop.press_once();
            let mut failure = failure.lock().unwrap_or_else(PoisonError::into_inner);
            failure.get_or_insert(why);
        }
    });
    if let Some(failure) = failure.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(failure);
    }
    // Where this worker made the last run of all, no other has asked since.
    let is_done =
        over.into_inner() || (stop.may_begin() && matches!(asked().claim()?, Claim::Done));
    Ok(Worked {
        made: made.into_inner(),
        records: match is_done {
            true => Some(asked().records()?),
            false => None,
        },
    })
}

fn given_up(number: u64, name: String) -> Failure {
    Failure::bench(format!(
        "run {number} of the queue ({name}) was begun {MOST_TRIES} times and never came back: it ends its worker, or takes \
         longer than its lease; make it alone with --shard, or give a longer --lease"
    ))
}
