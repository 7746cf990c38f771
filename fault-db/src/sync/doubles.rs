//! Two faults on the server that turn out to be one: of the same unit, code and part, and neither closed.
//!
//! Each laptop that has either of them is told again what was said about both.

use crate::base::{Server, SqlResult};
use crate::settle::settle_all;

/// Of these faults, if they are not closed, the oldest that is not closed either, and the others.
const DOUBLES: &str = "
    SELECT DISTINCT stays.seq, goes.seq FROM fault f
        CROSS JOIN LATERAL (SELECT min(d.seq) AS seq FROM fault d WHERE d.unit = f.unit
            AND d.code = f.code AND d.lru = f.lru AND d.state <> 'closed') AS stays
        JOIN fault goes ON goes.unit = f.unit AND goes.code = f.code AND goes.lru = f.lru
            AND goes.state <> 'closed' AND goes.seq > stays.seq
    WHERE f.seq = ANY($1) AND f.state <> 'closed' ORDER BY 1, 2";

/// All of `goes` becomes that of `stays`, and its ids other names of it.
const JOIN: [&str; 6] = [
    "UPDATE fault_occurrence SET fault = x.stays
     FROM unnest($1::bigint[], $2::bigint[]) AS x(stays, goes) WHERE fault = x.goes",
    "UPDATE fault_event SET fault = x.stays
     FROM unnest($1::bigint[], $2::bigint[]) AS x(stays, goes) WHERE fault = x.goes",
    "UPDATE fault_alias SET fault = x.stays
     FROM unnest($1::bigint[], $2::bigint[]) AS x(stays, goes) WHERE fault = x.goes",
    "UPDATE laptop_fault SET fault = x.stays, fresh = fresh + 1
     FROM unnest($1::bigint[], $2::bigint[]) AS x(stays, goes) WHERE fault IN (x.stays, x.goes)",
    "INSERT INTO fault_alias(id, fault) SELECT f.id, x.stays
     FROM unnest($1::bigint[], $2::bigint[]) AS x(stays, goes) JOIN fault f ON f.seq = x.goes
     ON CONFLICT DO NOTHING",
    "DELETE FROM fault USING unnest($1::bigint[], $2::bigint[]) AS x(stays, goes)
     WHERE seq = x.goes",
];

/// Makes one of all faults that are one of these; runs in the caller's transaction.
pub(super) fn join(server: &Server, faults: &[i64]) -> SqlResult<()> {
    let found = server.select_columns(DOUBLES, &[&faults])?;
    if found.is_empty() {
        return Ok(());
    }
    let (mut stays, mut goes) = (Vec::<i64>::new(), Vec::<i64>::new());
    for row in found {
        stays.push(row.try_get(0)?);
        goes.push(row.try_get(1)?);
    }
    for sql in JOIN {
        server.execute_columns(sql, &[&stays, &goes])?;
    }
    settle_all(server, &stays)
}
