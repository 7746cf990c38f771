//! Sections that the train drives before its port is opened, so that the unit has a log and a run record.

use btu_rig::drive::DrivePlan;

use crate::aboard::{Arrival, Doors, UnitAboard};
use crate::drive::SectionChoice;
use crate::failure::{DriveTrouble, Failure, Trouble};
use crate::run::BenchSetup;
use crate::stdio;
use crate::stop::Stop;

/// Plans of the sections that are asked for, in this order.
pub fn sections(choices: &[SectionChoice], setup: &BenchSetup) -> Result<Vec<DrivePlan>, Failure> {
    let (config, line) = (&setup.config.content, &setup.line.content);
    let mut plans = Vec::new();
    for choice in choices {
        for section in choice.numbers(line)? {
            let plan = DrivePlan::new(config, line, setup.train.clone(), section, None);
            plans.push(
                plan.map_err(|error| Failure::usage(DriveTrouble::NoPlan(error.to_string())))?,
            );
        }
    }
    Ok(plans)
}

/// Drives the sections one after the other and returns to the depot. A section at whose end the train did not stop by
/// itself is the last.
pub fn drive(
    plans: &[DrivePlan],
    aboard: &mut UnitAboard,
    setup: &BenchSetup,
    stop: &Stop,
) -> Result<(), Failure> {
    if plans.is_empty() {
        return Ok(());
    }
    let broke = |why| Failure::bench(Trouble::Link(why));
    for plan in plans {
        if !stop.may_begin() {
            break;
        }
        let arrival = aboard.drive(plan.clone()).map_err(broke)?;
        stdio::note(&told(&arrival));
        if !arrival.stopped() {
            stdio::note("the service ends here");
            break;
        }
    }
    aboard.return_to_depot().map_err(broke)?;
    let (line, driven_s) = (&setup.line.name, aboard.now().as_secs());
    stdio::note(&format!(
        "service on line {line} is over after {driven_s:.0} s of the train's time"
    ));
    Ok(())
}

/// Sentence for people that says how a section ended.
fn told(arrival: &Arrival) -> String {
    let outcome = &arrival.outcome;
    let time = outcome
        .metrics
        .as_ref()
        .map_or_else(String::new, |metrics| {
            format!(" after {:.0} s", metrics.run_time_s)
        });
    let place = outcome.stop_error_m.map_or_else(String::new, |error_m| {
        let side = if error_m > 0.0 { "past" } else { "before" };
        format!(", {:.2} m {side} the stop point", error_m.abs())
    });
    let doors = match arrival.doors {
        Doors::Opened => "doors opened and closed",
        Doors::NotEnabled => "doors closed, none was enabled",
    };
    let (section, ending) = (arrival.section, &outcome.ending);
    format!("section {section}: {ending}{time}{place}; {doors}")
}
