//! Numbers and contents of rows in a file and on a server.

use std::collections::BTreeMap;
use std::path::Path;

use postgres::Client;

/// Tables that a file and a server have in common.
pub const TABLES: [&str; 11] = [
    "unit",
    "run",
    "run_script",
    "step",
    "measurement",
    "fault",
    "fault_occurrence",
    "fault_event",
    "run_note",
    "trace",
    "seal",
];

pub type Counts = BTreeMap<&'static str, i64>;

pub fn of_server(client: &mut Client) -> Counts {
    let count = |table: &&'static str| {
        let sql = format!("SELECT count(*) FROM {table}");
        let row = client.query_one(&sql, &[]).expect("a count");
        (*table, row.get(0))
    };
    TABLES.iter().map(count).collect()
}

pub fn of_file(path: &Path) -> Counts {
    let conn = rusqlite::Connection::open(path).expect("a file");
    let count = |table: &&'static str| {
        let sql = format!("SELECT count(*) FROM {table}");
        let count = conn.query_row(&sql, [], |row| row.get(0)).expect("a count");
        (*table, count)
    };
    TABLES.iter().map(count).collect()
}

/// All of a server's rows but its own numbers and times, as one number: the same rows, the same number.
pub fn content(client: &mut Client) -> String {
    let mut all = String::new();
    for sql in [
        "SELECT r.id::text || u.serial || coalesce(r.verdict, '-') FROM run r JOIN unit u ON u.seq = r.unit",
        "SELECT r.id::text || s::text FROM step s JOIN run r ON r.seq = s.run",
        "SELECT f.id::text || state || occurrences || repairs || first_at_us || last_at_us
            || coalesce(closed_at_us, 0) FROM fault f",
        "SELECT e.id::text || f.id::text || kind || body || turn FROM fault_event e
            JOIN fault f ON f.seq = e.fault",
        "SELECT o.id::text || f.id::text || coalesce(t.id::text, '-') FROM fault_occurrence o
            JOIN fault f ON f.seq = o.fault LEFT JOIN trace t ON t.seq = o.trace",
        "SELECT t.id::text || t.sha256::text FROM trace t",
        "SELECT s.origin::text || s.ordinal || s.hash::text FROM seal s",
        "SELECT n.id::text || n.text FROM run_note n",
    ] {
        let sql = format!(
            "SELECT coalesce(md5(string_agg(said, E'\\n' ORDER BY said)), '') FROM ({sql}) AS rows(said)"
        );
        let row = client.query_one(&sql, &[]).expect("a digest");
        all.push_str(&row.get::<_, String>(0));
        all.push(' ');
    }
    all
}
