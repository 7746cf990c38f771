//! What follows from a fault's occurrences and events, when they came from more than one place.
//!
//! An event that changes the state names those it was made in knowledge of: what no other one follows is a
//! last word, and it decides. Two last words were said by people who did not know of each other, however
//! much each of them did: then the state that leaves the most to do stands, until one of them has looked
//! again. That a fault was seen is no decision: it yields to who is at it, and that it was opened to all.

use crate::base::{Base, Server, SqlResult, values};
use crate::id::Id;

/// Brings a fault's own row in line with its occurrences and events.
pub(crate) fn settle(base: &Base, fault: i64) -> SqlResult<()> {
    if let Base::Server(server) = base {
        return settle_all(server, &[fault]);
    }
    base.execute(&format!("{SETTLE} WHERE seq = ?1"), &values![fault])?;
    Ok(())
}

/// The same of many faults of a server at once: each question to it takes a while to get there. There a function
/// of the owner does it.
pub(crate) fn settle_all(server: &Server, faults: &[i64]) -> SqlResult<()> {
    server.execute_columns("SELECT settle_faults($1)", &[&faults])?;
    Ok(())
}

/// Makes one of all faults of a server that are one of these: of the same unit, code and part, none of them closed.
pub(crate) fn join_all(server: &Server, faults: &[i64]) -> SqlResult<()> {
    server.execute_columns("SELECT join_faults($1)", &[&faults])?;
    Ok(())
}

/// The fault of this id, be it one that was given to it elsewhere.
pub(crate) fn fault_of(base: &Base, id: Id) -> SqlResult<Option<i64>> {
    base.first(
        "SELECT seq FROM fault WHERE id = ?1 UNION ALL SELECT fault FROM fault_alias WHERE id = ?1",
        &values![id],
        |row| row.get(0),
    )
}

/// Faults not closed of the same unit, code and part as this one, if it is not closed itself, oldest first.
pub(crate) fn open_doubles(base: &Base, fault: i64) -> SqlResult<Vec<i64>> {
    base.select(
        "SELECT d.seq FROM fault f JOIN fault d ON d.unit = f.unit AND d.code = f.code AND d.lru = f.lru
         WHERE f.seq = ?1 AND f.state <> 'closed' AND d.state <> 'closed' ORDER BY d.seq",
        &values![fault],
        |row| row.get(0),
    )
}

/// Makes one fault of two in a file: all of `goes` becomes that of `stays`, and its ids other names of it. A
/// server has no counts of its own and does so with many at once: `join_faults` in `server/functions.sql`.
pub(crate) fn join(base: &Base, stays: i64, goes: i64) -> SqlResult<()> {
    for sql in JOIN {
        base.execute(sql, &values![stays, goes])?;
    }
    base.execute(UNCOUNT, &values![goes])?;
    base.execute("DELETE FROM fault WHERE seq = ?1", &values![goes])?;
    settle(base, stays)?;
    base.execute(REPAIRS, &values![stays])?;
    Ok(())
}

/// Repairs are found by the unit, code and part that both faults have.
const JOIN: [&str; 5] = [
    "UPDATE fault_occurrence SET fault = ?1 WHERE fault = ?2",
    "UPDATE fault_event SET fault = ?1 WHERE fault = ?2",
    "UPDATE repair SET fault = ?1 WHERE fault = ?2 AND unit = (SELECT unit FROM fault WHERE seq = ?2)",
    "UPDATE fault_alias SET fault = ?1 WHERE fault = ?2",
    "INSERT INTO fault_alias(id, fault) SELECT id, ?1 FROM fault WHERE seq = ?2",
];

/// What a file's triggers counted of a fault that is about to go.
const UNCOUNT: &str = "
    INSERT INTO tally(dim, grain, at, key, opened, closed, bare)
    SELECT dim, grain, at,
        CASE dim WHEN 0 THEN '' WHEN 1 THEN code WHEN 2 THEN lru WHEN 3 THEN unit ELSE line END,
        opened, closed, closed * (repairs = 0)
    FROM fault,
        (SELECT 0 AS dim UNION ALL SELECT 1 UNION ALL SELECT 2 UNION ALL SELECT 3 UNION ALL SELECT 4),
        (SELECT 0 AS grain, utc_month(first_at_us) AS at, -1 AS opened, 0 AS closed
            FROM fault WHERE seq = ?1
        UNION ALL SELECT 1, utc_day(first_at_us), -1, 0 FROM fault WHERE seq = ?1
        UNION ALL SELECT 0, utc_month(closed_at_us), 0, -1 FROM fault WHERE seq = ?1
        UNION ALL SELECT 1, utc_day(closed_at_us), 0, -1 FROM fault WHERE seq = ?1)
    WHERE seq = ?1 AND at IS NOT NULL
    ON CONFLICT DO UPDATE SET opened = opened + excluded.opened, closed = closed + excluded.closed,
        bare = bare + excluded.bare";

/// When the fault was opened before each of its repairs, now that it has the events of both.
const REPAIRS: &str = "
    UPDATE repair SET
        line = (SELECT line FROM fault WHERE seq = ?1),
        opened_at_us = min(repair.at_us, coalesce(
            (SELECT max(e.at_us) FROM fault_event e WHERE e.fault = ?1
                AND e.kind IN ('opened', 'recurred', 'reopened') AND e.at_us <= repair.at_us),
            (SELECT first_at_us FROM fault WHERE seq = ?1)))
    WHERE fault = ?1 AND unit = (SELECT unit FROM fault WHERE seq = ?1)";

/// The last words on a fault, as `e`: what follows `FROM`.
macro_rules! last_words {
    ($fault:literal) => {
        concat!(
            "fault_event e WHERE e.fault = ",
            $fault,
            " AND e.state IS NOT NULL AND NOT EXISTS (SELECT 1 FROM fault_event later
                WHERE later.fault = e.fault AND later.state IS NOT NULL
                    AND instr(later.follows, e.id) > 0)"
        )
    };
}
pub(crate) use last_words;

/// Of two last words the one of the lesser rank stands.
macro_rules! rank {
    () => {
        "CASE e.kind WHEN 'opened' THEN 9 WHEN 'recurred' THEN 3 ELSE
            CASE e.state WHEN 'open' THEN 1 WHEN 'acknowledged' THEN 2 WHEN 'repaired' THEN 4
                WHEN 'verified' THEN 5 ELSE 6 END END"
    };
}

/// What follows `UPDATE`, but for which faults.
pub(crate) const SETTLE: &str = concat!(
    "UPDATE fault SET
        occurrences = (SELECT count(*) FROM fault_occurrence o WHERE o.fault = fault.seq),
        first_at_us = coalesce(
            (SELECT min(o.at_us) FROM fault_occurrence o WHERE o.fault = fault.seq), first_at_us),
        last_at_us = coalesce(
            (SELECT max(o.at_us) FROM fault_occurrence o WHERE o.fault = fault.seq), last_at_us),
        line = coalesce((SELECT o.line FROM fault_occurrence o WHERE o.fault = fault.seq
            ORDER BY o.at_us, o.id LIMIT 1), line),
        repairs = (SELECT count(*) FROM fault_event e
            WHERE e.fault = fault.seq AND e.kind = 'repair'),
        state = coalesce((SELECT e.state FROM ",
    last_words!("fault.seq"),
    " ORDER BY ",
    rank!(),
    " LIMIT 1), state),
        closed_at_us = (SELECT CASE WHEN e.state = 'closed' THEN e.at_us END FROM ",
    last_words!("fault.seq"),
    " ORDER BY ",
    rank!(),
    ", e.at_us LIMIT 1),
        disputed = coalesce((SELECT CAST(
                max(CASE WHEN e.kind <> 'recurred' THEN ",
    rank!(),
    " END) > min(",
    rank!(),
    ") AS integer) FROM ",
    last_words!("fault.seq"),
    " AND e.kind <> 'opened'), 0)"
);
