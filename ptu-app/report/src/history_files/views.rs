//! The views that are exported, and the type of each column: the same in every partition, whatever rows it has.

/// The type of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Whole,
    Number,
    Text,
}

pub(super) struct View {
    pub name: &'static str,
    /// Column of the time, µs since 1970; absent where the rows have no time.
    pub time: Option<&'static str>,
    /// Column of the time as text, of which the month is taken.
    pub label: &'static str,
    /// Order of its rows, complete; the first column tells the rows of one history from those of another.
    pub order: &'static str,
    /// Rows are added to it, and none of them ever changes.
    pub is_final: bool,
    pub columns: &'static [(&'static str, Kind)],
}

use Kind::{Number, Text, Whole};

/// All of them: what `fault-db/VIEWS.md` describes.
pub(super) const VIEWS: &[View] = &[
    View {
        name: "runs",
        time: Some("started_at_us"),
        label: "started_at",
        order: "id",
        is_final: false,
        columns: &[
            ("id", Text),
            ("unit", Text),
            ("kind", Text),
            ("line", Text),
            ("train", Text),
            ("operator", Text),
            ("source", Text),
            ("connection", Text),
            ("symptom", Text),
            ("started_at", Text),
            ("finished_at", Text),
            ("verdict", Text),
            ("bench_time_s", Number),
            ("injected", Text),
            ("app_version", Text),
            ("continues", Text),
            ("started_at_us", Whole),
        ],
    },
    View {
        name: "steps",
        time: Some("started_at_us"),
        label: "started_at",
        order: "run_id, step_index",
        is_final: true,
        columns: &[
            ("run_id", Text),
            ("unit", Text),
            ("step_index", Whole),
            ("procedure", Text),
            ("kind", Text),
            ("name", Text),
            ("turn", Whole),
            ("turns", Whole),
            ("verdict", Text),
            ("message", Text),
            ("findings", Text),
            ("bench_time_s", Number),
            ("script_line", Whole),
            ("limit_source", Text),
            ("started_at", Text),
            ("started_at_us", Whole),
        ],
    },
    View {
        name: "measurements",
        time: Some("started_at_us"),
        label: "started_at",
        order: "run_id, step_index, name, value",
        is_final: true,
        columns: &[
            ("run_id", Text),
            ("unit", Text),
            ("procedure", Text),
            ("step", Text),
            ("step_index", Whole),
            ("name", Text),
            ("value", Number),
            ("measured_in", Text),
            ("low", Number),
            ("high", Number),
            ("verdict", Text),
            ("limit_source", Text),
            ("started_at", Text),
            ("started_at_us", Whole),
        ],
    },
    View {
        name: "faults",
        time: Some("first_at_us"),
        label: "first_at",
        order: "id",
        is_final: false,
        columns: &[
            ("id", Text),
            ("unit", Text),
            ("code", Whole),
            ("name", Text),
            ("lru", Text),
            ("cause", Text),
            ("severity", Text),
            ("state", Text),
            ("line", Text),
            ("occurrences", Whole),
            ("repairs", Whole),
            ("first_at", Text),
            ("last_at", Text),
            ("closed_at", Text),
            ("first_at_us", Whole),
            ("last_at_us", Whole),
            ("closed_at_us", Whole),
        ],
    },
    View {
        name: "occurrences",
        time: Some("at_us"),
        label: "seen_at",
        order: "id",
        is_final: false,
        columns: &[
            ("id", Text),
            ("fault_id", Text),
            ("run_id", Text),
            ("unit", Text),
            ("code", Whole),
            ("name", Text),
            ("lru", Text),
            ("line", Text),
            ("train", Text),
            ("step_index", Whole),
            ("message", Text),
            ("findings", Text),
            ("seen_at", Text),
            ("at_us", Whole),
        ],
    },
    View {
        name: "events",
        time: Some("at_us"),
        label: "happened_at",
        order: "id",
        is_final: false,
        columns: &[
            ("id", Text),
            ("fault_id", Text),
            ("kind", Text),
            ("who", Text),
            ("text", Text),
            ("state", Text),
            ("withdrawn", Whole),
            ("turn", Whole),
            ("happened_at", Text),
            ("at_us", Whole),
        ],
    },
    View {
        name: "repairs",
        time: Some("at_us"),
        label: "repaired_at",
        order: "fault_id, at_us, part",
        is_final: false,
        columns: &[
            ("fault_id", Text),
            ("unit", Text),
            ("code", Whole),
            ("lru", Text),
            ("line", Text),
            ("part", Text),
            ("serial_old", Text),
            ("serial_new", Text),
            ("note", Text),
            ("who", Text),
            ("opened_at", Text),
            ("repaired_at", Text),
            ("back_at", Text),
            ("days_to_repair", Number),
            ("days_until_back", Number),
            ("at_us", Whole),
        ],
    },
    View {
        name: "traces",
        time: Some("t0_us"),
        label: "began_at",
        order: "id",
        is_final: false,
        columns: &[
            ("id", Text),
            ("run_id", Text),
            ("unit", Text),
            ("began_at", Text),
            ("row_count", Whole),
            ("period_ms", Number),
            ("size_bytes", Whole),
            ("partial", Whole),
            ("gaps", Whole),
            ("t0_us", Whole),
        ],
    },
    View {
        name: "units",
        time: None,
        label: "",
        order: "serial, kind",
        is_final: false,
        columns: &[
            ("serial", Text),
            ("kind", Text),
            ("config_name", Text),
            ("sw_versions", Text),
            ("runs", Whole),
            ("faults_not_closed", Whole),
        ],
    },
    View {
        name: "notes",
        time: Some("at_us"),
        label: "noted_at",
        order: "id",
        is_final: false,
        columns: &[
            ("id", Text),
            ("run_id", Text),
            ("unit", Text),
            ("who", Text),
            ("text", Text),
            ("trace_id", Text),
            ("place_s", Number),
            ("noted_at", Text),
            ("at_us", Whole),
        ],
    },
];

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    /// Goal: a column or view that comes to the page of the views comes to the files, too.
    #[test]
    fn all_views_and_columns_of_the_page_are_exported() {
        let mut told = BTreeSet::new();
        let mut view = "";
        for line in fault_db::VIEWS_PAGE.lines() {
            if let Some((name, _)) = line.strip_prefix("## ").and_then(|h| h.split_once(':')) {
                view = name;
            } else if let Some((names, _)) =
                line.strip_prefix("| ").and_then(|row| row.split_once(" |"))
                && names != "column"
            {
                told.extend(names.split(", ").map(|name| format!("{view}.{name}")));
            }
        }
        let columns = |view: &View| {
            let name = view.name;
            let columns = view.columns.iter();
            columns
                .map(|(column, _)| format!("{name}.{column}"))
                .collect::<Vec<_>>()
        };
        let exported: BTreeSet<_> = VIEWS.iter().flat_map(columns).collect();
        assert_eq!(exported, told);
    }
}
