//! The tables read from a file to be merged, their keys and parents, and the conditions under which a row is
//! valid.

/// A table that is read from the other file; no other table is.
pub(super) struct Source {
    pub table: &'static str,
    /// The column that identifies a row, and what kind of row it is.
    pub key: &'static str,
    pub of: Key,
}

pub(super) enum Key {
    /// Identified by itself.
    Row(&'static str),
    /// Part of a run, which is refused as a whole because it is sealed.
    Run(&'static str),
}

pub(super) const SOURCES: [Source; 14] = [
    source("unit", "seq", Key::Row("serial")),
    source("run", "seq", Key::Row("id")),
    source("run_script", "run", Key::Run("path")),
    source("step", "run", Key::Run("step_index")),
    source("measurement", "run", Key::Run("step_index")),
    source("fault_occurrence", "run", Key::Run("id")),
    source("recording", "run", Key::Row("ordinal")),
    source("channel_set", "seq", Key::Row("sha256")),
    source("trace", "seq", Key::Row("id")),
    source("fault", "seq", Key::Row("id")),
    source("fault_alias", "fault", Key::Row("id")),
    source("fault_event", "seq", Key::Row("id")),
    source("run_note", "seq", Key::Row("id")),
    source("seal", "ordinal", Key::Row("origin")),
];

const fn source(table: &'static str, key: &'static str, of: Key) -> Source {
    Source { table, key, of }
}

/// Foreign keys: table, column, parent table.
pub(super) const PARENTS: [(&str, &str, &str); 13] = [
    ("run", "unit", "unit"),
    ("run_script", "run", "run"),
    ("step", "run", "run"),
    ("measurement", "run", "run"),
    ("recording", "run", "run"),
    ("trace", "run", "run"),
    ("trace", "channel_set", "channel_set"),
    ("fault", "unit", "unit"),
    ("fault_alias", "fault", "fault"),
    ("fault_occurrence", "run", "run"),
    ("fault_occurrence", "fault", "fault"),
    ("fault_event", "fault", "fault"),
    ("run_note", "run", "run"),
];

/// The condition for valid rows of each table, parents before children, which refer to the valid parents.
pub(super) const VALID_ROWS: [(&str, &str); 14] = [
    ("unit", "seq NOT IN (SELECT key FROM refused WHERE what = 'unit')"),
    (
        "run",
        "seq NOT IN (SELECT key FROM refused WHERE what = 'run') AND unit IN (SELECT seq FROM unit)
            AND seq NOT IN (SELECT run FROM main.fault_occurrence
                WHERE fault IN (SELECT key FROM refused WHERE what = 'fault'))",
    ),
    ("run_script", "run IN (SELECT seq FROM run)"),
    ("step", "run IN (SELECT seq FROM run)"),
    ("measurement", "run IN (SELECT seq FROM run)"),
    (
        "recording",
        "run IN (SELECT seq FROM run)
            AND (run, ordinal) NOT IN (SELECT key, more FROM refused WHERE what = 'recording')",
    ),
    ("channel_set", "seq NOT IN (SELECT key FROM refused WHERE what = 'channel_set')"),
    (
        "trace",
        "seq NOT IN (SELECT key FROM refused WHERE what = 'trace') AND run IN (SELECT seq FROM run)
            AND channel_set IN (SELECT seq FROM channel_set)",
    ),
    // A fault that only refused runs saw is refused, too.
    (
        "fault",
        "seq NOT IN (SELECT key FROM refused WHERE what = 'fault') AND unit IN (SELECT seq FROM unit)
            AND (seq NOT IN (SELECT fault FROM main.fault_occurrence)
                OR seq IN (SELECT fault FROM main.fault_occurrence WHERE run IN (SELECT seq FROM run)))",
    ),
    (
        "fault_alias",
        "fault IN (SELECT seq FROM fault)
            AND (fault, id) NOT IN (SELECT key, more FROM refused WHERE what = 'fault_alias')",
    ),
    ("fault_occurrence", "run IN (SELECT seq FROM run) AND fault IN (SELECT seq FROM fault)"),
    (
        "fault_event",
        "seq NOT IN (SELECT key FROM refused WHERE what = 'fault_event')
            AND fault IN (SELECT seq FROM fault)",
    ),
    (
        "run_note",
        "seq NOT IN (SELECT key FROM refused WHERE what = 'run_note') AND run IN (SELECT seq FROM run)",
    ),
    (
        "seal",
        "NOT EXISTS (SELECT 1 FROM parted p WHERE p.origin = seal.origin AND p.ordinal <= seal.ordinal)",
    ),
];

/// The first entry of each chain that is refused, or whose run, event or note is. Later entries would not fit
/// here; what they cover is sealed as found.
pub(super) const FIRST_INVALID_SEAL: &str = "
    CREATE TEMP TABLE parted AS SELECT origin, min(ordinal) AS ordinal FROM main.seal
    WHERE (ordinal, origin) IN (SELECT key, more FROM refused WHERE what = 'seal')
        OR (what = 'run' AND id IN (SELECT id FROM main.run WHERE seq NOT IN (SELECT seq FROM run)))
        OR (what = 'event' AND id IN
            (SELECT id FROM main.fault_event WHERE seq NOT IN (SELECT seq FROM fault_event)))
        OR (what = 'note' AND id IN
            (SELECT id FROM main.run_note WHERE seq NOT IN (SELECT seq FROM run_note)))
    GROUP BY origin";
