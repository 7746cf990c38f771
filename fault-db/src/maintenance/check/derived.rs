//! Checks the rows of faults and units against the occurrences, events and runs they are derived from.

use rusqlite::Connection;

use super::{ALTERED, Findings, Problem, REBUILD};
use crate::history::graph_sql::RECOMPUTE_FAULT;

/// Queries for contradictions that no sequence of operations explains.
const CONTRADICTS: [&str; 4] = [
    "SELECT 'fault ' || lower(hex(f.id)) || ' has a name or a severity that no occurrence of it says'
     FROM fault f WHERE EXISTS (SELECT 1 FROM fault_occurrence o WHERE o.fault = f.seq)
        AND NOT EXISTS (SELECT 1 FROM fault_occurrence o WHERE o.fault = f.seq
            AND (o.code_name, o.severity) = (f.code_name, f.severity))",
    "SELECT 'occurrence ' || lower(hex(o.id)) || ' is of another unit, code or part than its fault'
     FROM fault_occurrence o JOIN fault f ON f.seq = o.fault
     WHERE (o.unit, o.code, o.lru) <> (f.unit, f.code, f.lru)",
    "SELECT 'occurrence ' || lower(hex(o.id)) || ' is of another unit or line than its run'
     FROM fault_occurrence o JOIN run r ON r.seq = o.run WHERE (o.unit, o.line) <> (r.unit, r.line)",
    "SELECT 'unit ' || u.serial || ' is what no run found it to be'
     FROM unit u WHERE EXISTS (SELECT 1 FROM run r WHERE r.unit = u.seq)
        AND NOT EXISTS (SELECT 1 FROM run r WHERE r.unit = u.seq
            AND (r.unit_kind, r.unit_config_name, r.sw_versions) = (u.kind, u.config_name, u.sw_versions))",
];

/// Runs all checks in one snapshot of the file.
pub(super) fn check(conn: &Connection, problems: &mut Vec<Problem>) -> rusqlite::Result<()> {
    let mut found = Findings::new(problems, "fault", ALTERED);
    for sql in CONTRADICTS {
        super::each_text(conn, sql, |detail| found.add(detail))?;
    }
    drop(found);
    let mut found = Findings::new(problems, "count", REBUILD);
    faults_that_differ(conn, |_, id| {
        found.add(format!(
            "fault {id} is not as its occurrences and events say: state, times, line or counts"
        ));
    })
}

/// Passes the row number and id of each fault whose derived columns are wrong. An unqualified name means the
/// temporary table: the file itself is only read.
pub(super) fn faults_that_differ(
    conn: &Connection,
    mut take: impl FnMut(i64, String),
) -> rusqlite::Result<()> {
    conn.execute_batch(&format!(
        "CREATE TEMP TABLE fault AS SELECT * FROM main.fault; {RECOMPUTE_FAULT}"
    ))?;
    let mut differ = conn.prepare(
        "SELECT seq, lower(hex(id)) FROM (SELECT * FROM main.fault EXCEPT SELECT * FROM temp.fault)
         ORDER BY seq",
    )?;
    let mut rows = differ.query([])?;
    while let Some(row) = rows.next()? {
        take(row.get(0)?, row.get(1)?);
    }
    drop(rows);
    drop(differ);
    conn.execute_batch("DROP TABLE temp.fault")
}
