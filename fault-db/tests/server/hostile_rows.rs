//! Rows that hold what no history holds, in a laptop's file or on a server: they stay where they are, are
//! reported, and block nothing.

use crate::common::{Deeds, change, rows};
use crate::laptop::{Laptop, connect, day};
use crate::private::{name_of, shared};

/// Goal: what a laptop's file holds, put in by hand, that no history can hold stays there, and the rest is sent.
#[test]
fn invalid_rows_of_a_laptop_are_not_sent_and_all_others_are() {
    for [sql, named, runs, events] in rows(include_str!("hostile_rows.txt")) {
        let [runs, events] = [runs, events].map(|count| count.parse().expect("a count"));
        let address = shared().database();
        let laptop = Laptop::new("poisoned");
        laptop.run("U-1", day(0), &[101], true);
        let run = laptop.run("U-2", day(1), &[102], true);
        let store = laptop.open();
        store.put_run_note(run, "kim", "noted", day(2));
        let fault = store.resolve_fault("latest").expect("a fault");
        store.put_note(fault, "kim", "seen", day(2));
        drop(store);
        change(&laptop.path(), sql);
        let outcome = laptop.sync(&address);
        let refused = &outcome.refused;
        assert!(refused.count > 0, "{sql}");
        let is_named = |what: &str| format!("{what} ").starts_with(&format!("{named} "));
        assert!(
            refused.named.iter().any(|one| is_named(&one.what)),
            "{sql}: {refused:?}"
        );
        let told = (outcome.runs, outcome.events, outcome.waiting);
        assert_eq!(told, (runs, events, 0), "{sql}: {refused:?}");
        // What comes later goes as ever.
        laptop.run("U-3", day(3), &[103], true);
        assert_eq!(laptop.sync(&address).runs, 1, "{sql}");
    }
}

/// Goal: invalid rows that the server's owner put in by hand block neither other laptops nor later events.
#[test]
fn invalid_rows_on_the_server_do_not_block_a_sync() {
    let address = shared().database();
    let (one, two) = (Laptop::new("one"), Laptop::new("two"));
    one.run("U-1", day(0), &[101], true);
    one.sync(&address);
    two.run("U-1", day(1), &[101], true);
    two.sync(&address);
    let mut owner = shared().client(name_of(&address));
    owner
        .batch_execute(
            "ALTER TABLE fault_event DISABLE TRIGGER in_domain; ALTER TABLE fault_occurrence DISABLE TRIGGER in_domain;
             ALTER TABLE run DISABLE TRIGGER in_domain; ALTER TABLE fault_alias DISABLE TRIGGER in_domain;
             INSERT INTO run(id, unit, line, seed, operator, source, started_at_us, app_version, scripts_sha256,
                unit_config_sha256, owner, train, unit_kind, unit_config_name, sw_versions, laptop)
             SELECT x'', 1, '', 0, '', '', 9223372036854775807, '', '', '', '', '', '', '', '', 1;
             INSERT INTO fault_event(id, fault, kind, at_us, who, body, turn, follows, seen)
             SELECT x.id, f.seq, 'note', x.at_us, '', '', 1, x.follows, 0
             FROM (SELECT seq FROM fault LIMIT 1) f, (VALUES
                (decode('0102', 'hex'), 5, decode('', 'hex')),
                (decode(repeat('0a', 16), 'hex'), 9223372036854775807, decode('', 'hex')),
                (decode(repeat('0b', 16), 'hex'), -9223372036854775808, decode('', 'hex')),
                (decode(repeat('0c', 16), 'hex'), 5, decode('010203', 'hex'))) AS x(id, at_us, follows);
             INSERT INTO fault_occurrence(id, fault, run, at_us, bench_us, message, freeze_json, unit, code, lru, line,
                code_name, severity)
             SELECT x.id, f.seq, r.seq, x.at_us, 0, '', '{', f.unit, f.code, f.lru, '', '', ''
             FROM (SELECT * FROM fault LIMIT 1) f, (SELECT seq FROM run WHERE id = x'') r, (VALUES
                (decode('0102', 'hex'), 9223372036854775807),
                (decode(repeat('0d', 16), 'hex'), -9223372036854775808)) AS x(id, at_us);
             INSERT INTO fault_alias(id, fault) SELECT x'', seq FROM fault LIMIT 1;
             ALTER TABLE fault_event ENABLE TRIGGER in_domain; ALTER TABLE fault_occurrence ENABLE TRIGGER in_domain;
             ALTER TABLE run ENABLE TRIGGER in_domain; ALTER TABLE fault_alias ENABLE TRIGGER in_domain"
                .replace("x''", "decode('', 'hex')")
                .as_str(),
        )
        .expect("bad rows");
    for laptop in [&one, &two] {
        let outcome = laptop.sync(&address);
        assert_eq!(outcome.refused.count, 4, "{:?}", outcome.refused);
        laptop.is_whole();
    }
    // Later events of that fault reach both laptops, and a repair that did not hold is found.
    let desk = connect(&address).expect("a server");
    let fault = desk.resolve_fault("latest").expect("a fault");
    desk.put_acknowledged(fault, "lee", "on it", day(2));
    one.run("U-1", day(4), &[101], true);
    for laptop in [&one, &two] {
        assert!(laptop.sync(&address).events_received > 0, "{}", laptop.name);
        laptop.is_whole();
    }
    // And it can be asked about, absurd rows and all.
    for table in ["runs", "faults", "occurrences", "events"] {
        let answer = desk.query_read_only(&format!("SELECT * FROM {table}"), 1_000);
        answer.unwrap_or_else(|error| panic!("{table}: {error}"));
    }
    desk.conflicts().expect("asked");
}
