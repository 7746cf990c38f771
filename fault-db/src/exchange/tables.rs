//! The replicated tables: their columns, how their rows are read from a file, and what each side does with them besides
//! inserting. `statements` makes the SQL from these declarations.

use super::checksum::checksum;
use super::columns::{Column, Kind, columns};
use crate::backend::Value;
use crate::exchange::domain::check_body;
use crate::history::withdrawal::check_parents;
use crate::values::record::StepKind;

pub(super) struct Table {
    pub of: TableId,
    pub name: &'static str,
    /// The columns that both sides have. A parent is named by its identity, not by its row number.
    pub columns: &'static [Column],
    /// Columns that the sender computes for a server; in a file triggers compute them.
    pub derived: &'static [Column],
    /// Index of the column by which messages name a row.
    pub shown: usize,
    /// The column by which rows of a change set are selected in a file, and the order of the rows.
    pub by: &'static str,
    pub order: &'static str,
    /// Whether a row outside its domain is refused alone; otherwise all that is read with it is refused.
    pub is_refused_alone: bool,
    /// Checks a row's content beyond the domain of each column.
    pub check: fn(&[Value<'_>]) -> Result<(), String>,
    /// Whether rows are inserted; rows of the other tables only say what to change.
    pub is_inserted: bool,
    /// SQL: further columns in a file, with their values. `{column}` stands for the row's value.
    pub file_more: &'static [(&'static str, &'static str)],
    /// SQL condition: rows that meet it are not inserted into a file.
    pub file_unless: &'static str,
    /// SQL that completes a row which the file has already.
    pub file_complete: &'static str,
    /// SQL: further columns on a server, with their values. `{rows}` stands for the rows sent, as `x`; `{laptop}` for
    /// the laptop.
    pub server_more: &'static [(&'static str, &'static str)],
    /// SQL condition: rows that meet it are not inserted on a server.
    pub server_unless: &'static str,
    /// SQL statements after the insert on a server.
    pub server_after: &'static [&'static str],
}

/// The replicated tables, in the order of [`TABLES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[rustfmt::skip]
pub(super) enum TableId {
    Unit, Run, Fault, Alias, Script, Step, Measurement, Recording, Occurrence, Event, Note, ChannelSet,
    Trace, Shown,
    /// Seals are applied separately, after the rows that they cover.
    Seal,
}

pub(super) const COUNT: usize = 15;

impl TableId {
    pub fn table(self) -> &'static Table {
        &TABLES[self as usize]
    }
}

const TABLE: Table = Table {
    of: TableId::Unit,
    name: "",
    columns: &[],
    derived: &[],
    shown: 0,
    by: "seq",
    order: "seq",
    is_refused_alone: false,
    check: |_| Ok(()),
    is_inserted: true,
    file_more: &[],
    file_unless: "",
    file_complete: "",
    server_more: &[],
    server_unless: "",
    server_after: &[],
};

/// The replicated tables, parents before children.
pub(super) static TABLES: [Table; COUNT] = [
    Table {
        of: TableId::Unit,
        name: "unit",
        columns: columns![serial Text, kind Text, config_name Text, sw_versions Text],
        derived: &[Column {
            name: "seen_at_us",
            kind: Kind::Integer,
            value: "coalesce((SELECT max(started_at_us) FROM run
                WHERE run.unit = t.seq AND started_at_us BETWEEN 0 AND 7258118400000000), 0)",
        }],
        server_unless: "EXISTS (SELECT 1 FROM unit u WHERE u.serial = x.serial)",
        server_after: &["SELECT know_units(array_agg(x.serial), array_agg(x.kind),
            array_agg(x.config_name), array_agg(x.sw_versions), array_agg(x.seen_at_us))
            FROM {rows}"],
        ..TABLE
    },
    Table {
        of: TableId::Run,
        name: "run",
        columns: columns![
            id Bytes, unit Unit, line Text, seed Integer, operator Text, source Text,
            started_at_us Integer, finished_at_us Integer, verdict Text, bench_time_us Integer,
            wall_time_us Integer, app_version Text, scripts_sha256 Text, unit_config_sha256 Text,
            injected Text, owner Text, train Text, unit_kind Text, unit_config_name Text,
            sw_versions Text, continues Bytes, connection Text, symptom Text,
            evidence Text,
        ],
        // The run was copied earlier, while it was still running.
        file_complete: "UPDATE run SET finished_at_us = {finished_at_us}, verdict = {verdict},
                bench_time_us = {bench_time_us}, wall_time_us = {wall_time_us}
            WHERE id = {id} AND verdict IS NULL AND {verdict} IS NOT NULL",
        server_more: &[("laptop", "{laptop}")],
        server_after: &["SELECT end_runs(array_agg(x.id), array_agg(x.verdict),
            array_agg(x.finished_at_us), array_agg(x.bench_time_us), array_agg(x.wall_time_us))
            FROM {rows}"],
        ..TABLE
    },
    // A fault is known under its id or an alias. Faults that turn out to be one are merged after the events, as one of
    // these may have closed a fault.
    Table {
        of: TableId::Fault,
        name: "fault",
        columns: columns![
            id Bytes, unit Unit, code Integer, code_name Text, lru Text, severity Text, state Text,
            first_at_us Integer, last_at_us Integer, line Text,
        ],
        file_more: &[("occurrences", "0")],
        file_unless: "EXISTS (SELECT 1 FROM fault_alias WHERE id = {id})",
        server_unless: "EXISTS (SELECT 1 FROM fault_alias a WHERE a.id = x.id)",
        server_after: &[
            "INSERT INTO laptop_fault(laptop, id, fault, fresh)
             SELECT {laptop}, x.id, coalesce(f.seq, a.fault), 1 FROM {rows}
                LEFT JOIN fault f ON f.id = x.id LEFT JOIN fault_alias a ON a.id = x.id
             ON CONFLICT DO NOTHING",
            "SELECT name_faults({laptop}, array_agg(x.id), array_agg(x.code_name),
                array_agg(x.severity), array_agg(x.last_at_us)) FROM {rows}",
        ],
        ..TABLE
    },
    Table {
        of: TableId::Alias,
        name: "fault_alias",
        columns: columns![fault Fault, id Bytes],
        shown: 1,
        by: "fault",
        order: "id",
        is_refused_alone: true,
        is_inserted: false,
        server_after: &[
            "INSERT INTO fault_alias(id, fault)
             SELECT DISTINCT ON (x.fault) x.fault, coalesce(f.seq, a.fault) FROM {rows}
                LEFT JOIN fault f ON f.id = x.id LEFT JOIN fault_alias a ON a.id = x.id
             WHERE coalesce(f.seq, a.fault) IS NOT NULL
                AND NOT EXISTS (SELECT 1 FROM fault g WHERE g.id = x.fault)
             ORDER BY x.fault, x.sent_at ON CONFLICT DO NOTHING",
            "INSERT INTO fault_alias(id, fault)
             SELECT x.id, k.fault FROM {rows}
                JOIN laptop_fault k ON k.laptop = {laptop} AND k.id = x.fault
             WHERE NOT EXISTS (SELECT 1 FROM fault g WHERE g.id = x.id)
             ORDER BY x.sent_at ON CONFLICT DO NOTHING",
        ],
        ..TABLE
    },
    Table {
        of: TableId::Script,
        name: "run_script",
        columns: columns![run Run, path Text, sha256 Text],
        shown: 1,
        by: "run",
        order: "path",
        ..TABLE
    },
    Table {
        of: TableId::Step,
        name: "step",
        columns: columns![
            run Run, step_index Integer, procedure Text, kind Text, place Integer, name Text, turn Integer,
            turns Integer, verdict Text, started_bench_us Integer, bench_time_us Integer, message Text, findings Text, script_line Integer,
            limit_source Text,
        ],
        shown: 1,
        by: "run",
        order: "step_index",
        check: |row| match &row[3] {
            Value::Text(kind) => {
                let known = kind.parse::<StepKind>().map(drop);
                known.map_err(|_| "kind is no word that is known".to_owned())
            }
            _ => Ok(()),
        },
        ..TABLE
    },
    Table {
        of: TableId::Measurement,
        name: "measurement",
        columns: columns![
            run Run, step_index Integer, ordinal Integer, name Text, value Real, unit Text, low Real,
            high Real, verdict Text, limit_source Text,
        ],
        shown: 1,
        by: "run",
        order: "step_index, t.ordinal",
        ..TABLE
    },
    Table {
        of: TableId::Recording,
        name: "recording",
        columns: columns![
            run Run, ordinal Integer, procedure Text, t0_bench_us Integer, bench_json Text,
            stimuli Bytes,
        ],
        shown: 1,
        by: "run",
        order: "ordinal",
        is_refused_alone: true,
        ..TABLE
    },
    Table {
        of: TableId::Occurrence,
        name: "fault_occurrence",
        columns: columns![
            id Bytes, fault Fault, run Run, step_index Integer, at_us Integer, bench_us Integer,
            message Text, findings Text, freeze_json Text, code Integer, lru Text, line Text, code_name Text,
            severity Text,
        ],
        by: "run",
        file_more: &[("unit", "(SELECT unit FROM run WHERE id = {run})")],
        server_more: &[("unit", "run.unit")],
        ..TABLE
    },
    Table {
        of: TableId::Event,
        name: "fault_event",
        columns: columns![
            id Bytes, fault Fault, kind Text, at_us Integer, who Text, body Text, state Text,
            turn Integer, follows Bytes, seen Integer,
        ],
        derived: &[
            Column {
                name: "part",
                kind: Kind::Text,
                value: "server_part(t.kind, t.body)",
            },
            Column {
                name: "words",
                kind: Kind::Text,
                value: "server_event_words(t.kind, t.body)",
            },
        ],
        is_refused_alone: true,
        check: |row| match (&row[2], &row[5]) {
            (Value::Text(kind), Value::Text(body)) => {
                check_body(kind, body).and_then(|()| check_parents(kind, &row[6], &row[8]))
            }
            _ => Ok(()),
        },
        server_more: &[
            ("laptop", "{laptop}"),
            ("part", "x.part"),
            ("words", "CAST(x.words AS tsvector)"),
        ],
        ..TABLE
    },
    Table {
        of: TableId::Note,
        name: "run_note",
        columns: columns![
            id Bytes, run Run, at_us Integer, who Text, trace Bytes, place_us Integer, text Text,
        ],
        derived: &[Column {
            name: "words",
            kind: Kind::Text,
            value: "server_note_words(t.text)",
        }],
        is_refused_alone: true,
        server_more: &[("words", "CAST(x.words AS tsvector)")],
        ..TABLE
    },
    Table {
        of: TableId::ChannelSet,
        name: "channel_set",
        columns: columns![sha256 Bytes, json Text],
        check: |row| checksum(&row[0], &row[1]),
        server_unless: "EXISTS (SELECT 1 FROM channel_set c WHERE c.sha256 = x.sha256)",
        ..TABLE
    },
    Table {
        of: TableId::Trace,
        name: "trace",
        columns: columns![
            id Bytes, run Run, t0_bench_us Integer, t0_us Integer, period_us Integer,
            row_count Integer, trigger_row Integer, flags Integer, channel_set ChannelSet,
            encoding Integer, sha256 Bytes, data Bytes, recording Integer,
        ],
        is_refused_alone: true,
        check: |row| checksum(&row[10], &row[11]),
        // The trace was copied earlier, while its procedure was still running.
        file_complete: "UPDATE trace SET recording = {recording} WHERE id = {id} AND recording IS NULL",
        ..TABLE
    },
    // Links each trace to the occurrences that it shows: a trace may come after them.
    Table {
        of: TableId::Shown,
        name: "fault_occurrence",
        columns: columns![id Bytes, trace Trace],
        by: "trace",
        is_refused_alone: true,
        is_inserted: false,
        file_complete:
            "UPDATE fault_occurrence SET trace = (SELECT seq FROM trace WHERE id = {trace})
            WHERE id = {id} AND trace IS NULL",
        server_after: &["SELECT show_traces(array_agg(x.id), array_agg(x.trace)) FROM {rows}"],
        ..TABLE
    },
    Table {
        of: TableId::Seal,
        name: "seal",
        columns: columns![
            origin Bytes, ordinal Integer, what Text, id Bytes, says Text, digest Bytes,
            hash Bytes,
        ],
        by: "origin",
        order: "ordinal",
        ..TABLE
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_stands_at_its_number() {
        for (place, table) in TABLES.iter().enumerate() {
            assert_eq!(table.of as usize, place, "{}", table.name);
        }
    }

    #[test]
    fn the_checks_look_at_the_columns_they_mean() {
        let names = |of: TableId| -> Vec<_> { of.table().columns.iter().map(|c| c.name).collect() };
        assert_eq!(
            [2, 5, 6, 8].map(|n| names(TableId::Event)[n]),
            ["kind", "body", "state", "follows"]
        );
        assert_eq!(
            [10, 11].map(|n| names(TableId::Trace)[n]),
            ["sha256", "data"]
        );
        assert_eq!(names(TableId::ChannelSet), ["sha256", "json"]);
    }
}
