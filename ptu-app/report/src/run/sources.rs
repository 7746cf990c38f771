//! Sources of a run's limits, numbered, so that a row has room for the number of a source.

use btu_rig::procedure::origin::{SEPARATOR, SourceKind};
use fault_db::StepRecord;

use super::block::{Align, Block, Cell, Column, Row, RowKind, Table, Tone};
use crate::naming;
use crate::words::{Words, fill};

/// The sources of a run's limits in the order in which they come.
pub struct Sources<'a>(Vec<&'a str>);

impl<'a> Sources<'a> {
    pub fn of(steps: &'a [StepRecord]) -> Self {
        let mut all = Vec::new();
        for step in steps {
            let measured = step.measurements.iter().map(|m| &m.limit_source);
            for source in [&step.limit_source].into_iter().chain(measured).flatten() {
                if !all.contains(&source.as_str()) {
                    all.push(source);
                }
            }
        }
        Self(all)
    }

    /// The number under which a source is listed; empty where none is given.
    pub fn number(&self, source: Option<&str>) -> String {
        let place = source.and_then(|source| self.0.iter().position(|one| *one == source));
        place.map_or_else(String::new, |place| (place + 1).to_string())
    }

    pub fn blocks(&self, words: &Words) -> Vec<Block> {
        if self.0.is_empty() {
            return Vec::new();
        }
        let report = &words.report;
        let row = |(number, source): (usize, &&str)| {
            let cells = [number.to_string(), in_words(source, words)];
            Row::new(
                RowKind::Detail,
                cells.map(|text| Cell::Text(Tone::Plain, text)),
            )
        };
        vec![
            Block::Heading(report.limit_sources.into()),
            Block::Table(Table {
                columns: vec![
                    Column::new(report.source_number, 0.08, Align::Right),
                    Column::new(report.limit_source, 0.92, Align::Left),
                ],
                rows: (1..).zip(&self.0).map(row).collect(),
            }),
        ]
    }
}

/// The sources of a limit in the language of the sheet.
pub fn in_words(sources: &str, words: &Words) -> String {
    let report = &words.report;
    let one = |source: &str| {
        let Some((kind, key)) = SourceKind::split(source) else {
            return source.to_owned();
        };
        let said = match kind {
            SourceKind::Paper => return source.to_owned(),
            SourceKind::Configuration => report.from_configuration,
            SourceKind::Track => report.from_track,
            SourceKind::Train => report.from_train,
            SourceKind::Measurement => report.from_measurement,
            SourceKind::Standard => report.from_standard,
            SourceKind::Unit => report.from_unit,
            SourceKind::Default if key.is_empty() => report.by_default,
            SourceKind::Default => report.by_default_because,
        };
        // A measurement is named after its step.
        let named = match key
            .rsplit_once('/')
            .filter(|_| kind == SourceKind::Measurement)
        {
            Some((step, name)) => {
                format!(
                    "{}/{}",
                    words.content(step),
                    naming::measurement(name, words)
                )
            }
            None => words.content(key).into_owned(),
        };
        fill(said, &[("key", &named)])
    };
    let all: Vec<_> = sources.split(SEPARATOR).map(one).collect();
    all.join(SEPARATOR)
}
