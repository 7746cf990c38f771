//! Table of steps that were tested twice: values before and after with limits, and the change between two runs.

use fault_db::{MeasurementRecord, StepRecord, Verdict};
use ptu_runs::stored::outside_of;

use super::{Compared, StepPair};
use crate::limits::short;
use crate::naming;
use crate::run::block::{Align, Cell, Column, Gauge, Row, RowKind, Table, Tone};
use crate::run::steps::verdict;
use crate::words::{Words, fill};

/// Table of the failed checks of a case: a row for each value beyond its limits, or for the step.
pub fn comparison(compared: &[Compared<'_>], words: &Words) -> Table {
    let (common, report) = (&words.common, &words.report);
    let procedure = |one: &Compared<'_>| one.step().map(|step| step.procedure.clone());
    let mut pairs = compared.windows(2);
    let is_of_several = pairs.any(|two| procedure(&two[0]) != procedure(&two[1]));
    let rows = compared.iter().filter_map(|one| {
        let step = one.step()?;
        let mut name = name_of(step, words);
        if is_of_several {
            name = format!("{}: {name}", step.procedure);
        }
        if let Some(measured) = one.measured() {
            name = format!("{name}\n{}", naming::measurement(&measured.name, words));
        }
        Some(Row::new(RowKind::Head, cells(one, name, words)))
    });
    Table {
        columns: vec![
            Column::new(report.step_or_measurement, 0.31, Align::Left),
            Column::new(report.allowed, 0.15, Align::Left),
            Column::new(report.before, 0.1, Align::Right),
            Column::new("", 0.125, Align::Left),
            Column::new(report.after, 0.1, Align::Right),
            Column::new("", 0.125, Align::Left),
            Column::new(common.verdict, 0.09, Align::Left),
        ],
        rows: rows.collect(),
    }
}

/// Steps of two runs, each with its measurements below it.
pub(super) fn steps<'a>(pairs: impl Iterator<Item = &'a StepPair<'a>>, words: &Words) -> Table {
    let (common, report) = (&words.common, &words.report);
    let mut rows = Vec::new();
    for pair in pairs {
        let Some(step) = pair.step.step() else {
            continue;
        };
        let name = format!("{}: {}", step.procedure, name_of(step, words));
        let mut with_change = |kind, one: &Compared<'_>, name| {
            let mut cells = Vec::from(cells(one, name, words));
            let change = change(one).unwrap_or_default();
            cells.insert(6, Cell::Text(Tone::Soft, change));
            rows.push(Row::new(kind, cells));
        };
        with_change(RowKind::Head, &pair.step, name);
        for one in &pair.measurements {
            let name = one.measured().map(|m| naming::measurement(&m.name, words));
            let name = name.unwrap_or_default();
            with_change(RowKind::Detail, one, name);
        }
    }
    Table {
        columns: vec![
            Column::new(report.step_or_measurement, 0.27, Align::Left),
            Column::new(report.allowed, 0.15, Align::Left),
            Column::new(report.run_a, 0.11, Align::Right),
            Column::new("", 0.09, Align::Left),
            Column::new(report.run_b, 0.11, Align::Right),
            Column::new("", 0.09, Align::Left),
            Column::new(report.change, 0.09, Align::Right),
            Column::new(common.verdict, 0.09, Align::Left),
        ],
        rows,
    }
}

/// Name, what is allowed, value and bar of each run, and the last verdict.
fn cells(one: &Compared<'_>, name: String, words: &Words) -> [Cell; 7] {
    let plain = |text| Cell::Text(Tone::Plain, text);
    let none = || [plain("–".into()), Cell::Gauge(None)];
    let of_step = |step: Option<&StepRecord>| match step {
        Some(step) => [verdict(step.verdict, words), Cell::Gauge(None)],
        None => none(),
    };
    let [[value_before, bar_before], [value_after, bar_after]] = match one.measured() {
        Some(_) => {
            [one.before, one.after].map(|value| value.map_or_else(none, |m| shown(m, words)))
        }
        None => [one.step_before, one.step_after].map(of_step),
    };
    let last = match one.verdict_after() {
        Some(after) => verdict(after, words),
        None => Cell::Text(Tone::Soft, words.report.not_tested_again.into()),
    };
    [
        plain(name),
        plain(allowed(one, words)),
        value_before,
        bar_before,
        value_after,
        bar_after,
        last,
    ]
}

/// Limits of a measurement as text; both where they changed.
pub(super) fn allowed(one: &Compared<'_>, words: &Words) -> String {
    match [one.before, one.after].map(|value| value.map(|value| limits(value, words))) {
        [Some(then), Some(now)] if now != then => fill(
            words.report.before_then_after,
            &[("before", &then), ("after", &now)],
        ),
        [then, now] => then.or(now).unwrap_or_default(),
    }
}

/// Increase of a value, with its sign.
pub(super) fn change(one: &Compared<'_>) -> Option<String> {
    let change = short(one.change()?);
    Some(match change.as_str() {
        "0" => "0".into(),
        less if less.starts_with('-') => less.replacen('-', "−", 1),
        more => format!("+{more}"),
    })
}

/// A value with its unit.
pub(super) fn value(measured: &MeasurementRecord, words: &Words) -> String {
    match measured.value {
        Some(value) => format!("{} {}", short(value), words.unit(&measured.unit)),
        None => words.report.no_value.to_owned(),
    }
}

/// A value with its unit, and its bar.
fn shown(measured: &MeasurementRecord, words: &Words) -> [Cell; 2] {
    let good = measured.verdict == Verdict::Passed;
    let tone = if good { Tone::Good } else { Tone::Bad };
    let gauge = Gauge::of(measured.value, measured.low, measured.high, good);
    [Cell::Text(tone, value(measured, words)), Cell::Gauge(gauge)]
}

fn limits(measured: &MeasurementRecord, words: &Words) -> String {
    let report = &words.report;
    let unit = &words.unit(&measured.unit);
    match (measured.low.map(short), measured.high.map(short)) {
        (Some(low), Some(high)) => fill(
            report.from_to,
            &[("low", &low), ("high", &high), ("unit", unit)],
        ),
        (Some(low), None) => fill(report.at_least, &[("low", &low), ("unit", unit)]),
        (None, Some(high)) => fill(report.at_most, &[("high", &high), ("unit", unit)]),
        (None, None) => String::new(),
    }
}

pub fn name_of(step: &StepRecord, words: &Words) -> String {
    match outside_of(step) {
        Some(place) => words.common.outside(place).to_owned(),
        None => words.content(&step.name).into_owned(),
    }
}
