//! The columns sent of each table, and the statements that read and insert them.
//!
//! Rows name their parents by id; the server translates ids to its own row numbers. Rows that exist are left
//! as they are, so sending twice equals sending once.

use super::rows::Kind::{Bytes, Integer, Real, Text};
use super::rows::Table;

pub(super) const UNITS: Table = Table {
    columns: &[
        ("serial", Text),
        ("kind", Text),
        ("config_name", Text),
        ("sw_versions", Text),
        ("seen_at_us", Integer),
    ],
    read: "SELECT serial, kind, config_name, sw_versions,
            coalesce((SELECT max(started_at_us) FROM run
                WHERE run.unit = unit.seq AND started_at_us BETWEEN 0 AND 7258118400000000), 0)
         FROM unit WHERE seq = ?1",
    insert: &[
        "INSERT INTO unit(serial, kind, config_name, sw_versions)
         SELECT x.serial, x.kind, x.config_name, x.sw_versions FROM {rows}
         WHERE NOT EXISTS (SELECT 1 FROM unit u WHERE u.serial = x.serial)
         ORDER BY x.place ON CONFLICT DO NOTHING",
        "SELECT know_units(array_agg(x.serial), array_agg(x.kind), array_agg(x.config_name),
            array_agg(x.sw_versions), array_agg(x.seen_at_us)) FROM {rows}",
    ],
};

pub(super) const RUNS: Table = Table {
    columns: &[
        ("id", Bytes),
        ("serial", Text),
        ("line", Text),
        ("seed", Integer),
        ("operator", Text),
        ("source", Text),
        ("started_at_us", Integer),
        ("finished_at_us", Integer),
        ("verdict", Text),
        ("bench_time_us", Integer),
        ("wall_time_us", Integer),
        ("app_version", Text),
        ("scripts_sha256", Text),
        ("unit_config_sha256", Text),
        ("injected", Text),
        ("owner", Text),
        ("train", Text),
        ("unit_kind", Text),
        ("unit_config_name", Text),
        ("sw_versions", Text),
    ],
    read: "SELECT r.id, u.serial, r.line, r.seed, r.operator, r.source, r.started_at_us,
            r.finished_at_us, r.verdict, r.bench_time_us, r.wall_time_us, r.app_version,
            r.scripts_sha256, r.unit_config_sha256, r.injected, r.owner, r.train, r.unit_kind,
            r.unit_config_name, r.sw_versions
         FROM run r JOIN unit u ON u.seq = r.unit WHERE r.seq = ?1",
    insert: &[
        "INSERT INTO run(id, unit, line, seed, operator, source, started_at_us, finished_at_us,
            verdict, bench_time_us, wall_time_us, app_version, scripts_sha256, unit_config_sha256,
            injected, owner, train, unit_kind, unit_config_name, sw_versions, laptop)
         SELECT x.id, u.seq, x.line, x.seed, x.operator, x.source, x.started_at_us, x.finished_at_us,
            x.verdict, x.bench_time_us, x.wall_time_us, x.app_version, x.scripts_sha256,
            x.unit_config_sha256, x.injected, x.owner, x.train, x.unit_kind, x.unit_config_name,
            x.sw_versions, {laptop}
         FROM {rows} JOIN unit u ON u.serial = x.serial
         ORDER BY x.place ON CONFLICT (id) DO NOTHING",
        "SELECT end_runs(array_agg(x.id), array_agg(x.verdict), array_agg(x.finished_at_us),
            array_agg(x.bench_time_us), array_agg(x.wall_time_us)) FROM {rows}",
    ],
};

pub(super) const SCRIPTS: Table = Table {
    columns: &[("run", Bytes), ("path", Text), ("sha256", Text)],
    read: "SELECT r.id, s.path, s.sha256 FROM run r JOIN run_script s ON s.run = r.seq
         WHERE r.seq = ?1 ORDER BY s.path",
    insert: &[
        "INSERT INTO run_script(run, path, sha256) SELECT r.seq, x.path, x.sha256
         FROM {rows} JOIN run r ON r.id = x.run ORDER BY x.place ON CONFLICT DO NOTHING",
    ],
};

pub(super) const STEPS: Table = Table {
    columns: &[
        ("run", Bytes),
        ("step_index", Integer),
        ("procedure", Text),
        ("name", Text),
        ("verdict", Text),
        ("started_bench_us", Integer),
        ("bench_time_us", Integer),
        ("message", Text),
        ("script_line", Integer),
    ],
    read: "SELECT r.id, s.step_index, s.procedure, s.name, s.verdict, s.started_bench_us,
            s.bench_time_us, s.message, s.script_line
         FROM run r JOIN step s ON s.run = r.seq WHERE r.seq = ?1 ORDER BY s.step_index",
    insert: &[
        "INSERT INTO step(run, step_index, procedure, name, verdict, started_bench_us,
            bench_time_us, message, script_line)
         SELECT r.seq, x.step_index, x.procedure, x.name, x.verdict, x.started_bench_us,
            x.bench_time_us, x.message, x.script_line
         FROM {rows} JOIN run r ON r.id = x.run ORDER BY x.place ON CONFLICT DO NOTHING",
    ],
};

pub(super) const MEASUREMENTS: Table = Table {
    columns: &[
        ("run", Bytes),
        ("step_index", Integer),
        ("ordinal", Integer),
        ("name", Text),
        ("value", Real),
        ("unit", Text),
        ("low", Real),
        ("high", Real),
        ("verdict", Text),
    ],
    read: "SELECT r.id, m.step_index, m.ordinal, m.name, m.value, m.unit, m.low, m.high, m.verdict
         FROM run r JOIN measurement m ON m.run = r.seq WHERE r.seq = ?1
         ORDER BY m.step_index, m.ordinal",
    insert: &[
        "INSERT INTO measurement(run, step_index, ordinal, name, value, unit, low, high, verdict)
         SELECT r.seq, x.step_index, x.ordinal, x.name, x.value, x.unit, x.low, x.high, x.verdict
         FROM {rows} JOIN run r ON r.id = x.run ORDER BY x.place ON CONFLICT DO NOTHING",
    ],
};

pub(super) const RECORDINGS: Table = Table {
    columns: &[
        ("run", Bytes),
        ("ordinal", Integer),
        ("procedure", Text),
        ("t0_bench_us", Integer),
        ("bench_json", Text),
        ("stimuli", Bytes),
    ],
    read: "SELECT r.id, c.ordinal, c.procedure, c.t0_bench_us, c.bench_json, c.stimuli
         FROM run r JOIN recording c ON c.run = r.seq WHERE r.seq = ?1 ORDER BY c.ordinal",
    insert: &[
        "INSERT INTO recording(run, ordinal, procedure, t0_bench_us, bench_json, stimuli)
         SELECT r.seq, x.ordinal, x.procedure, x.t0_bench_us, x.bench_json, x.stimuli
         FROM {rows} JOIN run r ON r.id = x.run ORDER BY x.place ON CONFLICT DO NOTHING",
    ],
};

/// Aliases of a fault in the file. Sent before the faults.
pub(super) const OTHER_IDS: Table = Table {
    columns: &[("id", Bytes), ("other", Bytes)],
    read: "SELECT f.id, a.id FROM fault f JOIN fault_alias a ON a.fault = f.seq WHERE f.seq = ?1
         ORDER BY a.id",
    insert: &["INSERT INTO fault_alias(id, fault)
         SELECT DISTINCT ON (x.id) x.id, coalesce(f.seq, a.fault)
         FROM {rows} LEFT JOIN fault f ON f.id = x.other LEFT JOIN fault_alias a ON a.id = x.other
         WHERE coalesce(f.seq, a.fault) IS NOT NULL
            AND NOT EXISTS (SELECT 1 FROM fault g WHERE g.id = x.id)
         ORDER BY x.id, x.place ON CONFLICT DO NOTHING"],
};

/// Registers aliases that the server did not know. Sent after the faults.
pub(super) const OTHER_IDS_TOO: &str = "
    INSERT INTO fault_alias(id, fault)
    SELECT x.other, k.fault FROM {rows} JOIN laptop_fault k ON k.laptop = {laptop} AND k.id = x.id
    WHERE NOT EXISTS (SELECT 1 FROM fault g WHERE g.id = x.other)
    ORDER BY x.place ON CONFLICT DO NOTHING";

/// A fault of the file is one of the server's if it has the same id or alias there. Duplicates under other
/// ids are merged after the batch's events, as one of these may have closed a fault.
pub(super) const FAULTS: Table = Table {
    columns: &[
        ("id", Bytes),
        ("serial", Text),
        ("code", Integer),
        ("code_name", Text),
        ("lru", Text),
        ("severity", Text),
        ("state", Text),
        ("first_at_us", Integer),
        ("last_at_us", Integer),
        ("line", Text),
    ],
    read: "SELECT f.id, u.serial, f.code, f.code_name, f.lru, f.severity, f.state, f.first_at_us,
            f.last_at_us, f.line
         FROM fault f JOIN unit u ON u.seq = f.unit WHERE f.seq = ?1",
    insert: &[
        "INSERT INTO fault(id, unit, code, code_name, lru, severity, state, first_at_us, last_at_us,
            line)
         SELECT x.id, u.seq, x.code, x.code_name, x.lru, x.severity, x.state, x.first_at_us,
            x.last_at_us, x.line
         FROM {rows} JOIN unit u ON u.serial = x.serial
         WHERE NOT EXISTS (SELECT 1 FROM fault_alias a WHERE a.id = x.id)
         ORDER BY x.place ON CONFLICT (id) DO NOTHING",
        "INSERT INTO laptop_fault(laptop, id, fault, fresh)
         SELECT {laptop}, x.id, coalesce(f.seq, a.fault), 1
         FROM {rows} LEFT JOIN fault f ON f.id = x.id LEFT JOIN fault_alias a ON a.id = x.id
         ON CONFLICT DO NOTHING",
        "SELECT name_faults({laptop}, array_agg(x.id), array_agg(x.code_name), array_agg(x.severity),
            array_agg(x.last_at_us)) FROM {rows}",
    ],
};

pub(super) const OCCURRENCES: Table = Table {
    columns: &[
        ("id", Bytes),
        ("fault", Bytes),
        ("run", Bytes),
        ("step_index", Integer),
        ("at_us", Integer),
        ("bench_us", Integer),
        ("message", Text),
        ("freeze_json", Text),
        ("code", Integer),
        ("lru", Text),
        ("line", Text),
        ("code_name", Text),
        ("severity", Text),
    ],
    read: "SELECT o.id, f.id, r.id, o.step_index, o.at_us, o.bench_us, o.message, o.freeze_json,
            o.code, o.lru, o.line, o.code_name, o.severity
         FROM run r JOIN fault_occurrence o ON o.run = r.seq JOIN fault f ON f.seq = o.fault
         WHERE r.seq = ?1 ORDER BY o.seq",
    insert: &[
        "INSERT INTO fault_occurrence(id, fault, run, step_index, at_us, bench_us, message,
            freeze_json, unit, code, lru, line, code_name, severity)
         SELECT x.id, k.fault, r.seq, x.step_index, x.at_us, x.bench_us, x.message, x.freeze_json,
            r.unit, x.code, x.lru, x.line, x.code_name, x.severity
         FROM {rows} JOIN run r ON r.id = x.run
            JOIN laptop_fault k ON k.laptop = {laptop} AND k.id = x.fault
         ORDER BY x.place ON CONFLICT (id) DO NOTHING",
    ],
};

/// The last two columns are derived from the text.
pub(super) const EVENTS: Table = Table {
    columns: &[
        ("id", Bytes),
        ("fault", Bytes),
        ("kind", Text),
        ("at_us", Integer),
        ("who", Text),
        ("body", Text),
        ("state", Text),
        ("turn", Integer),
        ("follows", Bytes),
        ("seen", Integer),
        ("part", Text),
        ("words", Text),
    ],
    read: "SELECT e.id, f.id, e.kind, e.at_us, e.who, e.body, e.state, e.turn, e.follows, e.seen
         FROM fault_event e JOIN fault f ON f.seq = e.fault WHERE e.seq = ?1",
    insert: &[
        "INSERT INTO fault_event(id, fault, kind, at_us, who, body, state, turn, follows, seen, laptop,
            part, words)
         SELECT x.id, k.fault, x.kind, x.at_us, x.who, x.body, x.state, x.turn, x.follows, x.seen, {laptop}, x.part,
            CAST(x.words AS tsvector)
         FROM {rows} JOIN laptop_fault k ON k.laptop = {laptop} AND k.id = x.fault
         ORDER BY x.place ON CONFLICT (id) DO NOTHING",
    ],
};

/// The last column is derived from the text.
pub(super) const NOTES: Table = Table {
    columns: &[
        ("id", Bytes),
        ("run", Bytes),
        ("at_us", Integer),
        ("who", Text),
        ("text", Text),
        ("words", Text),
    ],
    read: "SELECT n.id, r.id, n.at_us, n.who, n.text
         FROM run_note n JOIN run r ON r.seq = n.run WHERE n.seq = ?1",
    // Notes on a run that is still under way are sent again with the run.
    insert: &["INSERT INTO run_note(id, run, at_us, who, text, words)
         SELECT x.id, r.seq, x.at_us, x.who, x.text, CAST(x.words AS tsvector)
         FROM {rows} JOIN run r ON r.id = x.run ORDER BY x.place ON CONFLICT (id) DO NOTHING"],
};

/// Read by `seal_chains`, in the order of the chain.
pub(super) const SEALS: Table = Table {
    columns: &[
        ("origin", Bytes),
        ("ordinal", Integer),
        ("what", Text),
        ("id", Bytes),
        ("covers", Integer),
        ("says", Text),
        ("digest", Bytes),
        ("hash", Bytes),
    ],
    read: "",
    insert: &[
        "INSERT INTO seal(origin, ordinal, what, id, covers, says, digest, hash)
         SELECT x.origin, x.ordinal, x.what, x.id, x.covers, x.says, x.digest, x.hash
         FROM {rows} ORDER BY x.place ON CONFLICT DO NOTHING",
    ],
};

pub(super) const CHANNEL_SETS: Table = Table {
    columns: &[("sha256", Bytes), ("json", Text)],
    read: "SELECT sha256, json FROM channel_set WHERE seq = ?1",
    insert: &[
        "INSERT INTO channel_set(sha256, json) SELECT x.sha256, x.json FROM {rows}
         WHERE NOT EXISTS (SELECT 1 FROM channel_set c WHERE c.sha256 = x.sha256)
         ORDER BY x.place ON CONFLICT DO NOTHING",
    ],
};

pub(super) const TRACES: Table = Table {
    columns: &[
        ("id", Bytes),
        ("run", Bytes),
        ("t0_bench_us", Integer),
        ("t0_us", Integer),
        ("period_us", Integer),
        ("row_count", Integer),
        ("trigger_row", Integer),
        ("flags", Integer),
        ("channel_set", Bytes),
        ("encoding", Integer),
        ("sha256", Bytes),
        ("data", Bytes),
        ("recording", Integer),
    ],
    read: "SELECT t.id, r.id, t.t0_bench_us, t.t0_us, t.period_us, t.row_count, t.trigger_row, t.flags,
            c.sha256, t.encoding, t.sha256, t.data, t.recording
         FROM trace t JOIN run r ON r.seq = t.run JOIN channel_set c ON c.seq = t.channel_set
         WHERE t.seq = ?1",
    insert: &[
        "INSERT INTO trace(id, run, t0_bench_us, t0_us, period_us, row_count, trigger_row, flags,
            channel_set, encoding, sha256, data, recording)
         SELECT x.id, r.seq, x.t0_bench_us, x.t0_us, x.period_us, x.row_count, x.trigger_row, x.flags,
            c.seq, x.encoding, x.sha256, x.data, x.recording
         FROM {rows} JOIN run r ON r.id = x.run JOIN channel_set c ON c.sha256 = x.channel_set
         ORDER BY x.place ON CONFLICT (id) DO NOTHING",
    ],
};

/// The occurrences a trace shows. Sent after the traces.
pub(super) const SHOWN: Table = Table {
    columns: &[("occurrence", Bytes), ("trace", Bytes)],
    read:
        "SELECT o.id, t.id FROM trace t JOIN fault_occurrence o ON o.trace = t.seq WHERE t.seq = ?1
         ORDER BY o.seq",
    insert: &["SELECT show_traces(array_agg(x.occurrence), array_agg(x.trace)) FROM {rows}"],
};
