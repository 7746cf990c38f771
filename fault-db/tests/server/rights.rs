//! Rights of the laptops' account, and the set-up of a server for it.

use fault_db::{Address, SERVER_SCHEMA_VERSION, StoreError};

use crate::common::{self, refused};
use crate::laptop::{Laptop, as_owner, connect, day, read_only};
use crate::private::{LAPTOPS, name_of, shared};

/// Statements that a laptop's account tries on a server that has everything.
const REFUSED: &[&str] = &[
    "DROP TABLE seal",
    "DROP TRIGGER only_added ON run",
    "DROP FUNCTION refuse_change() CASCADE",
    "DROP SCHEMA public CASCADE",
    "ALTER TABLE run DISABLE TRIGGER ALL",
    "ALTER TABLE run DROP COLUMN verdict",
    "ALTER TABLE run OWNER TO laptop",
    "ALTER FUNCTION settle_faults(bigint[]) SECURITY INVOKER",
    "CREATE OR REPLACE FUNCTION refuse_change() RETURNS trigger LANGUAGE plpgsql AS 'BEGIN RETURN NEW; END'",
    "CREATE TABLE mine(n int)",
    "CREATE TEMPORARY TABLE run(n int)",
    "CREATE SCHEMA mine",
    "CREATE FUNCTION mine() RETURNS int LANGUAGE sql AS 'SELECT 1'",
    "CREATE TRIGGER mine BEFORE INSERT ON run FOR EACH ROW EXECUTE FUNCTION refuse_change()",
    "CREATE RULE mine AS ON INSERT TO run DO INSTEAD NOTHING",
    "UPDATE run SET verdict = 'passed'",
    "UPDATE fault SET state = 'closed'",
    "UPDATE fault_occurrence SET trace = NULL",
    "UPDATE laptop SET received = 0",
    "UPDATE laptop_fault SET fresh = 0",
    "UPDATE unit SET kind = ''",
    "UPDATE meta SET value = '99'",
    "DELETE FROM run",
    "DELETE FROM fault",
    "DELETE FROM fault_alias",
    "DELETE FROM laptop",
    "DELETE FROM meta",
    "TRUNCATE measurement",
    "TRUNCATE run CASCADE",
    "SET ROLE ptu",
    "SET SESSION AUTHORIZATION ptu",
    "SET session_replication_role = replica",
    "ALTER ROLE laptop SUPERUSER",
    "GRANT ptu TO laptop",
    "COPY run TO '/tmp/run.txt'",
    "COPY run FROM PROGRAM 'true'",
    // What follows from rows, and what is the server's own.
    "INSERT INTO meta(key, value) VALUES ('x', 'y')",
    "INSERT INTO laptop(file_id, name, first_at_us, last_at_us, clock_offset_us, sent, sent_traces, received)
     VALUES (decode(repeat('00', 16), 'hex'), '', 0, 0, 0, 0, 0, 0)",
    "INSERT INTO fault(id, unit, code, code_name, lru, severity, state, first_at_us, last_at_us, line, occurrences)
     SELECT decode(repeat('00', 16), 'hex'), 1, 1, '', '', '', 'closed', 0, 0, '', 7",
    "INSERT INTO fault(id, unit, code, code_name, lru, severity, state, first_at_us, last_at_us, line, disputed)
     SELECT decode(repeat('00', 16), 'hex'), 1, 1, '', '', '', 'closed', 0, 0, '', 1",
    "INSERT INTO run_note(seq, id, run, at_us, who, text) VALUES (9223372036854775807, '', 1, 0, '', '')",
    "INSERT INTO dictionary(id, made_at_us, app_version, basis_sha256, modes, data) VALUES ('', 0, '', '', 0, '')",
    "SELECT setval(pg_get_serial_sequence('fault_event', 'seq'), 9223372036854775806)",
    "SELECT nextval(pg_get_serial_sequence('fault_event', 'seq'))",
];

#[test]
fn a_laptops_account_may_insert_and_select_and_nothing_else() {
    let address = shared().database();
    let laptop = Laptop::new("careful");
    laptop.run("U-1", day(0), &[101], true);
    laptop.sync(&address);
    let counts = || crate::counts::of_server(&mut shared().client(name_of(&address)));
    let before = counts();
    let mut client = shared().client_as(LAPTOPS, name_of(&address));
    // No error, but no effect either.
    let grant = "GRANT ALL ON ALL TABLES IN SCHEMA public TO laptop";
    client.batch_execute(grant).expect("a warning");
    for sql in REFUSED {
        let refused = client.batch_execute(sql).expect_err(sql);
        let code = refused.code().expect(sql).code();
        // Insufficient privilege; of what is not its own there is also no such thing.
        assert!(matches!(code, "42501" | "42P01"), "{sql}: {refused:?}");
    }
    assert_eq!(before, counts());
    // The functions it may call say what the rows say.
    let calls = "SELECT settle_faults(array_agg(seq)), join_faults(array_agg(seq)) FROM fault";
    client.batch_execute(calls).expect("called");
    assert_eq!(before, counts());
    laptop.is_whole();
}

/// Rows outside their domain are refused by the server, too, from any client.
#[test]
fn rows_outside_of_the_domain_are_refused() {
    let address = shared().database();
    let laptop = Laptop::new("domain");
    laptop.run("U-1", day(0), &[101], true);
    laptop.sync(&address);
    let mut client = shared().client_as(LAPTOPS, name_of(&address));
    let id = |length: usize| format!("decode(repeat('ab', {length}), 'hex')");
    let late = i64::MAX;
    let run = |id: &str, started: i64| {
        format!(
            "INSERT INTO run(id, unit, line, seed, operator, source, started_at_us, app_version, scripts_sha256,
                unit_config_sha256, owner, train, unit_kind, unit_config_name, sw_versions, laptop)
             SELECT {id}, 1, '', 0, '', '', {started}, '', '', '', '', '', '', '', '{{}}', 1"
        )
    };
    let note = |id: &str, at_us: i64, text: &str| {
        format!(
            "INSERT INTO run_note(id, run, at_us, who, text) SELECT {id}, 1, {at_us}, '', {text}"
        )
    };
    let event = |id: &str, at_us: i64, follows: usize, body: &str| {
        format!(
            "INSERT INTO fault_event(id, fault, kind, at_us, who, body, turn, follows, seen)
             SELECT {id}, min(seq), 'repair', {at_us}, '', '{body}', 1, decode(repeat('ab', {follows}), 'hex'), 0
             FROM fault"
        )
    };
    let measured = |value: &str| {
        format!(
            "INSERT INTO measurement(run, step_index, ordinal, name, value, unit, verdict)
             SELECT 1, 0, 99, '', {value}, '', 'passed'"
        )
    };
    let trace = |t0_us: i64, rows: i64| {
        format!(
            "INSERT INTO trace(id, run, t0_bench_us, t0_us, period_us, row_count, flags, channel_set, encoding,
                sha256, data)
             SELECT {}, run, 0, {t0_us}, 50000, {rows}, 0, channel_set, encoding, sha256, data FROM trace LIMIT 1",
            id(16)
        )
    };
    let seal = |digest: usize| {
        format!(
            "INSERT INTO seal(origin, ordinal, what, id, says, digest, hash)
             SELECT {}, 1, 'run', {}, '', {}, {}",
            id(16),
            id(16),
            id(digest),
            id(32)
        )
    };
    for sql in [
        run(&id(15), 1),
        run(&id(17), 1),
        run("''", 1),
        run(&id(16), late),
        run(&id(16), -1),
        note(&id(15), 1, "''"),
        note(&id(16), late, "''"),
        note(&id(16), 1, "repeat('x', 2000000)"),
        event(&id(15), 1, 16, "{}"),
        event(&id(16), late, 16, "{}"),
        event(&id(16), 1, 17, "{}"),
        event(&id(16), 1, 16, "{"),
        measured("'NaN'"),
        measured("'Infinity'"),
        trace(late, 1),
        trace(1, late),
        seal(31),
    ] {
        let refused = client.batch_execute(&sql).expect_err(&sql);
        let code = refused.code().expect("said by the server").code();
        assert!(matches!(code, "23514" | "22P02"), "{sql}: {refused:?}");
    }
}

#[test]
fn setting_up_again_changes_nothing() {
    let address = shared().empty();
    let set_up = shared().set_up(&address);
    assert_eq!(
        (set_up.schema_before, set_up.schema),
        (None, SERVER_SCHEMA_VERSION)
    );
    let again = shared().set_up(&address);
    let known = Some(SERVER_SCHEMA_VERSION);
    assert_eq!((again.schema_before, again.made_account), (known, false));
    assert_eq!((&again.owner[..], &again.laptops[..]), ("ptu", LAPTOPS));
    let laptops = address.replace("ptu@", "laptop@");
    let laptop = Laptop::new("newer");
    laptop.run("U-0", day(0), &[101], true);
    assert_eq!(laptop.sync(&laptops).runs, 1);
    let server = read_only(&laptops).expect("a server");
    server
        .query_read_only("SELECT * FROM runs", 10)
        .expect("an answer");
}

#[test]
fn an_account_that_may_delete_rows_is_refused_as_the_laptops_account() {
    // Makes the laptops' account.
    shared().database();
    let address = shared().empty();
    let mut client = shared().client("postgres");
    client
        .batch_execute(
            "DROP ROLE IF EXISTS chief, plain, member;
             CREATE ROLE chief LOGIN SUPERUSER; CREATE ROLE plain LOGIN; CREATE ROLE member LOGIN IN ROLE ptu",
        )
        .expect("accounts");
    let set_up = |address: &str, laptops: &str| {
        let address: Address = address.parse().expect("an address");
        fault_db::Store::set_up_server(&address, common::ids(5), laptops).map(drop)
    };
    let by_plain = address.replace("ptu@", "plain@");
    for (address, laptops, words) in [
        (&address, "ptu", "need an account of their own"),
        (&address, "chief", "is a superuser"),
        (&address, "member", "may act as ptu"),
        (&by_plain, "nobody_yet", "createuser --pwprompt nobody_yet"),
        (&by_plain, LAPTOPS, "as a superuser"),
    ] {
        refused!(set_up(address, laptops), _, words);
        refused!(connect(address), StoreError::ServerEmpty(_));
    }
    // The account everybody shared owned it all: somebody who may takes it over.
    let database = name_of(&address);
    as_owner(
        &address,
        &format!("ALTER DATABASE {database} OWNER TO plain"),
    );
    set_up(&by_plain, LAPTOPS).expect("as the owner of the database");
    set_up(&address, "plain").expect("as a superuser, for the account that was the owner");
    let mut plain = shared().client_as("plain", database);
    for sql in [
        "DROP TABLE run",
        "DELETE FROM run",
        "CREATE TABLE x()",
        "CREATE SCHEMA x",
    ] {
        plain.batch_execute(sql).expect_err(sql);
    }
}
