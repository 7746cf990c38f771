//! Steps and their measurements as tables.

use fault_db::{MeasurementRecord, StepRecord, Verdict};

use ptu_runs::stored::uncertainty_of;

use super::block::{Align, Cell, Column, Gauge, Row, RowKind, Table, Tone};
use super::sources::Sources;
use crate::limits::short;
use crate::naming;
use crate::words::Words;

/// Columns of a value: value, unit, low, high.
const MEASURED: usize = 4;

/// Steps, each with its message and measurements below it.
pub fn table<'a>(
    steps: impl IntoIterator<Item = &'a StepRecord>,
    sources: &Sources<'_>,
    words: &Words,
) -> Table {
    let (common, report) = (&words.common, &words.report);
    Table {
        columns: vec![
            Column::new(report.step_or_measurement, 0.31, Align::Left),
            Column::new(common.value, 0.1, Align::Right),
            Column::new(report.unit_of_value, 0.08, Align::Left),
            Column::new(common.low, 0.08, Align::Right),
            Column::new(common.high, 0.08, Align::Right),
            Column::new(report.source_number, 0.05, Align::Right),
            Column::new(report.within, 0.13, Align::Left),
            Column::new(common.verdict, 0.1, Align::Left),
            Column::new(report.seconds, 0.07, Align::Right),
        ],
        rows: steps
            .into_iter()
            .flat_map(|step| rows(step, sources, words))
            .collect(),
    }
}

fn rows(step: &StepRecord, sources: &Sources<'_>, words: &Words) -> Vec<Row> {
    let source = sources.number(step.limit_source.as_deref());
    let plain = |text: String| Cell::Text(Tone::Plain, text);
    let name = words.record(step);
    let mut rows = vec![Row {
        kind: RowKind::Head,
        cells: vec![
            (plain(name), 1 + MEASURED),
            (Cell::Text(Tone::Soft, source), 1),
            (plain(String::new()), 1),
            (verdict(step.verdict, words), 1),
            (plain(format!("{:.1}", step.bench_time_us as f64 / 1e6)), 1),
        ],
    }];
    if !step.message.is_empty() {
        let tone = if passed(step.verdict) {
            Tone::Soft
        } else {
            Tone::Bad
        };
        rows.push(Row {
            kind: RowKind::Detail,
            cells: vec![(
                Cell::Text(
                    tone,
                    words.found(&step.findings, &step.message).into_owned(),
                ),
                5 + MEASURED,
            )],
        });
    }
    let all = &step.measurements;
    let own = all
        .iter()
        .filter(|measurement| !is_uncertainty(measurement, all));
    rows.extend(own.map(|measurement| {
        let source = sources.number(measurement.limit_source.as_deref());
        measured(measurement, uncertainty(measurement, all), source, words)
    }));
    rows
}

fn measured(
    measurement: &MeasurementRecord,
    uncertainty: Option<f64>,
    source: String,
    words: &Words,
) -> Row {
    let MeasurementRecord {
        name,
        value,
        unit,
        low,
        high,
        ..
    } = measurement;
    let soft = |text: String| (Cell::Text(Tone::Soft, text), 1);
    let limit = |limit: &Option<f64>| soft(limit.map_or_else(String::new, short));
    let good = passed(measurement.verdict);
    let tone = if good { Tone::Plain } else { Tone::Bad };
    let value_text = match (value, uncertainty) {
        (None, _) => words.report.no_value.to_owned(),
        (Some(value), None) => short(*value),
        (Some(value), Some(off)) => format!("{} ± {}", short(*value), short(off)),
    };
    Row {
        kind: RowKind::Detail,
        cells: vec![
            soft(naming::measurement(name, words)),
            (Cell::Text(tone, value_text), 1),
            soft(words.unit(unit).to_owned()),
            limit(low),
            limit(high),
            soft(source),
            (Cell::Gauge(Gauge::of(*value, *low, *high, good)), 1),
            (verdict(measurement.verdict, words), 1),
            soft(String::new()),
        ],
    }
}

/// Uncertainty stored beside a measurement.
fn uncertainty(measurement: &MeasurementRecord, all: &[MeasurementRecord]) -> Option<f64> {
    let name = uncertainty_of(&measurement.name);
    all.iter().find(|other| other.name == name)?.value
}

/// The measurement is the uncertainty of another one, with which it is shown.
fn is_uncertainty(measurement: &MeasurementRecord, all: &[MeasurementRecord]) -> bool {
    all.iter()
        .any(|other| uncertainty_of(&other.name) == measurement.name)
}

pub fn verdict(verdict: Verdict, words: &Words) -> Cell {
    Cell::Text(tone(verdict), words.common.stored_verdict(verdict).into())
}

pub fn tone(verdict: Verdict) -> Tone {
    match verdict {
        Verdict::Passed => Tone::Good,
        Verdict::Skipped => Tone::Soft,
        Verdict::Failed | Verdict::Error | Verdict::Inconclusive | Verdict::Aborted => Tone::Bad,
    }
}

/// Whether the verdict says nothing against the unit.
pub fn passed(verdict: Verdict) -> bool {
    matches!(verdict, Verdict::Passed | Verdict::Skipped)
}
