//! `ptu faults stats` and `ptu faults trend`: counts, and a measurement over time.

use fault_db::{FaultStat, StatKey, Store, TrendPoint};
use serde_json::json;

use super::By;
use crate::cli::{print_json, print_out};
use crate::clock::{local, rfc3339};
use crate::failure::{Exit, Failure, did_you_mean};
use crate::table::Table;

/// Counts faults by code or part.
pub fn stats(store: &Store, by: By, json: bool) -> Result<Exit, Failure> {
    let key = match by {
        By::Code => StatKey::Code,
        By::Lru => StatKey::Lru,
    };
    let stats = store.stats(key)?;
    if json {
        let entry = |stat: &FaultStat| {
            json!({
                "key": stat.key, "name": stat.name, "faults": stat.faults,
                "not_closed": stat.not_closed, "occurrences": stat.occurrences,
                "units": stat.units, "last_at": rfc3339(stat.last_at_us),
            })
        };
        return print_json(&stats.iter().map(entry).collect::<Vec<_>>());
    }
    let mut table = Table::new(&[
        "KEY",
        "NAME",
        "FAULTS",
        "NOT CLOSED",
        "SEEN",
        "UNITS",
        "LAST SEEN",
    ]);
    for stat in &stats {
        table.row([
            stat.key.clone(),
            stat.name.clone(),
            stat.faults.to_string(),
            stat.not_closed.to_string(),
            stat.occurrences.to_string(),
            stat.units.to_string(),
            local(stat.last_at_us),
        ]);
    }
    print_out(&table.render())
}

/// Shows a measurement over time.
pub fn trend(
    store: &Store,
    measurement: &str,
    unit: Option<&str>,
    json: bool,
) -> Result<Exit, Failure> {
    let names = store.measurement_names()?;
    if !names.iter().any(|name| name == measurement) {
        let hint = did_you_mean(measurement, names.iter().map(String::as_str));
        return Err(Failure::usage(format!(
            "no measurement \"{measurement}\" recorded{hint}; `ptu run --list` shows what is measured"
        )));
    }
    let points = store.trend(measurement, unit)?;
    if let Some(unit) = unit.filter(|_| points.is_empty()) {
        return Err(Failure::usage(format!(
            "no measurement \"{measurement}\" of unit {unit} recorded; `ptu runs list` shows the units"
        )));
    }
    if json {
        let entry = |point: &TrendPoint| {
            json!({
                "at": rfc3339(point.at_us), "run_id": point.run_id.to_string(),
                "unit_serial": point.unit_serial, "value": point.value, "unit": point.unit,
                "low": point.low, "high": point.high, "verdict": point.verdict.as_str(),
            })
        };
        return print_json(&points.iter().map(entry).collect::<Vec<_>>());
    }
    let mut table = Table::new(&["AT", "UNIT", "VALUE", "LOW", "HIGH", "VERDICT"]);
    let number = |value: Option<f64>| value.map_or_else(|| "-".into(), |v| format!("{v:.2}"));
    for point in &points {
        table.row([
            local(point.at_us),
            point.unit_serial.clone(),
            format!("{} {}", number(point.value), point.unit),
            number(point.low),
            number(point.high),
            point.verdict.as_str().into(),
        ]);
    }
    print_out(&table.render())
}
