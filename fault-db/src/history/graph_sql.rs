//! The event graph of a fault, and the columns of the fault's row that follow from it.
//!
//! Each event that changes the state names its *parents*: the events that its author knew as the latest.
//! An event that is no other event's parent is a *head*. One head decides the fault's state. With several
//! heads, their authors did not know of each other, and the fault is *in conflict*: the state that leaves
//! the most work stands until a later event names all heads as parents. `opened` and `recurred` are
//! observations, not decisions: `recurred` yields to an acknowledgement, `opened` to every other event.
//!
//! A `withdrawn` event and the event that it follows do not count in the graph: the heads before that event are heads
//! again. A later event, made without knowing of the withdrawal, is in conflict with them.
//!
//! The part that a fault comes from changes no state: a person's latest `cause` decides it, or else the latest
//! `diagnosed` event of a run, by Lamport number and id. The unclosed faults of a unit with one cause are one *case*.
//!
//! The columns keep their old names: `follows` holds the parents, `turn` the Lamport number, `seen` the
//! occurrences known, `disputed` whether the fault is in conflict.

/// SQL condition, beginning with AND: the event of this alias was not withdrawn.
macro_rules! standing {
    ($event:literal) => {
        concat!(
            " AND NOT EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = ",
            $event,
            ".id)"
        )
    };
}
pub(crate) use standing;

/// SQL after `FROM`: the heads `e` of a fault's event graph.
macro_rules! heads {
    ($fault:literal) => {
        concat!(
            "fault_event e WHERE e.fault = ",
            $fault,
            " AND e.state IS NOT NULL",
            $crate::history::graph_sql::standing!("e"),
            " AND NOT EXISTS (SELECT 1 FROM fault_event later
                WHERE later.fault = e.fault AND later.state IS NOT NULL
                    AND instr(later.follows, e.id) > 0",
            $crate::history::graph_sql::standing!("later"),
            ")"
        )
    };
}
pub(crate) use heads;

/// SQL: rank of a head `e`; the head with the lowest rank decides the state.
macro_rules! rank {
    () => {
        "CASE e.kind WHEN 'opened' THEN 9 WHEN 'recurred' THEN 3 ELSE
            CASE e.state WHEN 'open' THEN 1 WHEN 'acknowledged' THEN 2 WHEN 'repaired' THEN 4
                WHEN 'verified' THEN 5 ELSE 6 END END"
    };
}

/// The `UPDATE` of the derived columns, without its `WHERE`.
pub(crate) const RECOMPUTE_FAULT: &str = concat!(
    "UPDATE fault SET
        occurrences = (SELECT count(*) FROM fault_occurrence o WHERE o.fault = fault.seq),
        first_at_us = coalesce(
            (SELECT min(o.at_us) FROM fault_occurrence o WHERE o.fault = fault.seq), first_at_us),
        last_at_us = coalesce(
            (SELECT max(o.at_us) FROM fault_occurrence o WHERE o.fault = fault.seq), last_at_us),
        line = coalesce((SELECT o.line FROM fault_occurrence o WHERE o.fault = fault.seq
            ORDER BY o.at_us, o.id LIMIT 1), line),
        repairs = (SELECT count(*) FROM fault_event e
            WHERE e.fault = fault.seq AND e.kind = 'repair'",
    standing!("e"),
    "),
        state = coalesce((SELECT e.state FROM ",
    heads!("fault.seq"),
    " ORDER BY ",
    rank!(),
    " LIMIT 1), state),
        closed_at_us = (SELECT CASE WHEN e.state = 'closed' THEN e.at_us END FROM ",
    heads!("fault.seq"),
    " ORDER BY ",
    rank!(),
    ", e.at_us LIMIT 1),
        disputed = coalesce((SELECT CAST(
                max(CASE WHEN e.kind <> 'recurred' THEN ",
    rank!(),
    " END) > min(",
    rank!(),
    ") AS integer) FROM ",
    heads!("fault.seq"),
    " AND e.kind <> 'opened'), 0),
        cause = (SELECT nullif(part_of(e.body), '') FROM fault_event e
            WHERE e.fault = fault.seq AND e.kind IN ('cause', 'diagnosed')",
    standing!("e"),
    " ORDER BY e.kind, e.turn DESC, e.id DESC LIMIT 1)"
);
