//! Checks the rows of faults and units against the occurrences, events and runs from which they are derived.

use super::{Advice, Damage, Findings, Problem, ProblemKind};
use crate::backend::{Backend, SqlResult};
use crate::history::graph_sql::RECOMPUTE_FAULT;

/// Makes the damage for a row, given the row's id or name.
type Contradiction = fn(String) -> Damage;

/// SQL that finds contradictions which no sequence of operations can cause.
const CONTRADICTS: [(Contradiction, &str); 4] = [
    (Damage::FaultNamed, "SELECT lower(hex(f.id)) FROM fault f WHERE EXISTS (SELECT 1 FROM fault_occurrence o WHERE o.fault = f.seq)
        AND NOT EXISTS (SELECT 1 FROM fault_occurrence o WHERE o.fault = f.seq
            AND (o.code_name, o.severity) = (f.code_name, f.severity))"),
    (Damage::OtherFault, "SELECT lower(hex(o.id)) FROM fault_occurrence o JOIN fault f ON f.seq = o.fault
     WHERE (o.unit, o.code, o.lru) <> (f.unit, f.code, f.lru)"),
    (Damage::OtherRun, "SELECT lower(hex(o.id)) FROM fault_occurrence o JOIN run r ON r.seq = o.run WHERE (o.unit, o.line) <> (r.unit, r.line)"),
    (Damage::UnitNamed, "SELECT u.serial FROM unit u WHERE EXISTS (SELECT 1 FROM run r WHERE r.unit = u.seq)
        AND NOT EXISTS (SELECT 1 FROM run r WHERE r.unit = u.seq
            AND (r.unit_kind, r.unit_config_name, r.sw_versions) = (u.kind, u.config_name, u.sw_versions))"),
];

/// Runs all checks in one snapshot of the file.
pub(super) fn check(file: &Backend, problems: &mut Vec<Problem>) -> SqlResult<()> {
    let mut found = Findings::new(problems, ProblemKind::Fault, Advice::Altered);
    for (damage, sql) in CONTRADICTS {
        file.each(sql, &[], |row| {
            found.add(damage(row.get(0)?));
            Ok(())
        })?;
    }
    drop(found);
    let mut found = Findings::new(problems, ProblemKind::Count, Advice::Rebuild);
    faults_that_differ(file, |_, id| found.add(Damage::FaultDerived(id)))
}

/// Calls `take` with the row number and id of each fault whose derived columns are wrong. The file itself is only read:
/// an unqualified name means a temporary table.
pub(super) fn faults_that_differ(
    file: &Backend,
    mut take: impl FnMut(i64, String),
) -> SqlResult<()> {
    file.execute("CREATE TEMP TABLE fault AS SELECT * FROM main.fault", &[])?;
    file.execute(RECOMPUTE_FAULT, &[])?;
    file.each(
        "SELECT seq, lower(hex(id)) FROM (SELECT * FROM main.fault EXCEPT SELECT * FROM temp.fault)
         ORDER BY seq",
        &[],
        |row| {
            take(row.get(0)?, row.get(1)?);
            Ok(())
        },
    )?;
    file.execute("DROP TABLE temp.fault", &[])?;
    Ok(())
}
