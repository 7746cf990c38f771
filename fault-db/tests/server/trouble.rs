//! Servers that are away, refuse, or hold something else.

use std::io::Write as _;
use std::net::TcpListener;
use std::time::Instant;

use fault_db::{Id, StoreError};

use crate::common::refused;
use crate::laptop::{Laptop, as_owner, connect, day, read_only};
use crate::private::{Nobody, name_of, shared};

#[test]
fn an_unreachable_server_is_reported_with_the_reason() {
    let away = Nobody::there();
    let nobody = format!("postgres://ptu:secret@{}/h?sslmode=disable", away.address());
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let silent_at = listener.local_addr().expect("its number");
    let silent = format!("postgres://ptu:secret@{silent_at}/h?sslmode=disable&connect_timeout=1");
    let unknown = "postgres://ptu:secret@no-such-host.invalid/h?sslmode=disable&connect_timeout=5";
    for (address, words) in [
        (nobody.as_str(), "nothing listens"),
        (silent.as_str(), "no answer in time"),
        (unknown, "connecting"),
    ] {
        let begun = Instant::now();
        let away = refused!(connect(address), StoreError::ServerUnreachable { .. });
        let said = format!("{away} {away:?}");
        assert!(said.contains(words), "{said}");
        assert!(said.contains("postgres://ptu@"), "{said}");
        assert!(!said.contains("secret"), "{said}");
        // Not the two minutes of TCP, with room for a busy machine.
        assert!(begun.elapsed().as_secs() < 30, "{address}");
    }
}

#[test]
fn a_missing_foreign_or_empty_server_database_is_reported_and_not_changed() {
    let missing = shared().address("no_such_database");
    refused!(
        connect(&missing),
        StoreError::ServerRefuses { .. },
        "does not exist"
    );

    let foreign = shared().empty();
    let mut client = shared().client(name_of(&foreign));
    client
        .batch_execute("CREATE TABLE meta(key text, value text); CREATE TABLE song(title text)")
        .expect("tables");
    for opened in [connect(&foreign), read_only(&foreign)] {
        refused!(opened, StoreError::ServerForeign(_));
    }
    let tables = "SELECT count(*) FROM pg_class WHERE relname IN ('run', 'fault')";
    let made: i64 = client.query_one(tables, &[]).expect("a count").get(0);
    assert_eq!(made, 0);

    let empty = shared().empty();
    for opened in [connect(&empty), read_only(&empty)] {
        refused!(
            opened,
            StoreError::ServerEmpty(_),
            "`ptu db server init ADDRESS`"
        );
    }
    let tables = "SELECT count(*) FROM pg_class WHERE relnamespace = 'public'::regnamespace";
    let mut client = shared().client(name_of(&empty));
    let made: i64 = client.query_one(tables, &[]).expect("a count").get(0);
    assert_eq!(made, 0, "a laptop makes no tables");
    let latin = shared().empty().replace("history_", "latin_");
    let create = format!(
        "CREATE DATABASE {} ENCODING 'LATIN1' LC_COLLATE 'C' LC_CTYPE 'C' TEMPLATE template0",
        name_of(&latin)
    );
    shared()
        .client("postgres")
        .batch_execute(&create)
        .expect("a database");
    refused!(connect(&latin), _, "createdb -E UTF8");
}

#[test]
fn an_older_and_a_newer_schema_are_named() {
    let address = shared().database();
    as_owner(&address, "UPDATE meta SET value = '0' WHERE key = 'schema'");
    let older = read_only(&address);
    refused!(
        older,
        StoreError::ServerOlderSchema { found: 0, .. },
        "`ptu db server init ADDRESS`"
    );
    as_owner(
        &address,
        "UPDATE meta SET value = '99' WHERE key = 'schema'",
    );
    for newer in [connect(&address), read_only(&address)] {
        refused!(newer, _, "has schema 99; update ptu");
    }
}

#[test]
fn concurrent_server_setups_create_one_set_of_tables() {
    let address = shared().empty();
    std::thread::scope(|threads| {
        for _ in 0..6 {
            threads.spawn(|| shared().set_up(&address));
        }
    });
    let mut client = shared().client(name_of(&address));
    let names = "SELECT value FROM meta WHERE key = 'server_id'";
    let name: String = client.query_one(names, &[]).expect("one name").get(0);
    name.parse::<Id>().expect("an id");
}

/// An account that may only read can query, and gets a clear error when it writes.
#[test]
fn a_read_only_store_answers_queries_and_refuses_writes() {
    let address = shared().database();
    let laptop = Laptop::new("reader");
    let run = laptop.run("U-1", day(0), &[101], false);
    laptop.sync(&address);
    as_owner(
        &address,
        "DROP ROLE IF EXISTS reader; CREATE ROLE reader LOGIN;
         GRANT SELECT ON ALL TABLES IN SCHEMA public TO reader",
    );
    let address = address.replace("laptop@", "reader@");
    let store = read_only(&address).expect("a server");
    assert_eq!(store.run(run).expect("the run").steps.len(), 3);
    refused!(
        store.add_run_note(run, "kim", "x", 0),
        StoreError::ReadOnly(_)
    );
    let store = connect(&address).expect("a server");
    let noted = store.add_run_note(run, "kim", "x", 0);
    refused!(noted, StoreError::ServerRefuses { .. }, "permission denied");
    refused!(store.rebuild(0), _, "needs a database file");
}

/// Bytes with which a server lets a client in.
const LET_IN: &[u8] = b"R\0\0\0\x08\0\0\0\0Z\0\0\0\x05I";

/// Goal: a server that hangs once it has let somebody in is given up in the time that the address allows.
#[test]
fn a_server_that_hangs_after_the_login_is_given_up_in_time() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let at = listener.local_addr().expect("its number");
    let (given_up, waiting) = std::sync::mpsc::channel::<()>();
    // The server holds the connection until the laptop has gone.
    let server = std::thread::spawn(move || {
        let (mut laptop, _) = listener.accept().expect("a laptop");
        laptop.write_all(LET_IN).expect("answered");
        waiting.recv().expect_err("given up");
    });
    let address = format!("postgres://ptu@{at}/h?sslmode=disable&connect_timeout=1");
    let begun = Instant::now();
    refused!(connect(&address), _, "no answer in time");
    assert!(begun.elapsed().as_secs() < 10);
    drop(given_up);
    server.join().expect("no panic");
}
