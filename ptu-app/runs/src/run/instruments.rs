//! The instruments of the bench that a run rests on, and whether their calibration holds.

use std::sync::Arc;

use fault_db::{Instrument, Store};

use super::bench_setup::BenchSetup;
use super::plan::Task;
use crate::clock;
use crate::failure::{Failure, RunTrouble};
use crate::link::Endpoint;

/// The instruments of this bench that a run on a port uses: all that are registered and not retired. A simulated unit is
/// measured by none.
///
/// # Errors
/// The calibration of one of them is over, and the run was not to go on without.
pub(super) fn of_run(
    store: &Store,
    setup: &BenchSetup,
    uncalibrated: bool,
) -> Result<Vec<Instrument>, Failure> {
    if setup.endpoint == Endpoint::Sim {
        return Ok(Vec::new());
    }
    let used = store.instruments()?;
    let today = clock::local_day(clock::now_us());
    match used.iter().find(|used| !used.is_calibrated_on(&today)) {
        Some(over) if !uncalibrated => Err(Failure::bench(not_calibrated(over))),
        _ => Ok(used),
    }
}

/// Narrows the limits of all measurements by the uncertainty of the instrument registered for their unit of
/// measurement.
///
/// # Errors
/// No instrument says how uncertain it is.
pub(super) fn guard_band(tasks: &mut [Task], store: &Store) -> Result<(), Failure> {
    let used = store.instruments()?;
    if used.iter().all(|used| used.uncertainty.is_empty()) {
        return Err(Failure::usage(RunTrouble::NoUncertainty));
    }
    for task in tasks {
        let procedure = Arc::make_mut(&mut task.procedure);
        for measure in procedure
            .steps
            .iter_mut()
            .flat_map(|step| &mut step.measures)
        {
            let of_unit = |used: &Instrument| used.uncertainty.get(measure.unit()).copied();
            let Some(off) = used.iter().find_map(of_unit) else {
                continue;
            };
            measure.widen(-off);
        }
    }
    Ok(())
}

fn not_calibrated(instrument: &Instrument) -> RunTrouble {
    let (kind, serial) = (instrument.kind.clone(), instrument.serial_no.clone());
    let due = instrument
        .due
        .clone()
        .filter(|_| instrument.calibrated.is_some());
    match due {
        Some(due) => RunTrouble::Uncalibrated(kind, serial, due),
        None => RunTrouble::NeverCalibrated(kind, serial),
    }
}
