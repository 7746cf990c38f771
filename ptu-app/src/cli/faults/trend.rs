//! `ptu faults trend`: a measurement over time, and when it will reach its limit.

use std::path::PathBuf;

use clap::Args;
use fault_db::{Store, TrendDay, TrendQuery};
use serde_json::{Value, json};

use super::filter::is_part;
use super::{trend_plot, trend_text};
use crate::cli::output::{Output, keys};
use crate::cli::{ScriptsOption, at_least_one, check_unit};
use ptu_report::trend::{TimeSeries, Trend};
use ptu_report::words::Words;
use ptu_runs::clock::{Span, rfc3339, utc_day};
use ptu_runs::failure::{Asked, Exit, Failure, Near, OfUnit, did_you_mean};
use ptu_runs::new_file::kind;
use ptu_runs::whole_file;

/// Show a measurement over time: of one unit value by value, of all units month by month
///
/// With the drift, control limits (3 sigma), capability (Cp, Cpk), and when the measurement will cross the limit it
/// drifts towards. Sigma of a unit is the scatter from one value to the next (moving range), sigma of a fleet the
/// scatter within days.
///
/// Examples:
///   ptu faults trend eb_reaction --procedure atp/overspeed
///   ptu faults trend eb_reaction --step "code 55: alarm, FSB, EB"
///   ptu faults trend eb_reaction --serial-no SG-0142 --when 180d --plot creep.html
///   ptu faults trend eb_reaction --serial-no SG-0142 --since-repair eb_relay
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct TrendArguments {
    /// The measurement's name
    measurement: String,
    /// Only of this unit (serial number)
    #[arg(long, value_name = "TEXT")]
    serial_no: Option<String>,
    /// Only as measured by this procedure; other procedures may have other limits
    #[arg(long, value_name = "PROCEDURE")]
    procedure: Option<String>,
    /// Only as measured by this step; without it, values of steps with different limits are shown without limits
    #[arg(long, value_name = "STEP")]
    step: Option<String>,
    /// Only on this line
    #[arg(long, value_name = "NAME")]
    line: Option<String>,
    /// Only of units in this train
    #[arg(long, value_name = "TEXT")]
    train_no: Option<String>,
    /// Only values of this time: 30d, today, 2026-03, 2026-03..2026-05, 2026-03-21..
    #[arg(long, value_name = "SPAN", allow_hyphen_values = true)]
    when: Option<Span>,
    /// Only since the last repair of this part of the unit
    #[arg(
        long,
        value_name = "PART",
        requires = "serial_no",
        conflicts_with = "when"
    )]
    since_repair: Option<String>,
    /// At most N values, months or units in a table: the latest values and months, the units farthest off
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = at_least_one())]
    limit: u32,
    /// Draw the measurement on a page, too
    #[arg(long, value_name = "FILE.html", value_parser = page_file)]
    plot: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl TrendArguments {
    pub fn trend(&self, store: &Store) -> Result<Exit, Failure> {
        let trend = self.read(store)?;
        self.output.save()?;
        if let Some(file) = &self.plot {
            whole_file::write(file, kind::HTML, trend_plot::page(&trend))?;
        }
        if self.output.form.is_json() {
            return crate::cli::print_json(&json(&trend));
        }
        let rows = rows(&trend);
        let columns = rows.first().map_or(OF_DAYS.to_vec(), keys);
        self.output.form.print_columns(&columns, &rows, || {
            trend_text::text(&trend, self.limit as usize)
        })
    }

    fn read(&self, store: &Store) -> Result<Trend, Failure> {
        let names = store.measurement_names()?;
        if !names.contains(&self.measurement) {
            let hint = did_you_mean(&self.measurement, names.iter().map(String::as_str));
            return Err(Failure::usage(Asked::MeasurementNever(
                self.measurement.to_string(),
                hint,
            )));
        }
        if let Some(unit) = &self.serial_no {
            check_unit(store, unit)?;
        }
        let procedures = store.measuring_procedures(&self.measurement)?;
        let span = self.when.unwrap_or_default();
        let mut query = TrendQuery {
            measurement: self.measurement.clone(),
            unit: self.serial_no.clone(),
            line: self.line.clone(),
            train: self.train_no.clone(),
            procedure: self.procedure.clone(),
            step: self.step.clone(),
            since_us: span.since_us,
            until_us: span.until_us,
        };
        if let (Some(unit), Some(part)) = (&self.serial_no, &self.since_repair) {
            let repaired = store.last_repair(unit, part)?;
            query.since_us = Some(match repaired {
                Some(at_us) => at_us,
                None => return Err(never_repaired(store, &self.scripts, unit, part)?),
            });
        }
        match Trend::read(store, query.clone())? {
            Some(trend) => Ok(trend),
            None => Err(Failure::usage(self.nothing(store, &query, &procedures)?)),
        }
    }

    /// Reason why no value was found: another procedure or step measures it, it was measured at another time, or never
    /// on such units.
    fn nothing(
        &self,
        store: &Store,
        query: &TrendQuery,
        procedures: &[String],
    ) -> Result<Asked, Failure> {
        let (name, unit) = (self.measurement.clone(), OfUnit(self.serial_no.clone()));
        if let Some(procedure) = self.procedure.as_ref().filter(|p| !procedures.contains(p)) {
            let others = procedures.join(", ");
            return Ok(Asked::MeasuredBy(name, unit, procedure.clone(), others));
        }
        if let Some(step) = &self.step {
            let known = store.trend_steps(&TrendQuery {
                step: None,
                ..query.clone()
            })?;
            let known = || known.iter().map(|known| known.step.as_str());
            if !known().any(|known| known == step) && known().next().is_some() {
                let hint = did_you_mean(step, known());
                return Ok(Asked::MeasuredInNo(name, unit, step.clone(), hint));
            }
        }
        let span = Span {
            since_us: query.since_us,
            until_us: query.until_us,
        };
        if span != Span::default() {
            let days = store.trend_by_day(&TrendQuery {
                since_us: None,
                until_us: None,
                ..query.clone()
            })?;
            if let (Some(first), Some(last)) = (days.first(), days.last()) {
                return Ok(Asked::MeasuredFrom(
                    name,
                    unit,
                    Words::shown().span(span),
                    utc_day(first.day_us).to_string(),
                    utc_day(last.day_us).to_string(),
                ));
            }
        }
        Ok(Asked::NotMeasured(name, unit))
    }
}

/// Parses the file name of a page, which must end in .html or .htm: browsers tell a page by its ending.
fn page_file(text: &str) -> Result<PathBuf, String> {
    let file = PathBuf::from(text);
    let ending = file.extension().and_then(|ending| ending.to_str());
    match ending.map(str::to_ascii_lowercase).as_deref() {
        Some("html" | "htm") => Ok(file),
        _ => Err("a trend is drawn on a page, in a file that ends in .html".to_owned()),
    }
}

/// Columns of a fleet's answer, also where nothing could be measured on any day.
const OF_DAYS: [&str; 6] = ["day", "n", "mean", "least", "most", "not_passed"];

/// Rows of the answer: one for each value of a unit, or for each day of a fleet.
fn rows(trend: &Trend) -> Vec<Value> {
    match &trend.course {
        TimeSeries::Points(points) => points
            .iter()
            .map(|point| {
                json!({
                    "at": rfc3339(point.at_us), "run_id": point.run_id.to_string(),
                    "unit_serial": point.unit_serial, "value": point.value, "unit": point.unit,
                    "low": point.low, "high": point.high, "verdict": point.verdict.as_str(),
                })
            })
            .collect(),
        TimeSeries::Days(days, _) => days.iter().map(row_of_day).collect(),
    }
}

fn row_of_day(day: &TrendDay) -> Value {
    json!({
        "day": rfc3339(day.day_us), "n": day.n, "mean": day.mean,
        "least": day.least, "most": day.most, "not_passed": day.not_passed,
    })
}

fn json(trend: &Trend) -> Value {
    let mut value = json!({
        "measurement": trend.query.measurement, "unit": trend.limits.unit,
        "low": trend.limits.low, "high": trend.limits.high, "procedures": trend.procedures,
        "steps": trend.steps,
    });
    match &trend.course {
        TimeSeries::Points(_) => value["points"] = rows(trend).into(),
        TimeSeries::Days(_, units) => {
            value["days"] = rows(trend).into();
            value["units"] = json!(units);
        }
    }
    let (low, high) = (trend.limits.low, trend.limits.high);
    let process = trend.process.as_ref();
    value["capability"] = json!(process.and_then(|process| process.capability(low, high)));
    value["forecast"] = process
        .and_then(|process| process.forecast(low, high))
        .map_or(Value::Null, |forecast| {
            json!({
                "limit": forecast.limit, "at": rfc3339(forecast.at_us),
                "earliest": rfc3339(forecast.earliest_us),
                "latest": forecast.latest_us.map(rfc3339),
            })
        });
    value["process"] = process.map_or(Value::Null, |process| {
        let mut value = json!(process);
        value["signs"] = process
            .signs
            .iter()
            .map(|sign| {
                json!({
                    "kind": sign.kind, "times": sign.times,
                    "first_at": rfc3339(sign.first_at_us), "last_at": rfc3339(sign.last_at_us),
                })
            })
            .collect();
        value
    });
    value
}

/// Refusal: the unit has no repair of this part; names the nearest part if no part has this name.
fn never_repaired(
    store: &Store,
    scripts: &ScriptsOption,
    unit: &str,
    part: &str,
) -> Result<Failure, Failure> {
    let known = store.known_parts()?;
    let is_known = known.iter().any(|known| known.eq_ignore_ascii_case(part));
    let hint = match is_known || is_part(scripts, part) {
        true => Near::default(),
        false => did_you_mean(part, known.iter().map(String::as_str)),
    };
    Ok(Failure::usage(Asked::RepairNever(
        part.to_string(),
        unit.to_string(),
        hint,
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fleet_without_a_value_has_the_columns_of_its_days() {
        let day = TrendDay {
            day_us: 0,
            n: 1,
            mean: 0.0,
            sum_of_squares: 0.0,
            least: 0.0,
            most: 0.0,
            not_passed: 0,
        };
        assert_eq!(keys(&row_of_day(&day)), OF_DAYS);
    }
}
