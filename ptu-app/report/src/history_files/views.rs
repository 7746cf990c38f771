//! The views that are exported, and the type of each column: the same in every partition, whatever rows it has.

pub(super) struct View {
    pub name: &'static str,
    /// Column of the time as text, of which the month is taken; absent where the rows have no time.
    pub time: Option<&'static str>,
    /// Columns that order the rows, without ties; the values of the first column differ from one history to another.
    pub order: &'static str,
    /// Rows are added to the view, and a row never changes.
    pub is_final: bool,
    /// Names of the columns, as a question in SQL has them.
    pub columns: &'static str,
}

impl View {
    pub fn columns(&self) -> impl Iterator<Item = &'static str> {
        self.columns.split(", ")
    }
}

/// The type of a column.
pub(super) enum Kind {
    Whole,
    Number,
    Text,
}

impl Kind {
    /// Type of the column of this name, which is the same in all views.
    pub fn of(column: &str) -> Self {
        match column {
            "bench_time_s" | "days_to_repair" | "days_until_back" | "high" | "low"
            | "period_ms" | "place_s" | "value" => Self::Number,
            "code" | "faults_not_closed" | "gaps" | "occurrences" | "partial" | "repairs"
            | "row_count" | "runs" | "script_line" | "size_bytes" | "step_index" | "turn"
            | "turns" | "withdrawn" => Self::Whole,
            time if time.ends_with("_us") => Self::Whole,
            _ => Self::Text,
        }
    }
}

/// All views that `fault-db/VIEWS.md` describes.
pub(super) const VIEWS: &[View] = &[
    View {
        name: "runs",
        time: Some("started_at"),
        order: "id",
        is_final: false,
        columns: "id, unit, kind, line, train, operator, source, connection, symptom, \
                  started_at, finished_at, verdict, bench_time_s, injected, app_version, \
                  continues, started_at_us",
    },
    View {
        name: "steps",
        time: Some("started_at"),
        order: "run_id, step_index",
        is_final: true,
        columns: "run_id, unit, step_index, procedure, kind, name, turn, turns, verdict, \
                  message, findings, bench_time_s, script_line, limit_source, started_at, \
                  started_at_us",
    },
    View {
        name: "measurements",
        time: Some("started_at"),
        order: "run_id, step_index, name, value",
        is_final: true,
        columns: "run_id, unit, procedure, step, step_index, name, value, measured_in, low, \
                  high, verdict, limit_source, started_at, started_at_us",
    },
    View {
        name: "faults",
        time: Some("first_at"),
        order: "id",
        is_final: false,
        columns: "id, unit, code, name, lru, cause, severity, state, line, occurrences, \
                  repairs, first_at, last_at, closed_at, first_at_us, last_at_us, closed_at_us",
    },
    View {
        name: "occurrences",
        time: Some("seen_at"),
        order: "id",
        is_final: false,
        columns: "id, fault_id, run_id, unit, code, name, lru, line, train, step_index, \
                  message, findings, seen_at, at_us",
    },
    View {
        name: "events",
        time: Some("happened_at"),
        order: "id",
        is_final: false,
        columns: "id, fault_id, kind, who, text, state, withdrawn, turn, happened_at, at_us",
    },
    View {
        name: "repairs",
        time: Some("repaired_at"),
        order: "fault_id, at_us, part",
        is_final: false,
        columns: "fault_id, unit, code, lru, line, part, serial_old, serial_new, note, who, \
                  opened_at, repaired_at, back_at, days_to_repair, days_until_back, at_us",
    },
    View {
        name: "traces",
        time: Some("began_at"),
        order: "id",
        is_final: false,
        columns: "id, run_id, unit, began_at, row_count, period_ms, size_bytes, partial, gaps, \
                  t0_us",
    },
    View {
        name: "units",
        time: None,
        order: "serial, kind",
        is_final: false,
        columns: "serial, kind, config_name, sw_versions, runs, faults_not_closed",
    },
    View {
        name: "notes",
        time: Some("noted_at"),
        order: "id",
        is_final: false,
        columns: "id, run_id, unit, who, text, trace_id, place_s, noted_at, at_us",
    },
];

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    /// Goal: each column and each view that `fault-db/VIEWS.md` describes is exported.
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
        let columns = |view: &'static View| {
            let name = view.name;
            view.columns().map(move |column| format!("{name}.{column}"))
        };
        let exported: BTreeSet<_> = VIEWS.iter().flat_map(columns).collect();
        assert_eq!(exported, told);
    }
}
